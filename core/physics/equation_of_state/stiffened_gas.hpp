#pragma once
#include <cmath>

#include "physics/equation_of_state/thermodynamic_state.hpp"

namespace doseki {

/// Eq. (68): p = p_inf ((rho/rho0)^gamma - 1), p_inf = rho0 c0^2/gamma: the isentrope of a
/// stiffened gas, p = (gamma - 1) rho e - gamma p_inf (Menikoff & Plohr, Rev. Mod. Phys. 61, 1989),
/// through p = 0 at rho0. Tait's equation is that of gamma = 7.
template <class T>
struct StiffenedGas {
    static constexpr const char* name = "stiffened_gas";

    T rho0{};   // [kg/m^3]
    T c0{};     // [m/s]
    T gamma{};  // > 1

    template <class F>
    void members(F&& f) {
        f("rho0", rho0), f("speedsound", c0), f("gamma", gamma);
    }

    DOSEKI_FN ThermodynamicState<T> at(const T& rho) const {
        using std::pow;
        const T e = rho / rho0, one = T(1), less = gamma - one;
        const T c0_squared = c0 * c0, power = pow(e, less);
        return {rho0 * c0_squared / gamma * (e * power - one), c0 * sqrt(power),
                c0_squared / gamma * ((power - one) / less + one / e - one)};
    }
};

}  // namespace doseki
