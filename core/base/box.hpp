#pragma once
#include <algorithm>
#include <limits>

#include "base/vec.hpp"

namespace doseki {

/// A box along the axes; empty until something is added to nowhere().
template <int D>
struct Box {
    Vec<double, D> low, high;

    static Box nowhere() {
        Box box;
        box.low.component.fill(std::numeric_limits<double>::infinity());
        box.high.component.fill(-std::numeric_limits<double>::infinity());
        return box;
    }

    bool is_empty() const { return low[0] > high[0]; }
    Vec<double, D> size() const { return high - low; }

    void add(const Vec<double, D>& x) { add(Box{x, x}); }
    void add(const Box& other) {
        for (int a = 0; a < D; ++a) {
            low[a] = std::min(low[a], other.low[a]);
            high[a] = std::max(high[a], other.high[a]);
        }
    }
};

}  // namespace doseki
