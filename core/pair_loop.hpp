#pragma once
// The one loop over pairs. A term is what a scheme sums over the neighbours j of a point i:
//
//   struct Term {
//     template <class T> struct Sums;                              // starts at zero
//     template <class T> using Point = ...;                        // what i and j bring
//     Point<Pack> load(std::uint32_t first) const;                 // W particles i
//     Point<Pack> load_one(std::uint32_t j) const;                 // one j in all lanes
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
            x_[a] = CoordinateLanes([&](auto l) { return records[std::min<std::uint32_t>(first + l, last)].x[a]; });
    }

    DOSEKI_FN Pair<Lanes, D> pair(const std::array<Coordinate<real>, D>& x_j, real unit) const {
        Pair<Lanes, D> pair;
        for (int a = 0; a < D; ++a) {
            if constexpr (std::is_same_v<real, double>) pair.r_ij[a] = x_[a] - x_j[a];
            else pair.r_ij[a] = stdx::static_simd_cast<Lanes>(x_[a] - x_j[a]) * unit;
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

/// `skip_empty`: particles without any neighbour are not finished either.
template <bool periodic, class real, int D, class Term>
void for_each_pair(const Neighbours<D>& neighbours, std::span<const ClusterList> clusters,
                   std::span<const MotionRecord<real, D>> records,
                   const CoordinateFrame<real, D>& frame, bool skip_empty, const Term& term) {
    constexpr int width = lanes<real>;
    const auto last = static_cast<std::uint32_t>(records.size() - 1);
    const auto shifts = image_shifts(neighbours, frame);
    const real unit = static_cast<real>(frame.unit);

#pragma omp parallel for schedule(dynamic, 16) if (clusters.size() > pair_loop)
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        const ClusterList& list = clusters[c];
        if (skip_empty && list.moving + list.fixed == 0) continue;
        const auto first = static_cast<std::uint32_t>(c * width);
        const LanePositions<real, D> x(records.data(), first, last);
        const auto i = term.load(first);
        typename Term::template Sums<Pack<real>> sums{};

        auto add_entries = [&](const std::uint32_t* entry, const std::uint32_t* end, auto is_fixed) __attribute__((always_inline)) {
            for (; entry != end; ++entry) {
                const std::uint32_t j = *entry & ListEntry::index_mask;
                auto x_j = records[j].x;
                if constexpr (periodic)
                    for (int a = 0; a < D; ++a) x_j[a] += shifts[*entry >> ListEntry::index_bits][a];
                if constexpr (is_fixed) term.add_fixed(sums, x.pair(x_j, unit), i, term.load_one(j));
                else term.add(sums, x.pair(x_j, unit), i, term.load_one(j));
            }
        };
        add_entries(list.begin, list.begin + list.moving, std::false_type{});
        term.moving_done(sums);
        add_entries(list.begin + list.moving, list.begin + list.moving + list.fixed, std::true_type{});
        term.finish(first, static_cast<int>(std::min<std::uint32_t>(width, last - first + 1)), sums);
    }
}

}  // namespace doseki
