#pragma once
// Where the particles of a pair loop are, as many at once as a pack has lanes.

#include <algorithm>
#include <span>

#include "base/array.hpp"
#include "pairs/neighbour_lists.hpp"
#include "pairs/pair_term.hpp"

namespace doseki {

/// Positions of particles i, `period` of them in turn in the lanes, to be subtracted from those of
/// one j, or of one in each lane.
template <class real, int D, int period = lanes<real>>
class LanePositions {
    using Lanes = Pack<real>;
    using CoordinateLanes = stdx::rebind_simd_t<Coordinate<real>, Lanes>;

public:
    LanePositions(const MotionRecord<real, D>* records, std::uint32_t first, std::uint32_t last) {
        for (int a = 0; a < D; ++a)
            x_[a] = CoordinateLanes([&](auto l) {
                return records[std::min<std::uint32_t>(first + l % period, last)].x[a];
            });
    }

    /// x_i - x_j [m].
    template <class X>
    DOSEKI_FN Vec<Lanes, D> from(const std::array<X, D>& x_j, real unit) const {
        Vec<Lanes, D> r_ij;
        for (int a = 0; a < D; ++a) {
            if constexpr (std::is_same_v<real, double>)
                r_ij[a] = x_[a] - x_j[a];
            else
                r_ij[a] = stdx::static_simd_cast<Lanes>(x_[a] - x_j[a]) * unit;
        }
        return r_ij;
    }

private:
    std::array<CoordinateLanes, D> x_;
};

/// A floor far below any spacing keeps the pair of a particle with itself harmless.
template <class Lanes, int D>
DOSEKI_FN Pair<Lanes, D> pair_of(const Vec<Lanes, D>& r_ij) {
    return {r_ij, sqrt(max(dot(r_ij, r_ij), least_number<Lanes>()))};
}

/// Image shifts in units of the records' coordinates.
template <class real, int D>
Array<std::array<Coordinate<real>, D>> image_shifts(const Neighbours<D>& neighbours,
                                                    const CoordinateFrame<real, D>& frame) {
    Array<std::array<Coordinate<real>, D>> shifts;
    for (const auto& shift : neighbours.image_shifts()) {
        std::array<Coordinate<real>, D> units;
        for (int a = 0; a < D; ++a) units[a] = static_cast<Coordinate<real>>(shift[a] / frame.unit);
        shifts.push_back(units);
    }
    return shifts;
}

/// What all clusters of one loop share.
template <class Term>
struct PairLoop {
    using real = typename Term::Real;
    static constexpr int D = Term::dim;

    std::span<const MotionRecord<real, D>> records;
    Array<std::array<Coordinate<real>, D>> shifts;
    real unit;
    const Term& term;

    /// The last particle that has a record.
    std::uint32_t last() const { return static_cast<std::uint32_t>(records.size() - 1); }
    /// Of the neighbour that an entry names.
    template <bool periodic>
    DOSEKI_FN std::array<Coordinate<real>, D> position(std::uint32_t entry) const {
        auto x = records[entry & ListEntry::index_mask].x;
        if constexpr (periodic)
            for (int a = 0; a < D; ++a) x[a] += shifts[entry >> ListEntry::index_bits][a];
        return x;
    }
    /// Of as many neighbours as there are groups of lanes, each in one of them.
    template <bool periodic>
    DOSEKI_FN auto positions(const std::uint32_t* entries) const {
        using Lanes = stdx::rebind_simd_t<Coordinate<real>, Pack<real>>;
        std::array<Lanes, D> x;
        [&]<std::size_t... k>(std::index_sequence<k...>) {
            const std::array<std::array<Coordinate<real>, D>, sizeof...(k)> of{
                position<periodic>(entries[k])...};
            for (int a = 0; a < D; ++a) FillGroups{}(x[a], of[k][a]...);
        }(std::make_index_sequence<static_cast<std::size_t>(abreast<real>)>{});
        return x;
    }
};

}  // namespace doseki
