#pragma once
// Liquids whose viscosity depends on how they are sheared: `rate` is |D| = sqrt(2 D:D) [1/s].

#include <cmath>

#include "base/pack.hpp"

namespace doseki {

/// Eq. (64): a yield stress and a power law, the yield stress made smooth after Papanastasiou
/// (J. Rheol. 31, 1987).
template <class T>
struct HerschelBulkley {
    T yield_stress;    // [Pa]
    T consistency;     // [Pa s^n]
    T flow_index;      // n
    T regularisation;  // [s]
    T greatest;        // [Pa s]

    DOSEKI_FN T viscosity(const T& rate) const {
        using std::exp, std::pow;
        // Below 1e-6 the quotient is 1 to six digits, and its difference would lose them.
        const T x = max(regularisation * rate, number<T>(1e-6));
        const T plastic = yield_stress * regularisation * ((T(1) - exp(-x)) / x);
        const T viscous = consistency * pow(max(rate, number<T>(1e-9)), flow_index - T(1));
        return min(plastic + viscous, greatest);
    }
};

/// Eq. (65): dense granular flow, friction that grows with the inertial number I = |D|
/// d/sqrt(p/rho_s) (Jop, Forterre & Pouliquen, Nature 441, 2006). No pressure, no friction.
template <class T>
struct MuI {
    T mu_s, mu_2, I_0;
    T grain_diameter;  // [m]
    T grain_density;   // [kg/m^3]
    T greatest;        // [Pa s]

    DOSEKI_FN T viscosity(const T& rate, const T& pressure) const {
        const T p = max(pressure, T(0)), slow = number<T>(1e-9);
        const T collisional = I_0 * sqrt(p / grain_density) + rate * grain_diameter;
        const T eta = mu_s * p / max(rate, slow) +
                      (mu_2 - mu_s) * p * grain_diameter / max(collisional, slow * grain_diameter);
        return min(eta, greatest);
    }
};

}  // namespace doseki
