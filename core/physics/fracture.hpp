#pragma once
// How the material of a deformable body breaks.

#include "base/named.hpp"
#include "physics/fracture/cohesive.hpp"
#include "physics/fracture/grady_kipp.hpp"
#include "physics/fracture/none.hpp"

namespace doseki {

/// Contract of a law of fracture: the tension that a site bears and the one that all sites bear,
/// whether a crack starts under a tension [Pa], how its damage grows in a time [s], what it still
/// bears, and when it bears nothing.
template <class Law, class T>
concept FractureLaw =
    Named<Law> && requires(const Law& law, Crack& crack, const CrackSite& site, T number) {
        { law.strength(site) } -> std::same_as<T>;
        { law.least_strength() } -> std::same_as<T>;
        { law.starts(number, site) } -> std::same_as<bool>;
        law.grow(crack, number, number, site);
        { law.traction(crack, site) } -> std::same_as<T>;
        { law.slope(crack, number, site) } -> std::same_as<T>;
        { law.failed(crack) } -> std::same_as<bool>;
    };

template <class T, FractureLaw<T>... Laws>
using OneOfFractures = std::variant<Laws...>;

/// All laws of fracture, in the order by which a checkpoint knows them; to add one, write its file
/// and name it here.
template <class T>
using Fracture = OneOfFractures<T, Unbreakable<T>, Cohesive<T>, GradyKipp<T>>;

}  // namespace doseki
