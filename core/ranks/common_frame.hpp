#pragma once
#include <array>
#include <limits>
#include <span>

#include "pairs/records.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// A frame for the coordinates of the particles of all ranks.
template <class real, int D>
CoordinateFrame<real, D> common_frame(std::span<const Vec<double, D>> position,
                                      const Ranks& ranks) {
    if constexpr (std::is_same_v<real, double>) return {};
    std::array<double, 2 * D> far;  // -low, high
    far.fill(-std::numeric_limits<double>::max());
    for (const auto& x : position)
        for (int a = 0; a < D; ++a) far[a] = max(far[a], -x[a]), far[D + a] = max(far[D + a], x[a]);
    ranks.largest(far);
    Vec<double, D> low, high;
    for (int a = 0; a < D; ++a) low[a] = -far[a], high[a] = far[D + a];
    return CoordinateFrame<real, D>::covering(low, high);
}

}  // namespace doseki
