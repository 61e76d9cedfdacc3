#pragma once
#include <cmath>
#include <ctime>
#include <unordered_map>

#include "base/array.hpp"
#include "pairs/pair_counter.hpp"
#include "ueta2022/interactions.hpp"
#include "ueta2022/right_hand_side.hpp"

namespace doseki {

/// The pair loop by itself, for the bench: how fast the two sums of the ueta2022 scheme run when
/// everything they read is in cache.
template <class Scheme>
class PairProbe {
public:
    using real = typename Scheme::Real;
    static constexpr int D = Scheme::dim;
    using Backend = typename Scheme::Backend;
    using Lists = typename Backend::template Lists<D>;

    PairProbe(const Scheme& scheme, const Lists& lists)
        : scheme_(scheme), lists_(lists), counter_(scheme, lists) {}

    /// Such pairs per second of one thread in both sums over a few clusters, over and over for
    /// `seconds` of processor time.
    double bare_rate(double seconds) const {
        const HotSet hot = hot_set();
        const double pairs = counter_.count(hot.clusters, hot.motion);
        double done = 0.0, elapsed = 0.0;
        const std::clock_t start = std::clock();
        do {
            for (int repeat = 0; repeat < 16; ++repeat) sum(hot);
            done += 16.0 * pairs;
            elapsed = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        } while (elapsed < seconds);
        return done / elapsed;
    }

private:
    static constexpr std::size_t width = Backend::width;
    static constexpr std::size_t hot_clusters = 128 / width;

    /// Clusters from the middle, with copies of all they read.
    struct HotSet {
        ListStorage lists;
        Array<ClusterList> clusters;
        Array<MotionRecord<real, D>> motion;
        Array<StressRecord<real, D>> stress;
    };

    HotSet hot_set() const {
        const std::size_t whole = lists_.moving() / width;
        if (whole < hot_clusters)
            throw ResourceFailure("too few particles to measure the pair loop on");
        const std::size_t first = (whole - hot_clusters) / 2;
        const auto chosen = lists_.clusters().subspan(first, hot_clusters);
        HotSet hot;
        std::unordered_map<std::uint32_t, std::uint32_t> place;
        auto place_of = [&](std::uint32_t p) {
            const auto [found, is_new] =
                place.try_emplace(p, static_cast<std::uint32_t>(place.size()));
            if (is_new)
                hot.motion.push_back(scheme_.motion_records()[p]),
                    hot.stress.push_back(scheme_.stress_records()[p]);
            return found->second;
        };
        for (std::size_t p = first * width; p < (first + hot_clusters) * width; ++p)
            place_of(static_cast<std::uint32_t>(p));
        for (const ClusterList& list : chosen) {
            Array<std::uint32_t> entries;
            auto add = [&](std::uint32_t entry) {
                entries.push_back(place_of(entry & ListEntry::index_mask) |
                                  (entry & ~ListEntry::index_mask));
            };
            list.for_each_moving(add);
            const std::size_t moving = entries.size();
            list.for_each_fixed(add);
            hot.clusters.push_back(hot.lists.keep(entries, moving));
        }
        return hot;
    }

    void sum(const HotSet& hot) const {
        const std::span<const MotionRecord<real, D>> motion(hot.motion);
        const std::span<const StressRecord<real, D>> stress(hot.stress);
        const PairsOf<Backend, D> pairs{hot.clusters, motion, scheme_.frame(), {}};
        volatile double sink = 0.0;
        auto keep_gradient = [&](std::size_t, const Mat<double, D>& gradient) {
            sink = gradient.element[0];
        };
        auto keep_acceleration = [&](std::size_t, const MomentumAccumulators<double, D>& sums) {
            sink = sums.acceleration[0] + sums.max_v_sig;
        };
        Backend::sum_pairs(lists_, pairs, VelocityGradientTerm<GradientOf::own_h, real, D>{motion},
                           keep_gradient);
        const MomentumOptions<real> constants{static_cast<real>(scheme_.options().alpha), true};
        Backend::sum_pairs(lists_, pairs,
                           MomentumTerm<GradientOf::own_h, real, D>{motion, stress, constants},
                           keep_acceleration);
    }

    const Scheme& scheme_;
    const Lists& lists_;
    PairCounter<Scheme> counter_;
};

template <int D, class real, class Backend>
double Ueta2022<D, real, Backend>::bare_pair_rate(const Lists& lists, double seconds) const
    requires std::is_same_v<typename Lists::List, ClusterList>
{
    return PairProbe(*this, lists).bare_rate(seconds);
}

}  // namespace doseki
