#pragma once
#include <cmath>

#include "physics/equation_of_state/thermodynamic_state.hpp"

namespace doseki {

/// p = c0^2 (rho - rho0).
template <class T>
struct Linear {
    static constexpr const char* name = "linear";

    T rho0{};  // [kg/m^3]
    T c0{};    // [m/s]

    template <class F>
    void members(F&& f) {
        f("rho0", rho0), f("speedsound", c0);
    }

    DOSEKI_FN ThermodynamicState<T> at(const T& rho) const {
        using std::log;
        const T e = rho / rho0;
        return {rho0 * c0 * c0 * (e - T(1)), c0, c0 * c0 * (log(e) + T(1) / e - T(1))};
    }
};

}  // namespace doseki
