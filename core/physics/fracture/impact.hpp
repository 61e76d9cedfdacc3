#pragma once
// What a touch does to a body that might break.

#include <algorithm>
#include <cmath>
#include <numbers>

namespace doseki {

/// One body that others touch: how fast the fastest of those that have just met it comes nearer
/// [m/s], impedances rho c_P of the body and of that one [Pa s/m], infinite where it does not
/// yield, half the sum of the forces on the body [N], 2-D: [N/m], and the diameter of a ball as
/// large [m].
struct Touch {
    double speed = 0.0, impedance = 0.0, other_impedance = 0.0, force = 0.0, diameter = 0.0;
};

/// Stress of the plane wave that two bodies send into each other when their faces meet, Eq. (139a)
/// (Kolsky, Stress Waves in Solids, 1953).
inline double impact_stress(double speed, double impedance, double other_impedance) {
    return speed * impedance / (1.0 + impedance / other_impedance);
}

/// Largest tension in a disc or ball between two forces, Eq. (139b): of a disc after Timoshenko and
/// Goodier (Theory of Elasticity, 1970), of a ball after Hiramatsu and Oka (Int. J. Rock Mech. Min.
/// Sci. 3, 1966).
template <int D>
double pressed_tension(double force, double diameter) {
    if constexpr (D == 2) return 2.0 * force / (std::numbers::pi * diameter);
    return 2.8 * force / (std::numbers::pi * diameter * diameter);
}

/// Largest tension in a beam of which a blow stops a part, Eq. (177): with a bar's impedance rho c
/// [Pa s/m] and the outermost distance of a cut over its radius of gyration, `fibre`. An infinite
/// one has a curvature there that lasts; what comes back from the ends adds to it. `share` is that
/// of the speed which the part loses.
inline double blow_tension(double speed, double impedance, double fibre, double share) {
    constexpr double ends = 1.3;
    return ends * impedance * speed * share * fibre;
}

/// Largest tension in a beam on supports on the middle of which something lands, Eq. (180): `blow`
/// is twice its energy over the mass of the beam [m^2/s^2], `impedance` and `fibre` as in
/// blow_tension. All of that energy bends it. In a block that is about as long as thick most of it
/// goes into shear and into where it is touched.
inline double caught_tension(double blow, double impedance, double fibre, bool is_long) {
    const double bends = is_long ? 1.0 : 0.125;  // share of the energy
    return impedance * fibre * std::sqrt(3.0 * bends * blow);
}

/// Eq. (139a) and (139b): the tension that is to be expected at most in a compact body.
template <int D>
double expected_tension(const Touch& touch) {
    return std::max(impact_stress(touch.speed, touch.impedance, touch.other_impedance),
                    pressed_tension<D>(touch.force, touch.diameter));
}

}  // namespace doseki
