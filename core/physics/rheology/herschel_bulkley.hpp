#pragma once
#include <cmath>

#include "physics/rheology/pair_viscosity.hpp"

namespace doseki {

/// Eq. (64): a yield stress and a power law, the yield stress made smooth after Papanastasiou
/// (J. Rheol. 31, 1987).
template <class T>
struct HerschelBulkley {
    static constexpr const char* name = "herschel_bulkley";
    static constexpr PairViscosity of_pairs = PairViscosity::harmonic;

    T yield_stress{};    // [Pa]
    T consistency{};     // [Pa s^n]
    T flow_index{};      // n
    T regularisation{};  // [s]
    T max_viscosity{};   // [Pa s]

    template <class F>
    void members(F&& f) {
        f("yield_stress", yield_stress), f("consistency", consistency), f("flow_index", flow_index);
        f("regularisation", regularisation), f("viscosity_max", max_viscosity);
    }

    DOSEKI_FN T viscosity(const ShearState<T>& state) const {
        using std::exp, std::pow;
        // Below 1e-6 the quotient is 1 to six digits, and its difference would lose them.
        const T x = max(regularisation * state.rate, number<T>(1e-6));
        const T plastic = yield_stress * regularisation * ((T(1) - exp(-x)) / x);
        const T viscous = consistency * pow(max(state.rate, number<T>(1e-9)), flow_index - T(1));
        return min(plastic + viscous, max_viscosity);
    }
};

}  // namespace doseki
