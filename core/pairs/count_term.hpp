#pragma once
#include <span>

#include "pairs/pair_term.hpp"

namespace doseki {

/// Neighbours of W particles, by kind.
template <class T>
struct NeighbourCounts {
    T moving{}, fixed{};

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.moving...), f(self.fixed...);
    }
};

/// Counts, for each particle, the neighbours within the larger of two supports; not itself.
template <class real, int D>
struct CountTerm {
    using Real = real;
    static constexpr int dim = D;
    template <class T>
    using Accumulators = NeighbourCounts<T>;

    std::span<const MotionRecord<real, D>> motion;

    template <class Rows>
    DOSEKI_FN auto load(Rows rows) const {
        return take<MotionPoint<typename Rows::Number, D>>(motion, rows);
    }
    template <class T>
    DOSEKI_FN auto load_moving(OneRow<T> j) const {
        return load(j);
    }
    template <class T>
    DOSEKI_FN auto load_fixed(OneRow<T> j) const {
        return load(j);
    }

    template <class T>
    DOSEKI_FN static T is_near(const Pair<T, D>& pair, const MotionPoint<T, D>& i,
                               const MotionPoint<T, D>& j) {
        const T q = pair.r * min(i.inverse_support, j.inverse_support);
        return select(q < T(1) && q > number<T>(1e-9), T(1), T(0));
    }
    template <class T>
    DOSEKI_FN void add(NeighbourCounts<T>& count, const Pair<T, D>& pair,
                       const MotionPoint<T, D>& i, const MotionPoint<T, D>& j) const {
        count.moving += is_near(pair, i, j);
    }
    template <class T>
    DOSEKI_FN void add_fixed(NeighbourCounts<T>& count, const Pair<T, D>& pair,
                             const MotionPoint<T, D>& i, const MotionPoint<T, D>& j) const {
        count.fixed += is_near(pair, i, j);
    }
};

}  // namespace doseki
