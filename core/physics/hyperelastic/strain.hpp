#pragma once
// Strain, and the stresses that follow from it, of a deformation gradient F = dx/dX.

#include "base/matrix.hpp"

namespace doseki {

/// Lame's parameters [Pa]. In 2-D nothing moves along z: plane strain.
template <class T>
struct Lame {
    T lambda{}, mu{};

    static Lame of(double young, double poisson) {
        return {T(young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))),
                T(0.5 * young / (1.0 + poisson))};
    }
};

/// Speed of compression waves at rest [m/s].
DOSEKI_DEVICE_FN inline double p_wave_speed(const Lame<double>& lame, double rho0) {
    return std::sqrt((lame.lambda + 2.0 * lame.mu) / rho0);
}

/// E = (F^T F - 1)/2.
template <class T, int D>
DOSEKI_FN Sym<T, D> green_strain(const Mat<T, D>& F) {
    Sym<T, D> strain = symmetric_part(transposed(F) * F);
    for (int a = 0; a < D; ++a)
        for (int b = a; b < D; ++b)
            strain(a, b) = number<T>(0.5) * (a == b ? strain(a, b) - T(1) : strain(a, b));
    return strain;
}

/// Eq. (82), P = F (2 eta dE/dt) with dE/dt the symmetric part of F^T dF/dt: what Kelvin-Voigt's
/// damper adds. It resists strain, not rotation, and its power 2 eta dE/dt : dE/dt is never
/// negative.
template <class T, int D>
DOSEKI_FN Mat<T, D> kelvin_voigt(const Mat<T, D>& F, const Mat<T, D>& F_rate, const T& eta) {
    return F * ((T(2) * eta) * full(symmetric_part(transposed(F) * F_rate)));
}

/// sigma = P F^T / J.
template <class T, int D>
DOSEKI_FN Sym<T, D> cauchy_stress(const Mat<T, D>& P, const Mat<T, D>& F) {
    const Sym<T, D> kirchhoff = symmetric_part(P * transposed(F));
    const T scale = T(1) / determinant(F);
    Sym<T, D> sigma;
    for (int k = 0; k < Sym<T, D>::size; ++k) sigma.element[k] = scale * kirchhoff.element[k];
    return sigma;
}

}  // namespace doseki
