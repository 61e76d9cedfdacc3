#pragma once
#include "physics/rheology/shear_state.hpp"

namespace doseki {

/// Eq. (7): mu = rho nu.
template <class T>
struct Newtonian {
    static constexpr const char* name = "newtonian";
    static constexpr bool has_yield_stress = false;

    T nu{};  // [m^2/s]

    template <class F>
    void members(F&& f) {
        f("nu", nu);
    }

    DOSEKI_FN T viscosity(const ShearState<T>& state) const { return state.rho * nu; }
};

}  // namespace doseki
