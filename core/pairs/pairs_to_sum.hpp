#pragma once
// What a back end is given to sum over pairs.

#include <array>
#include <span>

#include "base/array.hpp"
#include "base/phase_timer.hpp"
#include "cells/sorted_cells.hpp"
#include "pairs/records.hpp"

namespace doseki {

struct PairLoopOptions {
    bool skip_empty = false;        // particles without any neighbour have no epilogue either
    std::size_t first_cluster = 0;  // number of the first cluster that is given
    PhaseTimer* sampled = nullptr;  // times the epilogue of some clusters
    const Array<std::uint32_t>* only = nullptr;  // numbers of those that are summed; none: all
};

/// Between which particles a sum runs: clusters of lists and the records they refer to.
template <class real, int D, class List>
struct PairsToSum {
    std::span<const List> clusters;
    std::span<const MotionRecord<real, D>> records;
    CoordinateFrame<real, D> frame;
    PairLoopOptions options;
};

/// Image shifts in units of the records' coordinates.
template <class real, int D>
Array<std::array<Coordinate<real>, D>> image_shifts(const SortedCells<D>& cells,
                                                    const CoordinateFrame<real, D>& frame) {
    Array<std::array<Coordinate<real>, D>> shifts;
    for (const auto& shift : cells.image_shifts()) {
        std::array<Coordinate<real>, D> units;
        for (int a = 0; a < D; ++a) units[a] = static_cast<Coordinate<real>>(shift[a] / frame.unit);
        shifts.push_back(units);
    }
    return shifts;
}

/// Where neighbours are, by the entries of lists.
template <class real, int D>
struct NeighbourPlaces {
    using Place = std::array<Coordinate<real>, D>;

    std::span<const MotionRecord<real, D>> records;
    std::span<const Place> shifts;  // of images, in units of the records' coordinates
    real unit;

    /// Of the neighbour that an entry names.
    template <bool periodic>
    DOSEKI_FN Place position(std::uint32_t entry) const {
        auto x = records[entry & ListEntry::index_mask].x;
        if constexpr (periodic)
            for (int a = 0; a < D; ++a) x[a] += shifts[entry >> ListEntry::index_bits][a];
        return x;
    }
    /// The last particle that has a record.
    std::uint32_t last() const { return static_cast<std::uint32_t>(records.size() - 1); }
};

/// From a place to another, whose coordinates these are.
template <class T, int D, class X>
DOSEKI_FN Vec<T, D> difference(const std::array<X, D>& x, const std::array<X, D>& from,
                               const T& unit) {
    Vec<T, D> r;
    for (int a = 0; a < D; ++a) r[a] = static_cast<T>(x[a] - from[a]) * unit;
    return r;
}

/// A floor far below any spacing keeps the pair of a particle with itself harmless.
template <class T, int D>
DOSEKI_FN Pair<T, D> pair_of(const Vec<T, D>& r_ij) {
    return {r_ij, sqrt(max(dot(r_ij, r_ij), least_number<T>()))};
}

}  // namespace doseki
