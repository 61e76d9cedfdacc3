#pragma once
#include <cmath>
#include <ctime>
#include <unordered_map>
#include <vector>

#include "rates.hpp"

namespace doseki {

/// Neighbours of W particles, by kind.
template <class T>
struct Counts {
    T moving{}, fixed{};
};

/// Counts, for each particle, the neighbours within the larger of two supports; not itself.
template <class real, int D, class Finish>
struct CountTerm {
    template <class T>
    using Point = MotionPoint<T, D>;
    template <class T>
    using Sums = Counts<T>;

    std::span<const MotionRecord<real, D>> motion;
    const Finish& finish_particle;

    auto load(std::uint32_t first) const { return load_motion<real, D>(motion, first); }
    DOSEKI_FN auto load_one(std::uint32_t j) const { return broadcast_motion(motion[j]); }
    DOSEKI_FN auto load_fixed(std::uint32_t j) const { return load_one(j); }

    template <class T>
    DOSEKI_FN static T is_near(const Pair<T, D>& pair, const Point<T>& i, const Point<T>& j) {
        const T q = pair.r * min(i.inverse_support, j.inverse_support);
        return select(q < T(1) && q > number<T>(1e-9), T(1), T(0));
    }
    template <class T>
    DOSEKI_FN void add(Sums<T>& count, const Pair<T, D>& pair, const Point<T>& i,
                       const Point<T>& j) const {
        count.moving += is_near(pair, i, j);
    }
    template <class T>
    DOSEKI_FN void add_fixed(Sums<T>& count, const Pair<T, D>& pair, const Point<T>& i,
                             const Point<T>& j) const {
        count.fixed += is_near(pair, i, j);
    }
    template <class T>
    void moving_done(Sums<T>&) const {}
    template <class T>
    void finish(std::uint32_t first, int count, const Sums<T>& sums) const {
        for (int l = 0; l < count; ++l)
            finish_particle(first + l, static_cast<double>(sums.moving[l]),
                            static_cast<double>(sums.fixed[l]));
    }
};

/// How many pairs a scheme of type Rates sums over.
template <class Rates, class Lists>
class PairCounter {
public:
    PairCounter(const Rates& rates, const Lists& neighbours)
        : rates_(rates), neighbours_(neighbours) {}

    /// Pairs (i, j), each way counted, that are within support of each other.
    double interacting_pairs() const { return count(neighbours_.clusters(), rates_.motion_); }

    /// Neighbours within support of each particle, ghosts left out.
    std::vector<double> counts() const { return counts(neighbours_.clusters(), rates_.motion_); }

    template <class Motion>
    double count(std::span<const ClusterList> clusters, const Motion& motion) const {
        double total = 0.0;
        for (double count : counts(clusters, motion)) total += count;
        return total;
    }

    template <class Motion>
    std::vector<double> counts(std::span<const ClusterList> clusters, const Motion& motion) const {
        std::vector<double> of_particle(motion.size());
        // A cluster that holds moving and fixed particles lists fixed ones for both.
        auto finish = [&](std::size_t p, double moving, double fixed) {
            of_particle[p] = moving + (p < neighbours_.moving() ? fixed : 0.0);
        };
        for_each(clusters, motion,
                 CountTerm<typename Rates::Real, Rates::dim, decltype(finish)>{motion, finish});
        return of_particle;
    }

    template <class Motion, class Term>
    void for_each(std::span<const ClusterList> clusters, const Motion& motion,
                  const Term& term) const {
        const std::span<const MotionRecord<typename Rates::Real, Rates::dim>> records(motion);
        if (rates_.periodic_)
            for_each_pair<true>(neighbours_, clusters, records, rates_.frame_, false, term);
        else
            for_each_pair<false>(neighbours_, clusters, records, rates_.frame_, false, term);
    }

private:
    const Rates& rates_;
    const Lists& neighbours_;
};

/// The pair loop by itself, for the bench: how fast the two sums of the ueta2022 scheme run when
/// everything they read is in cache.
template <class real, int D>
class PairProbe {
public:
    PairProbe(const Rates<real, D>& rates, const Neighbours<D>& neighbours)
        : rates_(rates), neighbours_(neighbours), counter_(rates, neighbours) {}

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
    static constexpr std::size_t width = lanes<real>;
    static constexpr std::size_t hot_clusters = 128 / width;

    /// Clusters from the middle, with copies of all they read.
    struct HotSet {
        ListStorage lists;
        std::vector<ClusterList> clusters;
        std::vector<MotionRecord<real, D>> motion;
        std::vector<StressRecord<real, D>> stress;
    };

    HotSet hot_set() const {
        const std::size_t whole = neighbours_.moving() / width;
        if (whole < hot_clusters)
            throw ResourceFailure("too few particles to measure the pair loop on");
        const std::size_t first = (whole - hot_clusters) / 2;
        const auto chosen = neighbours_.clusters().subspan(first, hot_clusters);
        HotSet hot;
        std::unordered_map<std::uint32_t, std::uint32_t> place;
        auto place_of = [&](std::uint32_t p) {
            const auto [found, is_new] =
                place.try_emplace(p, static_cast<std::uint32_t>(place.size()));
            if (is_new)
                hot.motion.push_back(rates_.motion_[p]), hot.stress.push_back(rates_.stress_[p]);
            return found->second;
        };
        for (std::size_t p = first * width; p < (first + hot_clusters) * width; ++p)
            place_of(static_cast<std::uint32_t>(p));
        for (const ClusterList& list : chosen) {
            std::vector<std::uint32_t> entries;
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
        volatile double sink = 0.0;
        auto keep_gradient = [&](std::size_t, const Mat<double, D>& gradient) {
            sink = gradient.element[0];
        };
        auto keep_acceleration = [&](std::size_t, const auto& sums) {
            sink = sums.acceleration[0] + sums.max_v_sig;
        };
        counter_.for_each(hot.clusters, motion,
                          VelocityGradientTerm<GradientOf::own_h, real, D, decltype(keep_gradient)>{
                              motion, keep_gradient});
        counter_.for_each(hot.clusters, motion,
                          MomentumTerm<GradientOf::own_h, real, D, decltype(keep_acceleration)>{
                              motion,
                              stress,
                              {static_cast<real>(rates_.options_.alpha), true},
                              keep_acceleration});
    }

    const Rates<real, D>& rates_;
    const Neighbours<D>& neighbours_;
    PairCounter<Rates<real, D>, Neighbours<D>> counter_;
};

}  // namespace doseki
