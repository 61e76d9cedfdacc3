#pragma once
#include <algorithm>
#include <cmath>

namespace doseki {

/// The skin, as a fraction of the support radius, with which lists and pairs together are cheapest.
///
/// With a skin s a step costs 1 + growth s for its pairs, and lists last s / g steps when two
/// particles come nearer by g support radii a step; in the same unit a sort and build costs
/// `build`. So the sum 1 + growth s + g build / s is smallest at s = sqrt(g build / growth). It is
/// flat there, so measured constants (docs/performance.md) serve better than a clock would: a skin
/// that followed the wall time would give every run a rounding of its own.
template <int D>
struct CheapestSkin {
    static constexpr double build = D == 2 ? 0.7 : 1.0;
    static constexpr double growth = D == 2 ? 1.6 : 2.6;
    static constexpr double min_skin = 0.01, max_skin = 0.3;

    static double at(double approach_per_step) {
        return std::clamp(std::sqrt(approach_per_step * build / growth), min_skin, max_skin);
    }
};

}  // namespace doseki
