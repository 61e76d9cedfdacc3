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
/// begins with those that have had the time for it. Inertia grows from sum to sum: the narrow ones
/// are done first, and the wide ones take some ten to twenty sums for each spacing of their width.
/// Returns whether there are any.
template <class Lists>
bool settle_films(AnyScheme<Lists>& scheme, const Lists& lists, Halo<Lists::dim>& halo) {
    constexpr int most = 20000;
    constexpr double settled = 3e-5;                 // of the largest change
    constexpr double power = 14.0, half_way = 28.0;  // what has settled dies out with n^(-power/2)
    double largest = 0.0;
    for (int n = 0; n < most; ++n) {
        const double change = halo.ranks.largest(change_of_films(scheme.particles()));
        largest = std::max(largest, change);
        if (!(change > settled * largest)) return n > 0;
        scheme.sum_walls_alone(lists, halo, 1.0 - power / (n + half_way));
    }
    return true;
}

}  // namespace doseki
