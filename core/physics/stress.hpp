#pragma once
#include "base/vec.hpp"

namespace doseki {

/// Eqs. (4)-(5): dS/dt = 2 mu (D - tr D/3 E) + W S - S W with D, W the symmetric and antisymmetric
/// parts of L_ab = d v_a/d x_b. The 1/3 makes a 2-D run plane strain.
template <class T, int D>
DOSEKI_FN Deviator<T, D> elastic_stress_rate(const Mat<T, D>& L, const Deviator<T, D>& S,
                                             const T& shear_modulus) {
    const T third = trace(L) * number<T>(1.0 / 3.0);
    Deviator<T, D> rate;
    for (int a = 0; a < D; ++a)
        for (int b = a; b < D; ++b) {
            if (a == 2 && b == 2) continue;
            T sum = shear_modulus * (L(a, b) + L(b, a));
            if (a == b) sum -= T(2) * shear_modulus * third;
            for (int k = 0; k < D; ++k) {
                const T w_ak = number<T>(0.5) * (L(a, k) - L(k, a)),
                        w_kb = number<T>(0.5) * (L(k, b) - L(b, k));
                sum += w_ak * S(min(k, b), max(k, b)) - S(min(a, k), max(a, k)) * w_kb;
            }
            rate.element[Deviator<T, D>::index(a, b)] = sum;
        }
    return rate;
}

/// Eq. (7): tau = 2 mu (D - tr D/3 E).
template <class T, int D>
DOSEKI_FN Deviator<T, D> viscous_stress(const Mat<T, D>& L, const T& mu) {
    const T third = trace(L) * number<T>(1.0 / 3.0);
    Deviator<T, D> tau;
    for (int a = 0; a < D; ++a)
        for (int b = a; b < D; ++b) {
            if (a == 2 && b == 2) continue;
            T rate = L(a, b) + L(b, a);
            if (a == b) rate -= T(2) * third;
            tau.element[Deviator<T, D>::index(a, b)] = mu * rate;
        }
    return tau;
}

/// Eqs. (3), (6) in the form Eq. (12) needs: (-p E + S) / rho^2.
template <class T, int D>
DOSEKI_FN Sym<T, D> stress_over_rho_squared(const T& p, const Deviator<T, D>& S, const T& rho) {
    const T scale = T(1) / (rho * rho);
    Sym<T, D> stress;
    for (int a = 0; a < D; ++a)
        for (int b = a; b < D; ++b) stress(a, b) = scale * (a == b ? S(a, b) - p : S(a, b));
    return stress;
}

/// Elastic shear energy per mass, S:S / (4 mu rho) [J/kg].
template <class T, int D>
DOSEKI_FN T shear_energy(const Deviator<T, D>& S, const T& shear_modulus, const T& rho) {
    return double_dot(S) / (T(4) * shear_modulus * rho);
}

}  // namespace doseki
