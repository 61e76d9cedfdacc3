#pragma once
// What the ueta2022 scheme makes of the laws of a material, particle by particle.

#include <algorithm>
#include <cmath>

#include "model/material.hpp"
#include "model/material_laws.hpp"
#include "model/options.hpp"
#include "model/particles.hpp"
#include "physics/yield.hpp"

namespace doseki {

/// Where a solid yields.
template <int D>
YieldSurface<double> yield_surface(const Material& material) {
    if (material.law != Law::solid) return unyielding();
    if (material.yield_strength > 0.0) return von_mises(material.yield_strength);
    if (material.cohesion > 0.0 || material.friction_angle > 0.0)
        return drucker_prager<D>(material.cohesion, material.friction_angle);
    return unyielding();
}

/// Pressure and sound speed of a particle as its scheme sees them: the equation of state and the
/// rule on tension.
DOSEKI_DEVICE_FN inline ThermodynamicState<double> equation_of_state(const Material& material,
                                                                     double rho, Motion motion,
                                                                     Tension tension) {
    auto state = thermodynamic_state(*material.laws, rho);
    const bool clamped = motion == Motion::fixed || tension == Tension::clamp_all ||
                         (tension == Tension::clamp_fluid && material.law == Law::fluid);
    if (clamped) state.pressure = max(0.0, state.pressure);
    return state;
}

/// Density ratio (5/7)^(3/2) at which Eq. (8) has its minimum. What is stretched further is a void:
/// it resists no more, and its density stays there until it is compressed again.
inline constexpr double void_ratio = 0.60368;

/// Eq. (11), drho/dt = -rho div v. Inflow-buffer particles keep their prescribed density; a
/// particle stretched beyond void_ratio is not stretched further.
template <int D>
DOSEKI_DEVICE_FN double density_rate(const Material& material, Motion motion, double rho,
                                     const Mat<double, D>& L) {
    if (motion == Motion::driven) return 0.0;
    const double rate = -rho * trace(L);
    return rho < void_ratio * material.rho0 ? max(0.0, rate) : rate;
}

/// Eq. (10), held within a quarter of its value at rest (a solid in tension would grow h for ever).
template <int D>
DOSEKI_DEVICE_FN double smoothing_length(double eta, double mass, double rho, double rho0) {
    const double rest = eta * std::pow(mass / rho0, 1.0 / D);
    return std::clamp(eta * std::pow(mass / rho, 1.0 / D), 0.8 * rest, 1.25 * rest);
}

}  // namespace doseki
