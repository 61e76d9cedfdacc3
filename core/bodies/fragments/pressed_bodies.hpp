#pragma once
// Bodies that are pressed so hard that they cannot come apart yet.

#include "bodies/elastic/bond_step.hpp"
#include "bodies/elastic/division.hpp"
#include "bodies/elastic/total_lagrangian.hpp"

namespace doseki {

/// Eq. (176): of each body whether its division waits. The bonds of a point tell its strain. Where
/// those that end bore pressure, the others tell of more strain than there was, and energy would
/// come from nothing. `before`: the bodies of the points.
template <int D>
Array<std::uint8_t> pressed_bodies(const TotalLagrangian<D>& solids,
                                   const Array<std::int32_t>& before, const Division& division) {
    Array<double> gained(solids.bodies(), 0.0);
    for (std::uint32_t p = 0; p < before.size(); ++p) {
        const std::int32_t body = before[p];
        if (body < 0 || division.divides[static_cast<std::size_t>(body)] == 0) continue;
        bool loses = false;
        double strength = 0.0;
        solids.bonds().for_each_left(p, [&](std::uint32_t j, double tension) {
            loses = loses || division.body[j] != division.body[p];
            strength = max(strength, tension);
        });
        if (!loses) continue;
        const auto own = [&](std::uint32_t j) { return before[j] == body; };
        const auto of_part = [&](std::uint32_t j) { return division.body[j] == division.body[p]; };
        // That of dust is lost with its bonds.
        const double after = division.body[p] < 0 ? 0.0 : solids.energy_with(p, of_part);
        gained[static_cast<std::size_t>(body)] +=
            after - solids.energy_with(p, own) -
            negligible_gain(solids.volume(p), strength, solids.body_of(p));
    }
    Array<std::uint8_t> pressed(solids.bodies(), 0);
    for (std::size_t body = 0; body < pressed.size(); ++body) pressed[body] = gained[body] > 0.0;
    return pressed;
}

}  // namespace doseki
