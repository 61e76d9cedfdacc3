#pragma once
#include <algorithm>
#include <limits>
#include <span>

#include "base/vec.hpp"

namespace doseki {

/// A box along the axes; empty until something is added to nowhere().
template <int D>
struct Box {
    Vec<double, D> low, high;

    DOSEKI_DEVICE_FN static Box nowhere() {
        Box box;
        for (int a = 0; a < D; ++a) {
            box.low[a] = std::numeric_limits<double>::infinity();
            box.high[a] = -std::numeric_limits<double>::infinity();
        }
        return box;
    }

    DOSEKI_DEVICE_FN bool is_empty() const { return low[0] > high[0]; }
    DOSEKI_DEVICE_FN Vec<double, D> size() const { return high - low; }
    DOSEKI_DEVICE_FN Vec<double, D> middle() const { return 0.5 * (low + high); }

    DOSEKI_DEVICE_FN void add(const Vec<double, D>& x) { add(Box{x, x}); }
    DOSEKI_DEVICE_FN void add(const Box& other) {
        for (int a = 0; a < D; ++a) {
            low[a] = std::min(low[a], other.low[a]);
            high[a] = std::max(high[a], other.high[a]);
        }
    }
};

/// The box around one of some places, for a reduction over them (base/bulk.hpp).
template <int D>
struct BoxAround {
    std::span<const Vec<double, D>> position;

    DOSEKI_DEVICE_FN Box<D> operator()(std::size_t p) const { return {position[p], position[p]}; }
};

}  // namespace doseki
