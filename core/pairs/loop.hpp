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
};

/// The sums of one cluster. Flattened: whatever gcc left as a call in here would be made for every
/// pair.
template <bool periodic, class Term>
[[gnu::flatten, gnu::noinline]] AccumulatorsOf<Term> sum_over_list(const PairLoop<Term>& loop,
                                                                   const ClusterList& list,
                                                                   std::uint32_t first) {
    using real = typename Term::Real;
    constexpr int D = Term::dim;
    const Term& term = loop.term;
    const LaneRows<real> rows = loop.cluster(first);
    const LanePositions<real, D> x(loop.records.data(), first, rows.highest);
    const auto i = term.load(rows);
    AccumulatorsOf<Term> sums{};
    auto pair_with = [&](std::uint32_t entry) {
        auto x_j = loop.records[entry & ListEntry::index_mask].x;
        if constexpr (periodic)
            for (int a = 0; a < D; ++a) x_j[a] += loop.shifts[entry >> ListEntry::index_bits][a];
        return x.pair(x_j, loop.unit);
    };
    auto neighbour = [](std::uint32_t entry) {
        return OneRow<Pack<real>>{entry & ListEntry::index_mask};
    };
    [[maybe_unused]] PairEntry at{first, 0};
    list.for_each_moving([&](std::uint32_t entry) {
        if constexpr (SeesEntries<Term>)
            term.add(sums, pair_with(entry), i, term.load_moving(neighbour(entry)), at),
                ++at.number;
        else
            term.add(sums, pair_with(entry), i, term.load_moving(neighbour(entry)));
    });
    if constexpr (requires { term.after_moving(sums); }) term.after_moving(sums);
    list.for_each_fixed([&](std::uint32_t entry) {
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

    const std::size_t tasks = options.only ? options.only->size() : clusters.size();
    for_each_task(tasks, 16, [&](std::size_t, std::size_t task) {
        const std::size_t c = options.only ? (*options.only)[task] : task;
        if (options.skip_empty && clusters[c].empty()) return;
        const auto number = static_cast<std::uint32_t>(options.first_cluster + c);
        const std::uint32_t first = number * width;
        const auto count = std::min<std::size_t>(width, neighbours.size() - first);
        const auto sums = sum_over_list<periodic>(loop, clusters[c], first);
        if (options.sampled && options.sampled->samples(number))
            options.sampled->sample_stress(
                [&] { run_epilogue<Term>(epilogue, first, count, sums); });
        else
            run_epilogue<Term>(epilogue, first, count, sums);
    });
}

}  // namespace doseki
