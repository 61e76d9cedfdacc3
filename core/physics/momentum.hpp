#pragma once
#include "base/vec.hpp"

namespace doseki {

/// Eq. (14), clamped at zero: the speed at which i and j approach (<= 0).
template <class T>
DOSEKI_FN T approach_speed(const T& v_dot_r, const T& r) {
    return min(T(0), v_dot_r) / r;
}

/// Eq. (15): v_sig = c_i + c_j - 3 w_ij.
template <class T>
DOSEKI_FN T signal_velocity(const T& c_i, const T& c_j, const T& w_ij) {
    return c_i + c_j - T(3) * w_ij;
}

/// Eqs. (13), (16): Pi_ij = -alpha v_sig w_ij / (rho_i + rho_j) >= 0.
template <class T>
DOSEKI_FN T artificial_viscosity(const T& alpha, const T& v_sig, const T& w_ij, const T& rho_i,
                                 const T& rho_j) {
    return -(alpha * v_sig * w_ij) / (rho_i + rho_j);
}

/// Eq. (12): a_i += m_j (sigma_i/rho_i^2 + sigma_j/rho_j^2 - Pi_ij E) . grad_i W. The minus sign is
/// the paper's misprint put right: with a plus the viscosity would accelerate approaching pairs.
template <class T, int D>
DOSEKI_FN void add_acceleration(Vec<T, D>& acceleration, const T& m_j, const Sym<T, D>& stress_sum,
                                const T& Pi_ij, const T& F, const Vec<T, D>& r_ij) {
    const T weight = m_j * F;
    const Vec<T, D> traction = stress_sum * r_ij;
    for (int a = 0; a < D; ++a) acceleration[a] += weight * (traction[a] - Pi_ij * r_ij[a]);
}

}  // namespace doseki
