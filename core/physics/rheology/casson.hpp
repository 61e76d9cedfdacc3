#pragma once
#include <cmath>

#include "physics/rheology/pair_viscosity.hpp"

namespace doseki {

/// Eq. (66): sqrt(tau) = sqrt(tau_y) + sqrt(eta |D|) (Casson, in Mill (ed.), Rheology of Disperse
/// Systems, 1959), the yield stress made smooth after Papanastasiou & Boudouvis (Comput. Struct.
/// 64, 1997).
template <class T>
struct Casson {
    static constexpr const char* name = "casson";
    static constexpr PairViscosity of_pairs = PairViscosity::harmonic;

    T yield_stress{};      // [Pa]
    T casson_viscosity{};  // [Pa s]
    T regularisation{};    // [s]
    T max_viscosity{};     // [Pa s]

    template <class F>
    void members(F&& f) {
        f("yield_stress", yield_stress), f("casson_viscosity", casson_viscosity);
        f("regularisation", regularisation), f("viscosity_max", max_viscosity);
    }

    DOSEKI_FN T viscosity(const ShearState<T>& state) const {
        using std::exp;
        // Below 1e-6 the quotient is 1 to six digits, and its difference would lose them.
        const T x = max(sqrt(regularisation * state.rate), number<T>(1e-6));
        const T plastic = sqrt(yield_stress * regularisation) * ((T(1) - exp(-x)) / x);
        const T root = plastic + sqrt(casson_viscosity);
        return min(root * root, max_viscosity);
    }
};

}  // namespace doseki
