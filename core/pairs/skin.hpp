#pragma once
#include <algorithm>
#include <cmath>

namespace doseki {

/// What lists cost a scheme, in the time of its pair sums over lists without a skin.
///
/// With a skin s, a fraction of the support radius, a step costs 1 + growth s for its pairs, and
/// lists last s / g steps when two particles come nearer by g support radii a step; a sort and
/// build costs `build`. So the sum 1 + growth s + g build / s is smallest at s = sqrt(g build /
/// growth). It is flat there, so measured constants (docs/performance.md) serve better than a clock
/// would: a skin that followed the wall time would give every run a rounding of its own. `max_skin`
/// bounds the memory of lists.
struct SkinCosts {
    static constexpr double min_skin = 0.01;
    double build, growth, max_skin;

    double cheapest_skin(double approach_per_step) const {
        return std::clamp(std::sqrt(approach_per_step * build / growth), min_skin, max_skin);
    }
};

}  // namespace doseki
