#pragma once
#include "physics/rheology/pair_viscosity.hpp"

namespace doseki {

/// Eqs. (65) and (91): dense granular flow, friction that grows with the inertial number I = |D|
/// d/sqrt(p'/rho_s) (Jop, Forterre & Pouliquen, Nature 441, 2006). p' is the effective pressure,
/// what grains carry beside the water in their pores. No pressure, no friction.
template <class T>
struct MuI {
    static constexpr const char* name = "mu_i";
    static constexpr PairViscosity of_pairs = PairViscosity::by_rate;

    T mu_s{}, mu_2{}, I_0{};
    T grain_diameter{};       // [m]
    T grain_density{};        // [kg/m^3]
    T max_viscosity{};        // [Pa s]
    T pore_pressure_ratio{};  // of the pore water's pressure over all of it

    template <class F>
    void members(F&& f) {
        f("mu_s", mu_s), f("mu_2", mu_2), f("inertial_number", I_0);
        f("grain_diameter", grain_diameter), f("grain_density", grain_density);
        f("viscosity_max", max_viscosity), f("pore_pressure_ratio", pore_pressure_ratio);
    }

    DOSEKI_FN T viscosity(const ShearState<T>& state) const {
        const T p = (T(1) - pore_pressure_ratio) * max(state.p, T(0)), slow = number<T>(1e-9);
        const T collisional = I_0 * sqrt(p / grain_density) + state.rate * grain_diameter;
        const T eta = mu_s * p / max(state.rate, slow) +
                      (mu_2 - mu_s) * p * grain_diameter / max(collisional, slow * grain_diameter);
        return min(eta, max_viscosity);
    }
};

}  // namespace doseki
