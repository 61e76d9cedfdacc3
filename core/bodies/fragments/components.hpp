#pragma once
#include <cstdint>
#include <limits>

#include "base/array.hpp"

namespace doseki {

/// Connected components, Eq. (120): for each of n points the least number of those with which it
/// holds together. `for_each_bond(p, f)` calls f(j) for the points j to which p holds.
template <class ForEachBond>
Array<std::uint32_t> components(std::size_t n, const ForEachBond& for_each_bond) {
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    Array<std::uint32_t> label(n, none), reached;
    for (std::uint32_t first = 0; first < n; ++first) {
        if (label[first] != none) continue;
        label[first] = first;
        reached.assign(1, first);
        for (std::size_t k = 0; k < reached.size(); ++k)
            for_each_bond(reached[k], [&](std::uint32_t j) {
                if (label[j] == none) label[j] = first, reached.push_back(j);
            });
    }
    return label;
}

}  // namespace doseki
