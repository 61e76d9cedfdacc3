#pragma once
// What lands on bodies that others hold.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "base/array.hpp"

namespace doseki {

/// Another body that touches a body, and how fast the two come nearer there [m/s].
struct Closing {
    std::size_t body;
    std::int32_t other;
    double speed;
};

/// Twice the energy of what lands on each body below `count` that at least two others touch [J],
/// 2-D: [J/m]; 0 of others. What moves brings its own, and all of it that of the speed at which the
/// body comes nearer to what is fixed. `mass_of` gives the mass of what touches one [kg]; 0: fixed.
template <class MassOf>
Array<double> blows_on_held(std::size_t count, Array<Closing> pairs, MassOf&& mass_of) {
    std::ranges::sort(pairs, {}, [](const Closing& pair) {
        return std::tuple(pair.body, pair.other, -pair.speed);
    });
    Array<double> blows(count, 0.0);
    for (std::size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
        double mass = 0.0, moving = 0.0, fixed = 0.0;
        std::size_t others = 0;
        for (; end < pairs.size() && pairs[end].body == pairs[begin].body; ++end) {
            const bool known = end > begin && pairs[end].other == pairs[end - 1].other;
            if (known) continue;  // the fastest place of each comes first
            const double other = mass_of(pairs[end].other), speed = std::max(0.0, pairs[end].speed);
            mass += other, moving += other * speed * speed, ++others;
            if (other == 0.0) fixed = std::max(fixed, speed);
        }
        if (others > 1) blows[pairs[begin].body] = moving + mass * fixed * fixed;
    }
    return blows;
}

}  // namespace doseki
