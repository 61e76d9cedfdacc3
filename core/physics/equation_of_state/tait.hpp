#pragma once
#include <cmath>

#include "physics/equation_of_state/thermodynamic_state.hpp"

namespace doseki {

/// p = rho0 c0^2/7 ((rho/rho0)^7 - 1), Tait's equation as Cole (Underwater Explosions, 1948) has it
/// for water.
template <class T>
struct Tait {
    static constexpr const char* name = "tait";

    T rho0{};  // [kg/m^3]
    T c0{};    // [m/s]

    template <class F>
    void members(F&& f) {
        f("rho0", rho0), f("speedsound", c0);
    }

    DOSEKI_FN ThermodynamicState<T> at(const T& rho) const {
        using std::pow;
        const T e = rho / rho0;
        return {rho0 * c0 * c0 / T(7) * (pow(e, T(7)) - T(1)), c0 * e * e * e,
                c0 * c0 * ((pow(e, T(6)) / T(6) + T(1) / e - number<T>(7.0 / 6.0)) / T(7))};
    }
};

}  // namespace doseki
