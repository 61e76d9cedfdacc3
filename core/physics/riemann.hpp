#pragma once
#include "base/vec.hpp"

namespace doseki {

/// Low-dissipation acoustic Riemann solver (Zhang, Hu & Adams, J. Comput. Phys. 335, 2017):
/// p* = (p_i + p_j)/2 + beta rho c dU/2 with dU = (v_i - v_j).n the speed of approach, less what
/// the velocity gradient makes of it. Their beta = min(3 max(dU, 0)/c, 1) leaves noise at a free
/// surface undamped; here it is at least `min_beta` for noise, and for what is small beside a flow
/// that viscosity resolves as good as nothing: Eq. (145). `smooth` is the square of twice the
/// speed that such a flow makes of the distance of the pair [m^2/s^2]. Returns what this adds to
/// the mean pressure [Pa].
template <class T>
DOSEKI_FN T approach_pressure(const T& dU, const T& rho, const T& c, const T& smooth) {
    constexpr double min_beta = 0.05;
    const T square = dU * dU, tiny = number<T>(1e-30);
    const T least = number<T>(min_beta) * c * square / (square + smooth + tiny);
    return number<T>(0.5) * rho * min(max(T(3) * dU, least), c) * dU;
}

/// See approach_pressure: the square of twice the speed that a strain rate makes of a distance r.
template <class T>
DOSEKI_FN T smooth_approach(const T& strain_rate, const T& r) {
    const T speed = T(2) * strain_rate * r;
    return speed * speed;
}

/// The part of the solver's velocity U* that comes from pressures, twice over: (p_i - p_j)/(rho c).
/// It spreads density; half of it damps the same noise and leaves the timestep a margin (Eq. 31).
/// The mean pressure gradient is taken out first, as in delta-SPH (Antuono et al., Comput. Phys.
/// Commun. 181, 2010), so that water at rest stays at rest.
template <class T, int D>
DOSEKI_FN T pressure_jump(const T& p_i, const T& p_j, const Vec<T, D>& gradient_i,
                          const Vec<T, D>& gradient_j, const Vec<T, D>& r_ij) {
    return p_i - p_j - number<T>(0.5) * dot(gradient_i + gradient_j, r_ij);
}

}  // namespace doseki
