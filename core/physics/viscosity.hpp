#pragma once
#include <cmath>

#include "base/vec.hpp"

namespace doseki {

/// How a pair shares momentum: factors of v_ij and of (v_ij.n) n. Morris, Fox & Zhu (J. Comput.
/// Phys. 136, 1997) has (1, 0); Monaghan's form (Rep. Prog. Phys. 68, 2005), which keeps angular
/// momentum, has (0, D + 2).
template <class T>
struct ViscousForm {
    T along_jump, along_pair;
};

/// What mu F multiplies: `v_dot_r` = v_ij.r_ij, `inverse_r` = 1/r.
template <class T, int D>
DOSEKI_FN Vec<T, D> viscous_direction(const ViscousForm<T>& form, const Vec<T, D>& v_ij,
                                      const T& v_dot_r, const T& inverse_r, const Vec<T, D>& r_ij) {
    const T along = form.along_pair * v_dot_r * (inverse_r * inverse_r);
    return form.along_jump * v_ij + along * r_ij;
}

/// Eq. (136): pressure [Pa] of a bulk viscosity alpha rho c h, which damps sound (Sun, Pilloton,
/// Antuono & Colagrossi, J. Comput. Phys. 483, 2023). `divergence` of the velocity [1/s].
DOSEKI_DEVICE_FN inline double damping_pressure(double alpha, double rho, double c, double h,
                                                double divergence) {
    return -alpha * rho * c * h * divergence;
}

/// Eq. (160): alpha of (136) beside walls, which have this share of the kernel. They go on with the
/// pressure gradient of the step before, and that feeds sound that runs along them.
DOSEKI_DEVICE_FN inline double damping_beside_walls(double alpha, double wall_share) {
    constexpr double first_row = 0.2, most = 0.2;  // share that walls have there; alpha
    return std::max(alpha,
                    std::min(alpha * (1.0 + 3.0 * std::min(wall_share / first_row, 1.0)), most));
}

/// Prandtl's mixing length of open-channel flow [m], l = kappa z sqrt(1 - z/d): with it the stress
/// rho l^2 |du/dz|^2 that falls from the bed to the surface gives the logarithmic profile. At least
/// `min_length`; z: height over the bed, d: depth.
DOSEKI_DEVICE_FN inline double mixing_length(double z, double d, double min_length) {
    constexpr double von_karman = 0.40;
    const double inside = d > 0.0 ? std::clamp(z / d, 0.0, 1.0) : 0.0;
    return std::max(min_length, von_karman * inside * d * std::sqrt(1.0 - inside));
}

}  // namespace doseki
