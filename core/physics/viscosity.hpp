#pragma once
#include <cmath>

#include "base/vec.hpp"

namespace doseki {

/// See ViscousForm.
enum class ViscousPairs { stress, morris, monaghan_cleary };

/// Eq. (28), how a pair shares momentum: factors of v_ij, of what the transposed velocity gradient
/// makes of r_ij, and of (v_ij.n) n. The stress 2 mu D has (1, 1, 0). Morris, Fox & Zhu (J. Comput.
/// Phys. 136, 1997) have (1, 0, 0), the divergence of mu grad v; Monaghan's form (Rep. Prog. Phys.
/// 68, 2005), along the line of the two, (0, 0, D + 2).
template <class T>
struct ViscousForm {
    T along_jump, transposed, along_pair;

    DOSEKI_DEVICE_FN static ViscousForm of(ViscousPairs pairs, int dim) {
        if (pairs == ViscousPairs::morris) return {T(1), T(0), T(0)};
        if (pairs == ViscousPairs::monaghan_cleary) return {T(0), T(0), T(dim + 2)};
        return {T(1), T(1), T(0)};
    }
};

/// What mu F multiplies. `transposed`: L^T r_ij with the mean of both velocity gradients;
/// `v_dot_r` = v_ij.r_ij, `inverse_r` = 1/r.
template <class T, int D>
DOSEKI_FN Vec<T, D> viscous_direction(const ViscousForm<T>& form, const Vec<T, D>& v_ij,
                                      const Vec<T, D>& transposed, const T& v_dot_r,
                                      const T& inverse_r, const Vec<T, D>& r_ij) {
    const T along = form.along_pair * v_dot_r * (inverse_r * inverse_r);
    return form.along_jump * v_ij + form.transposed * transposed + along * r_ij;
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

/// Prandtl's mixing length of open-channel flow [m], l = kappa (z + z0) sqrt(1 - z/d): with it the
/// stress rho l^2 |du/dz|^2 that falls from the bed to the surface gives the logarithmic profile.
/// At least `min_length`; z: height over the bed, d: depth, z0: that of a rough bed's law (Rotta,
/// Turbulente Stroemungen, 1972).
DOSEKI_DEVICE_FN inline double mixing_length(double z, double d, double min_length,
                                             double z0 = 0.0) {
    constexpr double von_karman = 0.40;
    const double inside = d > 0.0 ? std::clamp(z / d, 0.0, 1.0) : 0.0;
    return std::max(min_length, von_karman * (inside * d + z0) * std::sqrt(1.0 - inside));
}

}  // namespace doseki
