#pragma once
// How pressure, sound speed and energy of a material follow from its density.

#include "base/named.hpp"
#include "physics/equation_of_state/birch_murnaghan.hpp"
#include "physics/equation_of_state/linear.hpp"
#include "physics/equation_of_state/stiffened_gas.hpp"
#include "physics/equation_of_state/tait.hpp"

namespace doseki {

/// Contract of an equation of state. Whoever needs the pressure alone takes it out of at(): once
/// inlined, the rest is not worked out.
template <class Law, class T>
concept EquationOfStateLaw = Named<Law> && requires(const Law& law, const T& rho) {
    { law.at(rho) } -> std::same_as<ThermodynamicState<T>>;
};

template <class T, EquationOfStateLaw<T>... Laws>
using OneOfEquations = std::variant<Laws...>;

/// All equations of state; to add one, write its file and name it here.
template <class T>
using EquationOfState = OneOfEquations<T, Linear<T>, Tait<T>, StiffenedGas<T>, BirchMurnaghan<T>>;

template <class T>
DOSEKI_FN ThermodynamicState<T> thermodynamic_state(const EquationOfState<T>& eos, const T& rho) {
    return with_value(eos, [&](const auto& law) { return law.at(rho); });
}

/// Density at which a law that rises with it has this pressure; `low` or `high` where that lies
/// beyond them.
inline double density_of(const EquationOfState<double>& eos, double pressure, double low,
                         double high) {
    while (high - low > 1e-14 * high) {
        const double middle = 0.5 * (low + high);
        (thermodynamic_state(eos, middle).pressure < pressure ? low : high) = middle;
    }
    return high;
}

}  // namespace doseki
