#pragma once
#include "physics/equation_of_state/thermodynamic_state.hpp"

namespace doseki {

/// Cube root for the density ratios of a condensed body, 0.1 < e < 10 (exact to rounding there):
/// Halley's iteration from the tangent at one, written without branches so that packs can run it.
template <class T>
DOSEKI_FN T cbrt_near_one(const T& e) {
    T y = (T(2) + e) * number<T>(1.0 / 3.0);
    for (int iteration = 0; iteration < 4; ++iteration) {
        const T cube = y * y * y;
        y = y * (cube + e + e) / (cube + cube + e);
    }
    return y;
}

/// Birch-Murnaghan equation of state and what follows from it.
/// Eq. (8):  p = 3/2 rho0 c0^2 (e^(7/3) - e^(5/3)),  e = rho/rho0.
/// Eq. (17): c^2 = dp/drho = c0^2/2 (7 e^(4/3) - 5 e^(2/3)).
/// Energy: 9/8 c0^2 (e^(2/3) - 1)^2.
template <class T>
struct BirchMurnaghan {
    static constexpr const char* name = "birch_murnaghan";

    T rho0{};  // [kg/m^3]
    T c0{};    // [m/s]

    template <class F>
    void members(F&& f) {
        f("rho0", rho0), f("speedsound", c0);
    }

    DOSEKI_FN ThermodynamicState<T> at(const T& rho) const {
        const T e = rho / rho0;
        const T root = cbrt_near_one(e);
        const T e23 = root * root, e43 = e23 * e23;
        const T c0_squared = c0 * c0;
        const T c_squared = number<T>(0.5) * c0_squared * (T(7) * e43 - T(5) * e23);
        // Below e = (5/7)^(3/2) the material has no sound speed: Eq. (17) must not be rooted there.
        const T floor = number<T>(0.01) * c0_squared;
        return {number<T>(1.5) * rho0 * c0_squared * e * (e43 - e23), sqrt(max(c_squared, floor)),
                number<T>(1.125) * c0_squared * (e23 - T(1)) * (e23 - T(1))};
    }
};

}  // namespace doseki
