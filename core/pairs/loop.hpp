#pragma once
// The one loop over pairs: for each particle i, a term (pair_term.hpp) adds up what its neighbours
// j give, and an epilogue takes the sums. Every i sums its own pairs in the order of its list, so
// the result does not depend on the number of threads.

#include <algorithm>

#include "base/array.hpp"
#include "base/parallel.hpp"
#include "base/phase_timer.hpp"
#include "pairs/groups.hpp"

namespace doseki {

/// The sums of one cluster. Flattened: whatever gcc left as a call in here would be made for every
/// pair.
template <bool periodic, class Term>
[[gnu::flatten, gnu::noinline]] AccumulatorsOf<Term> sum_over_list(const PairLoop<Term>& loop,
                                                                   const ClusterList& list,
                                                                   std::uint32_t first) {
    using real = typename Term::Real;
    constexpr int D = Term::dim;
    const Term& term = loop.term;
    const LaneRows<real> rows{first, 0, loop.last()};
    const LanePositions<real, D> x(loop.records.data(), first, loop.last());
    const auto i = term.load(rows);
    AccumulatorsOf<Term> sums{};
    auto pair_with = [&](std::uint32_t entry) {
        return pair_of(x.from(loop.template position<periodic>(entry), loop.unit));
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

/// Whether the sums of a cluster of `count` particles are zero, as they were.
template <KnowsIdleParticles Epilogue>
bool is_idle(const ClusterList& list, std::size_t first, std::size_t count,
             const Epilogue& epilogue) {
    if (list.has_moving()) return false;
    for (std::size_t k = 0; k < count; ++k)
        if (epilogue.needs_sums(first + k)) return false;
    return !list.any_fixed(
        [&](std::uint32_t entry) { return epilogue.acts(entry & ListEntry::index_mask); });
}

template <bool periodic, class Term, class Epilogue>
void for_each_pair(const Neighbours<Term::dim>& neighbours, std::span<const ClusterList> clusters,
                   std::span<const MotionRecord<typename Term::Real, Term::dim>> records,
                   const CoordinateFrame<typename Term::Real, Term::dim>& frame, const Term& term,
                   const Epilogue& epilogue, const PairLoopOptions& options = {}) {
    static_assert(check_pair_term<Term, Epilogue>());
    using real = typename Term::Real;
    using Sums = AccumulatorsOf<Term, double>;
    constexpr std::uint32_t width = lanes<real>;
    const auto shifts = image_shifts(neighbours, frame);
    const PairLoop<Term> loop({records, shifts, static_cast<real>(frame.unit)}, term);
    Array<GroupSums<Term>> grouped(
        KnowsItsReach<Term> ? static_cast<std::size_t>(thread_count()) : 0,
        GroupSums<Term>(clusters));
    const std::size_t tasks = options.only ? options.only->size() : clusters.size();
    for_each_task(tasks, 16, [&](std::size_t thread, std::size_t task) {
        const std::size_t c = options.only ? (*options.only)[task] : task;
        if (options.skip_empty && clusters[c].empty()) return;
        const auto number = static_cast<std::uint32_t>(options.first_cluster + c);
        const std::uint32_t first = number * width;
        const auto count = std::min<std::size_t>(width, neighbours.size() - first);
        if constexpr (KnowsIdleParticles<Epilogue>)
            if (is_idle(clusters[c], first, count, epilogue)) return;
        auto hand_on = [&](const auto& sums_of) {
            auto run_epilogue = [&] {
                for (std::size_t k = 0; k < count; ++k) epilogue(first + k, sums_of(k));
            };
            if (options.sampled && options.sampled->samples(number))
                options.sampled->sample_stress(run_epilogue);
            else
                run_epilogue();
        };
        if constexpr (KnowsItsReach<Term>) {
            grouped[thread].template sum<periodic>(loop, clusters[c], first, count);
            hand_on([&](std::size_t k) -> const Sums& { return grouped[thread].of(k); });
        } else {
            const auto sums = sum_over_list<periodic>(loop, clusters[c], first);
            hand_on([&](std::size_t k) { return lane_of<Sums>(sums, static_cast<int>(k)); });
        }
    });
}

}  // namespace doseki
