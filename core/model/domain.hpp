#pragma once
#include <array>

#include "base/vec.hpp"

namespace doseki {

/// A box with periodic directions; positions are wrapped into it at each sort.
template <int D>
struct Domain {
    Vec<double, D> low{}, high{};
    std::array<bool, D> periodic{};

    double length(int a) const { return high[a] - low[a]; }
    bool any_periodic() const {
        for (bool p : periodic)
            if (p) return true;
        return false;
    }
};

}  // namespace doseki
