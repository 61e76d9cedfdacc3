#pragma once
// How the stress of an elastic body follows from its deformation.

#include "base/named.hpp"
#include "physics/hyperelastic/neo_hookean.hpp"
#include "physics/hyperelastic/st_venant_kirchhoff.hpp"

namespace doseki {

/// Contract of a hyperelastic law. For small strains all of them are Hooke's with the parameters
/// `lame`.
template <class Law, class T>
concept HyperelasticLaw =
    Named<Law> && requires(const Law& law, const Mat<T, 2>& plane, const Mat<T, 3>& space) {
        { law.lame } -> std::convertible_to<Lame<T>>;
        { law.stress(plane) } -> std::same_as<Mat<T, 2>>;
        { law.stress(space) } -> std::same_as<Mat<T, 3>>;
        { law.energy(plane) } -> std::same_as<T>;
        { law.energy(space) } -> std::same_as<T>;
        { law.stress_across(plane) } -> std::same_as<T>;
    };

template <class T, HyperelasticLaw<T>... Laws>
using OneOfHyperelastics = std::variant<Laws...>;

/// All hyperelastic laws, in the order by which a checkpoint knows them; to add one, write its file
/// and name it here.
template <class T>
using Hyperelastic = OneOfHyperelastics<T, StVenantKirchhoff<T>, NeoHookean<T>>;

}  // namespace doseki
