#pragma once
#include "base/matrix.hpp"

namespace doseki {

using std::log;

/// Lame's parameters [Pa]. In 2-D nothing moves along z: plane strain.
template <class T>
struct Lame {
    T lambda, mu;

    static Lame of(double young, double poisson) {
        return {T(young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))),
                T(0.5 * young / (1.0 + poisson))};
    }
};

/// E = (F^T F - 1)/2.
template <class T, int D>
DOSEKI_FN Sym<T, D> green_strain(const Mat<T, D>& F) {
    Sym<T, D> strain = symmetric_part(transposed(F) * F);
    for (int a = 0; a < D; ++a)
        for (int b = a; b < D; ++b)
            strain(a, b) = number<T>(0.5) * (a == b ? strain(a, b) - T(1) : strain(a, b));
    return strain;
}

/// Eq. (81), P = F S, S = lambda tr(E) 1 + 2 mu E: first Piola-Kirchhoff stress of St
/// Venant-Kirchhoff's law.
template <class T, int D>
DOSEKI_FN Mat<T, D> st_venant_kirchhoff(const Mat<T, D>& F, const Lame<T>& lame) {
    const Sym<T, D> strain = green_strain(F);
    T sum = strain(0, 0);
    for (int a = 1; a < D; ++a) sum += strain(a, a);
    Mat<T, D> S = (T(2) * lame.mu) * full(strain);
    for (int a = 0; a < D; ++a) S(a, a) += lame.lambda * sum;
    return F * S;
}

/// Its energy per volume at rest, lambda tr(E)^2/2 + mu E:E.
template <class T, int D>
DOSEKI_FN T st_venant_kirchhoff_energy(const Mat<T, D>& F, const Lame<T>& lame) {
    const Sym<T, D> strain = green_strain(F);
    T sum = strain(0, 0), square = T(0);
    for (int a = 1; a < D; ++a) sum += strain(a, a);
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b)
            square += strain(min(a, b), max(a, b)) * strain(min(a, b), max(a, b));
    return number<T>(0.5) * lame.lambda * sum * sum + lame.mu * square;
}

/// Eq. (81), P = mu (F - F^-T) + lambda ln(J) F^-T: compressible neo-Hookean law (Bonet and Wood,
/// Nonlinear Continuum Mechanics for Finite Element Analysis, 1997). Compression to nothing takes
/// infinite work, which St Venant-Kirchhoff's law does not ask.
template <class T, int D>
DOSEKI_FN Mat<T, D> neo_hookean(const Mat<T, D>& F, const Lame<T>& lame) {
    const Mat<T, D> c = cofactors(F);
    const T J = determinant(F, c);
    return lame.mu * F + ((lame.lambda * log(J) - lame.mu) / J) * c;
}

/// Its energy per volume at rest, mu (tr F^T F - D)/2 - mu ln J + lambda ln^2(J)/2.
template <class T, int D>
DOSEKI_FN T neo_hookean_energy(const Mat<T, D>& F, const Lame<T>& lame) {
    T square = T(-D);
    for (const T& element : F.element) square += element * element;
    const T log_J = log(determinant(F));
    return number<T>(0.5) * lame.mu * square - lame.mu * log_J +
           number<T>(0.5) * lame.lambda * log_J * log_J;
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

/// Speed of compression waves at rest [m/s].
inline double p_wave_speed(const Lame<double>& lame, double rho0) {
    return std::sqrt((lame.lambda + 2.0 * lame.mu) / rho0);
}

}  // namespace doseki
