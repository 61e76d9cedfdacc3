#pragma once
#include "physics/rheology/pair_viscosity.hpp"

namespace doseki {

/// Eq. (7): mu = rho nu.
template <class T>
struct Newtonian {
    static constexpr const char* name = "newtonian";
    static constexpr PairViscosity of_pairs = PairViscosity::mean;

    T nu{};  // [m^2/s]

    template <class F>
    void members(F&& f) {
        f("nu", nu);
    }

    DOSEKI_FN T viscosity(const ShearState<T>& state) const { return state.rho * nu; }
};

}  // namespace doseki
