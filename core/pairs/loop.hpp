#pragma once
// The one loop over pairs: for each particle i, a term (pair_term.hpp) adds up what its neighbours
// j give, and an epilogue takes the sums. Every i sums its own pairs in the order of its list, so
// the result does not depend on the number of threads.

#include <algorithm>

#include "base/array.hpp"
#include "base/parallel.hpp"
#include "base/phase_timer.hpp"
#include "pairs/neighbour_lists.hpp"
#include "pairs/pair_term.hpp"

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

    /// x_i - x_j [m].
    DOSEKI_FN Vec<Lanes, D> from(const std::array<Coordinate<real>, D>& x_j, real unit) const {
        Vec<Lanes, D> r_ij;
        for (int a = 0; a < D; ++a) {
            if constexpr (std::is_same_v<real, double>)
                r_ij[a] = x_[a] - x_j[a];
            else
                r_ij[a] = stdx::static_simd_cast<Lanes>(x_[a] - x_j[a]) * unit;
        }
        return r_ij;
    }
    DOSEKI_FN Pair<Lanes, D> pair(const std::array<Coordinate<real>, D>& x_j, real unit) const {
        Pair<Lanes, D> pair;
        pair.r_ij = from(x_j, unit);
        // A floor far below any spacing keeps the pair of a particle with itself harmless.
        pair.r = sqrt(max(dot(pair.r_ij, pair.r_ij), least_number<Lanes>()));
        return pair;
    }

private:
    std::array<CoordinateLanes, D> x_;
};

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

    LaneRows<real> cluster(std::uint32_t first) const {
        return {first, 0, static_cast<std::uint32_t>(records.size() - 1)};
    }
    /// Of the neighbour that an entry names.
    template <bool periodic>
    DOSEKI_FN std::array<Coordinate<real>, D> position(std::uint32_t entry) const {
        auto x = records[entry & ListEntry::index_mask].x;
        if constexpr (periodic)
            for (int a = 0; a < D; ++a) x[a] += shifts[entry >> ListEntry::index_bits][a];
        return x;
    }
};

/// Entries of one list, kept by a thread from one cluster to the next.
using EntryBuffer = Array<std::uint32_t>;

/// Calls f(entry) for the entries that `each` goes through, in their order. Of a term that knows
/// its reach, first those are picked out that are in reach of any particle i, without a branch: one
/// for each pair would be guessed wrong too often.
template <bool periodic, class Term, class Each, class F>
[[gnu::always_inline]] inline void for_each_in_reach(
    const PairLoop<Term>& loop, const LanePositions<typename Term::Real, Term::dim>& x,
    EntryBuffer& buffer, const Each& each, F&& f) {
    if constexpr (KnowsItsReach<Term>) {
        const auto reach = loop.term.reach();
        std::uint32_t *const begin = buffer.data(), *end = begin;
        each([&](std::uint32_t entry) {
            const auto r_ij = x.from(loop.template position<periodic>(entry), loop.unit);
            *end = entry;
            end += stdx::all_of(dot(r_ij, r_ij) > reach * reach) ? 0 : 1;
        });
        for (const std::uint32_t* entry = begin; entry != end; ++entry) f(*entry);
    } else {
        each(f);
    }
}

/// The sums of one cluster. Flattened: whatever gcc left as a call in here would be made for every
/// pair.
template <bool periodic, class Term>
[[gnu::flatten, gnu::noinline]] AccumulatorsOf<Term> sum_over_list(const PairLoop<Term>& loop,
                                                                   const ClusterList& list,
                                                                   std::uint32_t first,
                                                                   EntryBuffer& buffer) {
    using real = typename Term::Real;
    constexpr int D = Term::dim;
    const Term& term = loop.term;
    const LaneRows<real> rows = loop.cluster(first);
    const LanePositions<real, D> x(loop.records.data(), first, rows.highest);
    const auto i = term.load(rows);
    AccumulatorsOf<Term> sums{};
    auto pair_with = [&](std::uint32_t entry) {
        return x.pair(loop.template position<periodic>(entry), loop.unit);
    };
    auto neighbour = [](std::uint32_t entry) {
        return OneRow<Pack<real>>{entry & ListEntry::index_mask};
    };
    [[maybe_unused]] PairEntry at{first, 0};
    for_each_in_reach<periodic>(
        loop, x, buffer, [&](auto&& f) { list.for_each_moving(f); },
        [&](std::uint32_t entry) {
            if constexpr (SeesEntries<Term>)
                term.add(sums, pair_with(entry), i, term.load_moving(neighbour(entry)), at),
                    ++at.number;
            else
                term.add(sums, pair_with(entry), i, term.load_moving(neighbour(entry)));
        });
    if constexpr (requires { term.after_moving(sums); }) term.after_moving(sums);
    for_each_in_reach<periodic>(
        loop, x, buffer, [&](auto&& f) { list.for_each_fixed(f); },
        [&](std::uint32_t entry) {
            term.add_fixed(sums, pair_with(entry), i, term.load_fixed(neighbour(entry)));
        });
    return sums;
}

struct PairLoopOptions {
    bool skip_empty = false;        // particles without any neighbour have no epilogue either
    std::size_t first_cluster = 0;  // number of the first cluster that is given
    PhaseTimer* sampled = nullptr;  // times the epilogue of some clusters
    const Array<std::uint32_t>* only = nullptr;  // numbers of those that are summed; none: all
};

/// Calls the epilogue for each particle of a cluster.
template <class Term, class Epilogue>
void run_epilogue(const Epilogue& epilogue, std::uint32_t first, std::size_t count,
                  const AccumulatorsOf<Term>& sums) {
    for (std::size_t lane = 0; lane < count; ++lane)
        epilogue(first + lane, lane_of<AccumulatorsOf<Term, double>>(sums, static_cast<int>(lane)));
}

template <bool periodic, class Term, class Epilogue>
void for_each_pair(const Neighbours<Term::dim>& neighbours, std::span<const ClusterList> clusters,
                   std::span<const MotionRecord<typename Term::Real, Term::dim>> records,
                   const CoordinateFrame<typename Term::Real, Term::dim>& frame, const Term& term,
                   const Epilogue& epilogue, const PairLoopOptions& options = {}) {
    static_assert(check_pair_term<Term, Epilogue>());
    using real = typename Term::Real;
    constexpr std::uint32_t width = lanes<real>;
    const PairLoop<Term> loop{records, image_shifts(neighbours, frame),
                              static_cast<real>(frame.unit), term};

    std::size_t longest = 0;  // no list has as many entries as words
    if constexpr (KnowsItsReach<Term>)
        for (const ClusterList& list : clusters) longest = std::max(longest, list.words());
    Array<EntryBuffer> buffers(static_cast<std::size_t>(thread_count()), EntryBuffer(longest));
    const std::size_t tasks = options.only ? options.only->size() : clusters.size();
    for_each_task(tasks, 16, [&](std::size_t thread, std::size_t task) {
        const std::size_t c = options.only ? (*options.only)[task] : task;
        if (options.skip_empty && clusters[c].empty()) return;
        const auto number = static_cast<std::uint32_t>(options.first_cluster + c);
        const std::uint32_t first = number * width;
        const auto count = std::min<std::size_t>(width, neighbours.size() - first);
        const auto sums = sum_over_list<periodic>(loop, clusters[c], first, buffers[thread]);
        if (options.sampled && options.sampled->samples(number))
            options.sampled->sample_stress(
                [&] { run_epilogue<Term>(epilogue, first, count, sums); });
        else
            run_epilogue<Term>(epilogue, first, count, sums);
    });
}

}  // namespace doseki
