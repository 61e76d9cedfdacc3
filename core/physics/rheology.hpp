#pragma once
// How the viscosity of a fluid follows from the way it is sheared.

#include "base/named.hpp"
#include "physics/rheology/casson.hpp"
#include "physics/rheology/herschel_bulkley.hpp"
#include "physics/rheology/mu_i.hpp"
#include "physics/rheology/newtonian.hpp"

namespace doseki {

/// Contract of a law of viscosity. `of_pairs`: what pairs take of two viscosities.
template <class Law, class T>
concept ViscosityLaw = Named<Law> && requires(const Law& law, const ShearState<T>& state) {
    { law.viscosity(state) } -> std::same_as<T>;
    { Law::of_pairs } -> std::convertible_to<PairViscosity>;
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
PairViscosity viscosity_of_pairs(const Rheology<T>& rheology) {
    return with_value(rheology, [](const auto& law) { return law.of_pairs; });
}

}  // namespace doseki
