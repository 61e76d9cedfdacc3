#pragma once
// The one loop over pairs. A term is what a scheme sums over the neighbours j of a point i:
//
//   struct Term {
//     template <class T> struct Sums;                              // starts at zero
//     template <class T> using Point = ...;                        // what i and j bring
//     Point<Pack> load(std::uint32_t first) const;                 // W particles i
//     Point<Pack> load_one(std::uint32_t j) const;                 // one j in all lanes
//     ... load_fixed(std::uint32_t j) const;                       // as load_one, of a fixed j
//     void add(Sums<T>&, const Pair<T, D>&, const Point<T>& i, const Point<T>& j) const;
//     void moving_done(Sums<T>&) const;      // between moving and fixed neighbours
//     void add_fixed(...) const;             // as add, of a fixed j
//     void finish(std::uint32_t first, int count, const Sums<T>&) const;
//   };
//
// Terms never see lists, lanes or threads. Every i sums its own pairs in the order of its list, so
// the result does not depend on the number of threads.

#include <algorithm>

#include "base/parallel.hpp"
#include "neighbours.hpp"
#include "records.hpp"

namespace doseki {

/// Positions of W particles i, to be subtracted from those of one j.
template <class real, int D>
class LanePositions {
    using Lanes = Pack<real>;
    using CoordinateLanes = stdx::rebind_simd_t<Coordinate<real>, Lanes>;

public:
    LanePositions(const MotionRecord<real, D>* records, std::uint32_t first, std::uint32_t last) {
        for (int a = 0; a < D; ++a)
            x_[a] = CoordinateLanes(
                [&](auto l) { return records[std::min<std::uint32_t>(first + l, last)].x[a]; });
    }

    DOSEKI_FN Pair<Lanes, D> pair(const std::array<Coordinate<real>, D>& x_j, real unit) const {
        Pair<Lanes, D> pair;
        for (int a = 0; a < D; ++a) {
            if constexpr (std::is_same_v<real, double>)
                pair.r_ij[a] = x_[a] - x_j[a];
            else
                pair.r_ij[a] = stdx::static_simd_cast<Lanes>(x_[a] - x_j[a]) * unit;
        }
        // A floor far below any spacing keeps the pair of a particle with itself harmless.
        pair.r = sqrt(max(dot(pair.r_ij, pair.r_ij), Lanes(std::numeric_limits<real>::min())));
        return pair;
    }

private:
    std::array<CoordinateLanes, D> x_;
};

/// Image shifts in units of the records' coordinates.
template <class real, int D>
std::vector<std::array<Coordinate<real>, D>> image_shifts(const Neighbours<D>& neighbours,
                                                          const CoordinateFrame<real, D>& frame) {
    std::vector<std::array<Coordinate<real>, D>> shifts;
    for (const auto& shift : neighbours.image_shifts()) {
        std::array<Coordinate<real>, D> units;
        for (int a = 0; a < D; ++a) units[a] = static_cast<Coordinate<real>>(shift[a] / frame.unit);
        shifts.push_back(units);
    }
    return shifts;
}

/// What all clusters of one loop share.
template <class real, int D, class Term>
struct PairLoop {
    std::span<const MotionRecord<real, D>> records;
    std::vector<std::array<Coordinate<real>, D>> shifts;
    real unit;
    const Term& term;
};

/// The sums of one cluster. Flattened: whatever gcc left as a call in here would be made for every
/// pair.
template <bool periodic, class real, int D, class Term>
[[gnu::flatten, gnu::noinline]] auto sum_over_list(const PairLoop<real, D, Term>& loop,
                                                   const ClusterList& list, std::uint32_t first) {
    const Term& term = loop.term;
    const LanePositions<real, D> x(loop.records.data(), first,
                                   static_cast<std::uint32_t>(loop.records.size() - 1));
    const auto i = term.load(first);
    typename Term::template Sums<Pack<real>> sums{};
    auto pair_with = [&](std::uint32_t entry) {
        auto x_j = loop.records[entry & ListEntry::index_mask].x;
        if constexpr (periodic)
            for (int a = 0; a < D; ++a) x_j[a] += loop.shifts[entry >> ListEntry::index_bits][a];
        return x.pair(x_j, loop.unit);
    };
    list.for_each_moving([&](std::uint32_t entry) {
        term.add(sums, pair_with(entry), i, term.load_one(entry & ListEntry::index_mask));
    });
    term.moving_done(sums);
    list.for_each_fixed([&](std::uint32_t entry) {
        term.add_fixed(sums, pair_with(entry), i, term.load_fixed(entry & ListEntry::index_mask));
    });
    return sums;
}

/// `skip_empty`: particles without any neighbour are not finished either. `first_cluster`: number
/// of the first of `clusters`.
template <bool periodic, class real, int D, class Term>
void for_each_pair(const Neighbours<D>& neighbours, std::span<const ClusterList> clusters,
                   std::span<const MotionRecord<real, D>> records,
                   const CoordinateFrame<real, D>& frame, bool skip_empty, const Term& term,
                   std::size_t first_cluster = 0) {
    constexpr std::uint32_t width = lanes<real>;
    const PairLoop<real, D, Term> loop{records, image_shifts(neighbours, frame),
                                       static_cast<real>(frame.unit), term};

#pragma omp parallel for schedule(dynamic, 16) if (clusters.size() > pair_loop)
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        if (skip_empty && clusters[c].empty()) continue;
        const auto first = static_cast<std::uint32_t>(first_cluster + c) * width;
        const auto count = std::min<std::size_t>(width, neighbours.size() - first);
        term.finish(first, static_cast<int>(count),
                    sum_over_list<periodic>(loop, clusters[c], first));
    }
}

}  // namespace doseki
