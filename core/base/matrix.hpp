#pragma once
// Algebra of small matrices over a number type T (scalar or Pack).

#include <cmath>

#include "base/vec.hpp"

namespace doseki {

template <class T, int D>
DOSEKI_FN Mat<T, D> identity() {
    Mat<T, D> one{};
    for (int a = 0; a < D; ++a) one(a, a) = T(1);
    return one;
}

template <class T, int D>
DOSEKI_FN Mat<T, D> operator+(const Mat<T, D>& m, const Mat<T, D>& n) {
    Mat<T, D> sum;
    for (int k = 0; k < D * D; ++k) sum.element[k] = m.element[k] + n.element[k];
    return sum;
}

template <class T, int D>
DOSEKI_FN Mat<T, D> operator-(const Mat<T, D>& m, const Mat<T, D>& n) {
    Mat<T, D> difference;
    for (int k = 0; k < D * D; ++k) difference.element[k] = m.element[k] - n.element[k];
    return difference;
}

template <class T, int D>
DOSEKI_FN Mat<T, D> operator*(const T& s, const Mat<T, D>& m) {
    Mat<T, D> product;
    for (int k = 0; k < D * D; ++k) product.element[k] = s * m.element[k];
    return product;
}

template <class T, int D>
DOSEKI_FN Vec<T, D> operator*(const Mat<T, D>& m, const Vec<T, D>& v) {
    Vec<T, D> product;
    for (int a = 0; a < D; ++a) {
        product[a] = m(a, 0) * v[0];
        for (int b = 1; b < D; ++b) product[a] += m(a, b) * v[b];
    }
    return product;
}

template <class T, int D>
DOSEKI_FN Mat<T, D> operator*(const Mat<T, D>& m, const Mat<T, D>& n) {
    Mat<T, D> product;
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) {
            product(a, b) = m(a, 0) * n(0, b);
            for (int k = 1; k < D; ++k) product(a, b) += m(a, k) * n(k, b);
        }
    return product;
}

template <class T, int D>
DOSEKI_FN Mat<T, D> transposed(const Mat<T, D>& m) {
    Mat<T, D> result;
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) result(a, b) = m(b, a);
    return result;
}

template <class T, int D>
DOSEKI_FN Vec<T, D> row(const Mat<T, D>& m, int a) {
    Vec<T, D> v;
    for (int b = 0; b < D; ++b) v[b] = m(a, b);
    return v;
}

/// Each row v of m as f(v).
template <class T, int D, class F>
DOSEKI_DEVICE_FN Mat<T, D> each_row(const Mat<T, D>& m, F&& f) {
    Mat<T, D> result;
    for (int a = 0; a < D; ++a) {
        const Vec<T, D> v = f(row(m, a));
        for (int b = 0; b < D; ++b) result(a, b) = v[b];
    }
    return result;
}

template <class T, int D>
DOSEKI_FN Mat<T, D> full(const Sym<T, D>& s) {
    Mat<T, D> result;
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) result(a, b) = s(min(a, b), max(a, b));
    return result;
}

/// m + m^T, halved.
template <class T, int D>
DOSEKI_FN Sym<T, D> symmetric_part(const Mat<T, D>& m) {
    Sym<T, D> result;
    for (int a = 0; a < D; ++a)
        for (int b = a; b < D; ++b) result(a, b) = number<T>(0.5) * (m(a, b) + m(b, a));
    return result;
}

/// How fast and about what a velocity gradient turns: half of its vorticity.
template <class T, int D>
DOSEKI_FN Turn<T, D> turning_part(const Mat<T, D>& L) {
    Turn<T, D> turn;
    if constexpr (D == 2) {
        turn[0] = number<T>(0.5) * (L(1, 0) - L(0, 1));
    } else {
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            turn[a] = number<T>(0.5) * (L(c, b) - L(b, c));
        }
    }
    return turn;
}

/// The square of the Frobenius norm.
template <int D>
DOSEKI_DEVICE_FN double sum_of_squares(const Mat<double, D>& m) {
    double sum = 0.0;
    for (double element : m.element) sum += element * element;
    return sum;
}

/// Bound on the sizes of the eigenvalues, whatever the axes are: the largest of them in 2-D, and in
/// 3-D where two are the same.
template <int D>
DOSEKI_DEVICE_FN double largest_size(const Sym<double, D>& s) {
    double sum = 0.0, squares = 0.0;
    for (int a = 0; a < D; ++a) {
        sum += s(a, a), squares += s(a, a) * s(a, a);
        for (int b = a + 1; b < D; ++b) squares += 2.0 * s(a, b) * s(a, b);
    }
    const double mean = sum / D, variance = squares / D - mean * mean;
    return (mean < 0.0 ? -mean : mean) + std::sqrt((D - 1) * (variance > 0.0 ? variance : 0.0));
}

/// Scales s such that largest_size(s) is no more than `most`. That is at most the square root of
/// the sum of squares, so that few need a root.
template <int D>
DOSEKI_DEVICE_FN void bound_size(Sym<double, D>& s, double most) {
    if (sum_of_squares(full(s)) <= most * most) return;
    const double share = most / max(largest_size(s), most);
    for (double& element : s.element) element *= share;
}

/// Matrix of cofactors: inverse transposed times determinant.
template <class T, int D>
DOSEKI_FN Mat<T, D> cofactors(const Mat<T, D>& m) {
    Mat<T, D> c;
    if constexpr (D == 2) {
        c(0, 0) = m(1, 1), c(0, 1) = -m(1, 0), c(1, 0) = -m(0, 1), c(1, 1) = m(0, 0);
    } else {
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) {
                const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
                c(a, b) = m(a1, b1) * m(a2, b2) - m(a1, b2) * m(a2, b1);
            }
    }
    return c;
}

/// Determinant, given the cofactors.
template <class T, int D>
DOSEKI_FN T determinant(const Mat<T, D>& m, const Mat<T, D>& cofactors) {
    T sum = m(0, 0) * cofactors(0, 0);
    for (int b = 1; b < D; ++b) sum += m(0, b) * cofactors(0, b);
    return sum;
}

template <class T, int D>
DOSEKI_FN T determinant(const Mat<T, D>& m) {
    return determinant(m, cofactors(m));
}

/// Inverse; zero where the determinant is not above `min_determinant`.
template <int D>
DOSEKI_DEVICE_FN Mat<double, D> inverse(const Mat<double, D>& m, double min_determinant) {
    const Mat<double, D> c = cofactors(m);
    const double det = determinant(m, c);
    Mat<double, D> result{};
    if (!(det > min_determinant)) return result;
    const double factor = 1.0 / det;
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) result(a, b) = factor * c(b, a);
    return result;
}

/// Adds a multiple of u (x) v.
template <int D>
void add_outer(Mat<double, D>& sum, double factor, const Vec<double, D>& u,
               const Vec<double, D>& v) {
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) sum(a, b) += factor * u[a] * v[b];
}

}  // namespace doseki
