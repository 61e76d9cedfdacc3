#pragma once
// How the viscosity of a fluid follows from the way it is sheared.

#include "base/named.hpp"
#include "physics/rheology/casson.hpp"
#include "physics/rheology/herschel_bulkley.hpp"
#include "physics/rheology/mu_i.hpp"
#include "physics/rheology/newtonian.hpp"

namespace doseki {

/// Contract of a law of viscosity. `has_yield_stress`: viscosity varies by orders of magnitude
/// beside a plug, so that pairs take harmonic means.
template <class Law, class T>
concept ViscosityLaw = Named<Law> && requires(const Law& law, const ShearState<T>& state) {
    { law.viscosity(state) } -> std::same_as<T>;
    { Law::has_yield_stress } -> std::convertible_to<bool>;
};

template <class T, ViscosityLaw<T>... Laws>
using OneOfViscosities = std::variant<Laws...>;

/// All laws of viscosity; to add one, write its file and name it here.
template <class T>
using Rheology = OneOfViscosities<T, Newtonian<T>, HerschelBulkley<T>, Casson<T>, MuI<T>>;

/// Of the fluid itself, without turbulence [Pa s].
template <class T>
DOSEKI_FN T viscosity(const Rheology<T>& rheology, const ShearState<T>& state) {
    return with_value(rheology, [&](const auto& law) { return law.viscosity(state); });
}

template <class T>
bool has_yield_stress(const Rheology<T>& rheology) {
    return with_value(rheology, [](const auto& law) { return law.has_yield_stress; });
}

}  // namespace doseki
