#pragma once
// Where the particles of a pair loop are, as many at once as a pack has lanes, and the sums of a
// term that knows its reach: of the list of a cluster, those neighbours are picked out that are in
// reach of any particle of a group, and summed several at once, each in the lanes of one group
// (group_size).

#include <algorithm>
#include <span>

#include "base/array.hpp"
#include "pairs/neighbour_lists.hpp"
#include "pairs/pair_term.hpp"
#include "pairs/pairs_to_sum.hpp"

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

/// What all clusters of one loop share.
template <class Term>
struct PairLoop : NeighbourPlaces<typename Term::Real, Term::dim> {
    using real = typename Term::Real;
    static constexpr int D = Term::dim;

    const Term& term;

    PairLoop(const NeighbourPlaces<real, D>& places, const Term& given)
        : NeighbourPlaces<real, D>(places), term(given) {}

    /// Of as many neighbours as there are groups of lanes, each in one of them.
    template <bool periodic>
    DOSEKI_FN auto positions(const std::uint32_t* entries) const {
        using Lanes = stdx::rebind_simd_t<Coordinate<real>, Pack<real>>;
        std::array<Lanes, D> x;
        [&]<std::size_t... k>(std::index_sequence<k...>) {
            const std::array<std::array<Coordinate<real>, D>, sizeof...(k)> of{
                this->template position<periodic>(entries[k])...};
            for (int a = 0; a < D; ++a) FillGroups{}(x[a], of[k][a]...);
        }(std::make_index_sequence<static_cast<std::size_t>(abreast<real>)>{});
        return x;
    }
};

/// The neighbours of one group, in the order of the list.
template <class real>
class EntriesInReach {
public:
    explicit EntriesInReach(std::size_t longest)
        : entries_(longest + static_cast<std::size_t>(abreast<real>)) {}

    void clear() { count_ = 0; }
    /// Without a branch: one for each pair would be guessed wrong too often.
    DOSEKI_FN void add_if(bool near, std::uint32_t entry) {
        entries_[count_] = entry;
        count_ += near ? 1 : 0;
    }
    /// Repeats the last, so that those taken at once are always there.
    void fill_up() {
        for (int k = 1; k < abreast<real> && count_ > 0; ++k)
            entries_[count_ + k - 1] = entries_[count_ - 1];
    }
    std::size_t count() const { return count_; }
    const std::uint32_t* data() const { return entries_.data(); }

private:
    Array<std::uint32_t> entries_;
    std::size_t count_ = 0;
};

/// Kept by a thread from one cluster to the next.
template <class Term>
class GroupSums {
    using real = typename Term::Real;
    using Lanes = Pack<real>;
    using Sums = AccumulatorsOf<Term, double>;
    using Entries = EntriesInReach<real>;
    static constexpr int D = Term::dim;
    static constexpr std::size_t groups = abreast<real>;

public:
    explicit GroupSums(std::span<const ClusterList> clusters) {
        if constexpr (KnowsItsReach<Term>) {
            std::size_t longest = 0;  // no list has as many entries as words
            for (const ClusterList& list : clusters) longest = std::max(longest, list.words());
            moving_.assign(groups, Entries(longest)), fixed_.assign(groups, Entries(longest));
        }
    }

    /// The sums of `count` particles from the first of a cluster on.
    template <bool periodic>
    void sum(const PairLoop<Term>& loop, const ClusterList& list, std::uint32_t first,
             std::size_t count) {
        pick<periodic>(loop, list, first);
        for (std::size_t g = 0; g * group_size<real> < count; ++g) {
            const auto start = static_cast<std::uint32_t>(first + g * group_size<real>);
            const auto sums = sum_group<periodic>(loop, start, moving_[g], fixed_[g]);
            for (std::size_t k = 0; k < group_size<real>; ++k)
                sums_[g * group_size<real> + k] = folded(sums, static_cast<int>(k));
        }
    }
    /// Of particle k of the cluster.
    const Sums& of(std::size_t k) const { return sums_[k]; }

private:
    template <bool periodic>
    [[gnu::flatten, gnu::noinline]] void pick(const PairLoop<Term>& loop, const ClusterList& list,
                                              std::uint32_t first) {
        const LanePositions<real, D> x(loop.records.data(), first, loop.last());
        const real reach = loop.term.reach();
        const Lanes group = lane_group<real>(), square = reach * reach;
        auto pick_of = [&](Array<Entries>& found) {
            for (Entries& entries : found) entries.clear();
            return [&](std::uint32_t entry) {
                const auto r_ij = x.from(loop.template position<periodic>(entry), loop.unit);
                const auto far = dot(r_ij, r_ij) > square;
                for (std::size_t g = 0; g < groups; ++g)
                    found[g].add_if(!stdx::all_of(far || group != static_cast<real>(g)), entry);
            };
        };
        list.for_each_moving(pick_of(moving_));
        list.for_each_fixed(pick_of(fixed_));
        for (std::size_t g = 0; g < groups; ++g) moving_[g].fill_up(), fixed_[g].fill_up();
    }

    /// Calls add(pair, rows) for the entries, as many at once as there are groups of lanes.
    template <bool periodic, class Positions, class Add>
    DOSEKI_FN static void for_each_abreast(const PairLoop<Term>& loop, const Positions& x,
                                           const Entries& entries, Add&& add) {
        const Lanes group = lane_group<real>(), nowhere = real(2) * loop.term.reach();
        const std::uint32_t* entry = entries.data();
        for (std::size_t left = entries.count(); left > 0; entry += groups) {
            RowsAbreast<real> rows;
            for (std::size_t k = 0; k < groups; ++k) rows.j[k] = entry[k] & ListEntry::index_mask;
            Vec<Lanes, D> r_ij = x.from(loop.template positions<periodic>(entry), loop.unit);
            if constexpr (groups > 1)
                stdx::where(group >= static_cast<real>(left), r_ij[0]) = nowhere;
            add(pair_of(r_ij), rows);
            left -= std::min(left, groups);
        }
    }

    /// Flattened: whatever gcc left as a call in here would be made for every pair.
    template <bool periodic>
    [[gnu::flatten, gnu::noinline]] static AccumulatorsOf<Term> sum_group(
        const PairLoop<Term>& loop, std::uint32_t first, const Entries& moving,
        const Entries& fixed) {
        const Term& term = loop.term;
        const LanePositions<real, D, group_size<real>> x(loop.records.data(), first, loop.last());
        const auto i = term.load(LaneRows<real, group_size<real>>{first, 0, loop.last()});
        AccumulatorsOf<Term> sums{};
        for_each_abreast<periodic>(loop, x, moving, [&](const auto& pair, const auto& j) {
            term.add(sums, pair, i, term.load_moving(j));
        });
        if constexpr (requires { term.after_moving(sums); }) term.after_moving(sums);
        for_each_abreast<periodic>(loop, x, fixed, [&](const auto& pair, const auto& j) {
            term.add_fixed(sums, pair, i, term.load_fixed(j));
        });
        return sums;
    }

    /// What all groups of lanes have summed for particle k of a group.
    static Sums folded(const AccumulatorsOf<Term>& packed, int k) {
        Sums sums = lane_of<Sums>(packed, k);
        for (int lane = k + group_size<real>; lane < lanes<real>; lane += group_size<real>)
            add_members(sums, lane_of<Sums>(packed, lane));
        return sums;
    }

    Array<Entries> moving_, fixed_;  // of each group
    std::array<Sums, static_cast<std::size_t>(lanes<real>)> sums_;
};

}  // namespace doseki
