#pragma once
#include <array>
#include <span>

#include "base/box.hpp"
#include "base/bulk.hpp"
#include "pairs/records.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// A frame for the coordinates of the particles of all ranks.
template <class real, int D>
CoordinateFrame<real, D> common_frame(std::span<const Vec<double, D>> position,
                                      const Ranks& ranks) {
    if constexpr (std::is_same_v<real, double>) return {};
    const auto own =
        bulk::reduce(position.size(), Box<D>::nowhere(), joined, BoxAround<D>{position});
    std::array<double, 2 * D> far;  // -low, high
    for (int a = 0; a < D; ++a) far[a] = -own.low[a], far[D + a] = own.high[a];
    ranks.largest(far);
    Vec<double, D> low, high;
    for (int a = 0; a < D; ++a) low[a] = -far[a], high[a] = far[D + a];
    return CoordinateFrame<real, D>::covering(low, high);
}

}  // namespace doseki
