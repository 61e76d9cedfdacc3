#pragma once
// Vectors and matrices of D components over a number type T (scalar or Pack).

#include <array>

#include "base/pack.hpp"

namespace doseki {

template <class T, int D>
struct Vec {
    std::array<T, D> component{};
    DOSEKI_FN T& operator[](int a) { return component[a]; }
    DOSEKI_FN const T& operator[](int a) const { return component[a]; }

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        for (int k = 0; k < D; ++k) f(self.component[k]...);
    }
};

template <class T, int D>
DOSEKI_FN Vec<T, D> operator+(const Vec<T, D>& u, const Vec<T, D>& v) {
    Vec<T, D> sum;
    for (int a = 0; a < D; ++a) sum[a] = u[a] + v[a];
    return sum;
}

template <class T, int D>
DOSEKI_FN Vec<T, D> operator-(const Vec<T, D>& u, const Vec<T, D>& v) {
    Vec<T, D> difference;
    for (int a = 0; a < D; ++a) difference[a] = u[a] - v[a];
    return difference;
}

template <class T, int D>
DOSEKI_FN Vec<T, D> operator*(const T& s, const Vec<T, D>& v) {
    Vec<T, D> product;
    for (int a = 0; a < D; ++a) product[a] = s * v[a];
    return product;
}

template <class T, int D>
DOSEKI_FN T dot(const Vec<T, D>& u, const Vec<T, D>& v) {
    T sum = u[0] * v[0];
    for (int a = 1; a < D; ++a) sum += u[a] * v[a];
    return sum;
}

/// A rotation or a moment: about one axis in the plane, about three in space.
template <class T, int D>
using Turn = Vec<T, D == 2 ? 1 : 3>;

/// spin x r
template <class T, int D>
DOSEKI_FN Vec<T, D> turned_by(const Turn<T, D>& spin, const Vec<T, D>& r) {
    Vec<T, D> v;
    if constexpr (D == 2) {
        v[0] = -(spin[0] * r[1]), v[1] = spin[0] * r[0];
    } else {
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            v[a] = spin[b] * r[c] - spin[c] * r[b];
        }
    }
    return v;
}

/// lever x force
template <class T, int D>
DOSEKI_FN Turn<T, D> moment_of(const Vec<T, D>& lever, const Vec<T, D>& force) {
    if constexpr (D == 2) {
        Turn<T, D> moment;
        moment[0] = lever[0] * force[1] - lever[1] * force[0];
        return moment;
    } else {
        return turned_by<T, D>(lever, force);
    }
}

/// General D x D matrix, row by row.
template <class T, int D>
struct Mat {
    std::array<T, D * D> element{};
    DOSEKI_FN T& operator()(int a, int b) { return element[a * D + b]; }
    DOSEKI_FN const T& operator()(int a, int b) const { return element[a * D + b]; }

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        for (int k = 0; k < D * D; ++k) f(self.element[k]...);
    }
};

template <class T, int D>
DOSEKI_FN T trace(const Mat<T, D>& m) {
    T sum = m(0, 0);
    for (int a = 1; a < D; ++a) sum += m(a, a);
    return sum;
}

/// Symmetric D x D matrix: xx, yy, xy in 2-D; xx, yy, zz, xy, xz, yz in 3-D.
template <class T, int D>
struct Sym {
    static constexpr int size = D * (D + 1) / 2;
    std::array<T, size> element{};
    DOSEKI_FN static constexpr int index(int a, int b) { return a == b ? a : D + a + b - 1; }
    DOSEKI_FN T& operator()(int a, int b) { return element[index(a, b)]; }
    DOSEKI_FN const T& operator()(int a, int b) const { return element[index(a, b)]; }

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        for (int k = 0; k < size; ++k) f(self.element[k]...);
    }
};

template <class T, int D>
DOSEKI_FN Sym<T, D> operator+(const Sym<T, D>& s, const Sym<T, D>& t) {
    Sym<T, D> sum;
    for (int k = 0; k < Sym<T, D>::size; ++k) sum.element[k] = s.element[k] + t.element[k];
    return sum;
}

template <class T, int D>
DOSEKI_FN Vec<T, D> operator*(const Sym<T, D>& s, const Vec<T, D>& v) {
    Vec<T, D> product;
    for (int a = 0; a < D; ++a) {
        product[a] = s(a, 0) * v[0];
        for (int b = 1; b < D; ++b) product[a] += s(a, b) * v[b];
    }
    return product;
}

/// Traceless symmetric tensor of a 3-D (or plane-strain) body. S_zz = -(S_xx + S_yy) is implied, so
/// that 2-D keeps xx, yy, xy and 3-D keeps xx, yy, xy, xz, yz.
template <class T, int D>
struct Deviator {
    static constexpr int size = D == 2 ? 3 : 5;
    std::array<T, size> element{};
    /// Position of S_ab (a <= b < D) among the stored components; zz has none.
    DOSEKI_FN static constexpr int index(int a, int b) { return a == b ? a : a + b + 1; }
    DOSEKI_FN T zz() const { return -(element[0] + element[1]); }
    DOSEKI_FN T operator()(int a, int b) const {
        return a == 2 && b == 2 ? zz() : element[index(a, b)];
    }

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        for (int k = 0; k < size; ++k) f(self.element[k]...);
    }
};

/// s += factor * t
template <class T, int D>
DOSEKI_FN void add_scaled(Deviator<T, D>& s, const T& factor, const Deviator<T, D>& t) {
    for (int k = 0; k < Deviator<T, D>::size; ++k) s.element[k] += factor * t.element[k];
}

/// S : S over all three axes.
template <class T, int D>
DOSEKI_FN T double_dot(const Deviator<T, D>& s) {
    T sum = s.zz() * s.zz();
    for (int a = 0; a < 2; ++a) sum += s(a, a) * s(a, a);
    for (int k = 2; k < Deviator<T, D>::size; ++k) sum += T(2) * s.element[k] * s.element[k];
    return sum;
}

}  // namespace doseki
