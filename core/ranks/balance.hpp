#pragma once
// What particles cost, so that space is cut into parts of equal work.

#include <algorithm>

#include "base/array.hpp"
#include "base/phase_timer.hpp"
#include "pairs/list_storage.hpp"

namespace doseki {

/// How long the lists of all moving particles are, and of all fixed ones.
struct ListWords {
    double moving = 1.0, fixed = 1.0;
};

/// How long the two passes over pairs took [s].
struct PassSeconds {
    double first, second;
};

/// What an entry of a list costs [s].
struct WordCosts {
    double moving, fixed;
};

/// What each particle costs [s], from the time that pairs and everything else have taken and the
/// lengths of the lists; equal shares before there are any. `cost_model(ListWords, PassSeconds)` is
/// the scheme's: it knows which pass is over which particles.
template <class List, class CostModel>
Array<double> particle_costs(std::span<const List> clusters, std::size_t width, std::size_t moving,
                             std::size_t count, const PhaseTimer& phases, int threads,
                             const CostModel& cost_model) {
    Array<double> costs(count, 1.0);
    if (clusters.empty()) return costs;
    ListWords words;
    for (std::size_t c = 0; c < clusters.size(); ++c)
        (c * width < moving ? words.moving : words.fixed) +=
            static_cast<double>(clusters[c].words());
    const auto seconds = phases.seconds(threads);
    auto of = [&](Phase phase) { return seconds[static_cast<std::size_t>(phase)]; };
    const WordCosts word_costs =
        cost_model(words, PassSeconds{of(Phase::pass_1) + of(Phase::stress),
                                      of(Phase::continuity) + of(Phase::pass_2)});
    const double bare = (of(Phase::sort) + of(Phase::list_build) + of(Phase::pack) +
                         of(Phase::integrate) + of(Phase::bodies)) /
                        static_cast<double>(clusters.size() * width);
    for (std::size_t p = 0; p < count; ++p) {
        const std::size_t c = std::min(p / width, clusters.size() - 1);
        const double word = c * width < moving ? word_costs.moving : word_costs.fixed;
        costs[p] =
            bare + word * static_cast<double>(clusters[c].words()) / static_cast<double>(width);
    }
    return costs;
}

}  // namespace doseki
