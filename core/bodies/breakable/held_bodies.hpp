#pragma once
// What holds a body from several sides while something lands on it.

#include <cstdint>
#include <map>
#include <set>

#include "base/array.hpp"
#include "base/vec.hpp"
#include "bodies/contacts.hpp"

namespace doseki {

/// The mass of all that touches a body that at least two others touch [kg], 2-D: [kg/m], and the
/// speed at which the fastest of them comes nearer [m/s]; zero of other bodies.
struct Held {
    double mass = 0.0, closing = 0.0;
};

/// Of bodies numbered below `count`: `number_of` gives the number of a body that may be held, or
/// -1, `mass_of` the mass of what touches one, and `velocity_at` the velocity of a body at a place.
template <int D, class NumberOf, class MassOf, class VelocityAt>
Array<Held> held_bodies(std::size_t count, const Contacts<D>& contacts,
                        const ContactBodies<D>& touching, NumberOf&& number_of, MassOf&& mass_of,
                        VelocityAt&& velocity_at) {
    std::map<std::size_t, std::set<std::int32_t>> around;
    Array<Held> held(count);
    contacts.for_each_force(
        touching, [&](std::int32_t k, std::int32_t other, const Vec<double, D>& place,
                      const Vec<double, D>& force) {
            const auto number = number_of(k);
            const double push = norm(force);
            if (number < 0 || !(push > 0.0)) return;
            const auto n = static_cast<std::size_t>(number);
            around[n].insert(other);
            const Vec<double, D> apart = velocity_at(k, place) - velocity_at(other, place);
            held[n].closing = std::max(held[n].closing, -dot(apart, force) / push);
        });
    for (const auto& [n, others] : around)
        if (others.size() > 1)
            for (const std::int32_t other : others) held[n].mass += mass_of(other);
    return held;
}

}  // namespace doseki
