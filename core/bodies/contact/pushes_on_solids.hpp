#pragma once
#include <algorithm>
#include <span>

#include "base/array.hpp"
#include "bodies/contact_points.hpp"

namespace doseki {

/// Which pairs push the solid bodies that others touch, each with its rows in rising order. Of one
/// that many touch, as a drum is touched by its grains, parts of the sum are found side by side.
struct PushesOnSolids {
    /// So many that one part is enough but for the largest.
    static constexpr std::size_t longest_part = 256;

    Array<std::size_t> rows;
    Array<std::size_t> first_row;   // of each part, and the end of the last
    Array<std::size_t> first_part;  // of each of `solids`, and the end of the last
    Array<std::size_t> solids;

    PushesOnSolids() = default;
    /// `rows`: those of pairs with solids.
    PushesOnSolids(Array<std::size_t> of_solids, std::span<const ContactPair> pairs)
        : rows(std::move(of_solids)) {
        std::ranges::stable_sort(rows, {}, [&](std::size_t k) { return pairs[k].shape(); });
        for (std::size_t n = 0; n < rows.size(); ++n) {
            const std::size_t solid = pairs[rows[n]].shape();
            const bool begins = solids.empty() || solids.back() != solid;
            if (begins) first_part.push_back(first_row.size()), solids.push_back(solid);
            if (begins || n - first_row.back() == longest_part) first_row.push_back(n);
        }
        first_part.push_back(first_row.size()), first_row.push_back(rows.size());
    }

    std::size_t parts() const { return first_row.empty() ? 0 : first_row.size() - 1; }
};

}  // namespace doseki
