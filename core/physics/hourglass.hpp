#pragma once
#include "base/matrix.hpp"

namespace doseki {

// Eq. (83). A deformation gradient is a fit to the places of neighbours; what it misses, r_ij - F_i
// R_ij, may grow unseen by any stress. Springs of stiffness kappa [Pa] with the weights of that
// fit, -V_j F(R), pull it back (Ganzenmueller, Comput. Methods Appl. Mech. Eng. 286, 2015; Silling,
// ibid. 322, 2017). The fit being the one of least squares with these very weights, the energy of
// the springs does not change with F_i to first order: their force is its exact gradient, and keeps
// momentum, angular momentum and energy.

/// What a point brings to both sums of a pair: stress less springs.
template <class T, int D>
DOSEKI_FN Mat<T, D> less_springs(const Mat<T, D>& stress, const T& kappa, const Mat<T, D>& F) {
    return stress - kappa * F;
}

/// Eq. (83): force on i of a pair over V_i V_j F(R), (Q_i + Q_j) R_ij + (kappa_i + kappa_j) r_ij,
/// with Q of less_springs.
template <class T, int D>
DOSEKI_FN Vec<T, D> elastic_pair_force(const Mat<T, D>& Q_i, const Mat<T, D>& Q_j,
                                       const T& kappa_sum, const Vec<T, D>& R_ij,
                                       const Vec<T, D>& r_ij) {
    return (Q_i + Q_j) * R_ij + kappa_sum * r_ij;
}

/// What the spin of the misfits e_ij = r_ij - F_i R_ij of one point follows from, sums with the
/// weights of the fit.
template <class T, int D>
struct MisfitMoments {
    Mat<T, D> square{}, rate{};  // sum of e (x) e and of de/dt (x) e

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.square...), f(self.rate...);
    }
    DOSEKI_FN void add(const T& weight, const Vec<T, D>& e, const Vec<T, D>& e_rate) {
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) {
                square(a, b) += (weight * e[a]) * e[b];
                rate(a, b) += (weight * e_rate[a]) * e[b];
            }
    }
};

/// The x with A x = b for a symmetric A without negative eigenvalues, by elimination with the
/// largest pivots first; along what is left of A below `floor`, x is 0. The inverse of a matrix
/// that is nearly singular would leave A x - b as large as its condition makes it.
DOSEKI_DEVICE_FN inline Vec<double, 3> solve_semidefinite(Mat<double, 3> A, Vec<double, 3> b,
                                                          double floor) {
    int row[3] = {0, 1, 2};
    Vec<double, 3> x{};
    int rank = 0;
    for (; rank < 3; ++rank) {
        for (int k = rank + 1; k < 3; ++k)
            if (A(row[k], row[k]) > A(row[rank], row[rank])) {
                const int larger = row[k];
                row[k] = row[rank], row[rank] = larger;
            }
        const int p = row[rank];
        if (!(A(p, p) > floor)) break;
        for (int k = rank + 1; k < 3; ++k) {
            const double share = A(row[k], p) / A(p, p);
            for (int a = 0; a < 3; ++a) A(row[k], a) -= share * A(p, a);
            b[row[k]] -= share * b[p];
        }
    }
    for (int n = rank - 1; n >= 0; --n) {
        double sum = b[row[n]];
        for (int k = n + 1; k < rank; ++k) sum -= A(row[n], row[k]) * x[row[k]];
        x[row[n]] = sum / A(row[n], row[n]);
    }
    return x;
}

/// Eq. (83a): the skew matrix Omega with sum e x (de/dt - Omega e) = 0, that is Omega C + C Omega =
/// N - N^T with C = `square`, N = `rate`. Misfits below 1e-10 of a spacing have none: weights are
/// such that the sum of R (x) R is 1. About the line of misfits that are all parallel there is
/// none either.
template <int D>
DOSEKI_DEVICE_FN Mat<double, D> misfit_spin(const MisfitMoments<double, D>& moments) {
    constexpr double floor = 1e-20;
    const Mat<double, D>&C = moments.square, &N = moments.rate;
    Mat<double, D> spin{};
    if constexpr (D == 2) {
        spin(1, 0) = (N(1, 0) - N(0, 1)) / (C(0, 0) + C(1, 1) + floor);
        spin(0, 1) = -spin(1, 0);
    } else {
        const double size = C(0, 0) + C(1, 1) + C(2, 2);
        const Mat<double, 3> inertia = (size + floor) * identity<double, 3>() - C;
        Vec<double, 3> moment;
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            moment[a] = N(c, b) - N(b, c);
        }
        constexpr double parallel = 1e-15;
        const Vec<double, 3> about =
            solve_semidefinite(inertia, moment, parallel * size + 2.0 * floor);
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            spin(c, b) = about[a], spin(b, c) = -about[a];
        }
    }
    return spin;
}

}  // namespace doseki
