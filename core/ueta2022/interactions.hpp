#pragma once
// The two sums of the ueta2022 scheme as terms of the pair loop (pairs/pair_term.hpp).

#include <span>

#include "pairs/rows.hpp"
#include "ueta2022/accumulators.hpp"

namespace doseki {

/// Eq. (9): sums rho_i L.
template <GradientOf of, class real, int D>
struct VelocityGradientTerm {
    using Real = real;
    static constexpr int dim = D;
    template <class T>
    using Accumulators = Mat<T, D>;

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
    DOSEKI_FN void add(Mat<T, D>& gradient, const Pair<T, D>& pair, const MotionPoint<T, D>& i,
                       const MotionPoint<T, D>& j) const {
        add_velocity_gradient(gradient, j.mass, i.v - j.v, gradient_factor<of, D>(pair.r, i, j),
                              pair.r_ij);
    }
    template <class T>
    DOSEKI_FN void add_fixed(Mat<T, D>& gradient, const Pair<T, D>& pair,
                             const MotionPoint<T, D>& i, const MotionPoint<T, D>& j) const {
        add(gradient, pair, i, j);
    }
};

/// Eqs. (12)-(16) and (18).
template <GradientOf of, class real, int D>
struct MomentumTerm {
    using Real = real;
    static constexpr int dim = D;
    template <class T>
    using Accumulators = MomentumAccumulators<T, D>;

    std::span<const MotionRecord<real, D>> motion;
    std::span<const StressRecord<real, D>> stress;
    MomentumOptions<real> options;

    template <class Rows>
    DOSEKI_FN auto load(Rows rows) const {
        using T = typename Rows::Number;
        return MomentumPoint<T, D>{take<MotionPoint<T, D>>(motion, rows),
                                   take<StressPoint<T, D>>(stress, rows)};
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
    DOSEKI_FN void add(Accumulators<T>& sums, const Pair<T, D>& pair, const MomentumPoint<T, D>& i,
                       const MomentumPoint<T, D>& j) const {
        add_momentum<of>(sums, options, pair, i, j, T(0));
    }
    template <class T>
    DOSEKI_FN void add_fixed(Accumulators<T>& sums, const Pair<T, D>& pair,
                             const MomentumPoint<T, D>& i, const MomentumPoint<T, D>& j) const {
        add_momentum<of>(sums, options, pair, i, j,
                         options.fixed_limits_dt ? T(0) : max(T(0), j.c - i.c));
    }
    /// A pair of moving particles is met twice, one with a fixed particle once.
    template <class T>
    DOSEKI_FN void after_moving(Accumulators<T>& sums) const {
        sums.av_power *= number<T>(0.5);
    }
};

}  // namespace doseki
