#pragma once
#include <algorithm>
#include <cmath>

#include "model/particles.hpp"
#include "ranks/halo.hpp"
#include "run/any_scheme.hpp"

namespace doseki {

/// The largest change that the pressure of a film between faces has just made [Pa].
template <int D>
double change_of_films(const Particles<D>& particles) {
    double largest = 0.0;
    for (const double change : particles.wall.film_change.stored())
        largest = std::max(largest, std::abs(change));
    return largest;
}

/// The pressure of films runs in from their rims, for thousands of steps under a wide body. A run
/// begins with those that have had the time for it. Returns whether there are any.
template <class Lists>
bool settle_films(AnyScheme<Lists>& scheme, const Lists& lists, Halo<Lists::dim>& halo) {
    constexpr int most = 400;
    constexpr double settled = 1e-3;  // of the largest change
    double largest = 0.0;
    for (int n = 0; n < most; ++n) {
        const double change = halo.ranks.largest(change_of_films(scheme.particles()));
        largest = std::max(largest, change);
        if (!(change > settled * largest)) return n > 0;
        scheme.sum_walls_alone(lists, halo);
    }
    return true;
}

}  // namespace doseki
