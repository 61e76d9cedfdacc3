#pragma once
// What the terms of the ueta2022 scheme sum for one pair: numbers in, numbers out. No lists, loads
// or lanes, so that one source serves packs on a processor and one thread for each particle on a
// device.

#include "physics/kernel.hpp"
#include "physics/momentum.hpp"
#include "physics/velocity_gradient.hpp"
#include "records.hpp"

namespace doseki {

/// Where a kernel gradient is taken: with the h of i alone, as Eq. (9) is printed, or as the mean
/// over h_i and h_j, as Eq. (12) is.
enum class GradientOf { own_h, mean_h };

template <GradientOf of, int D, class T>
DOSEKI_FN T gradient_factor(const T& r, const MotionPoint<T, D>& i, const MotionPoint<T, D>& j) {
    const T own = WendlandC6<D>::gradient_factor(r, i.inverse_support);
    if constexpr (of == GradientOf::own_h)
        return own;
    else
        return number<T>(0.5) * (own + WendlandC6<D>::gradient_factor(r, j.inverse_support));
}

/// One record as a T: itself, or in all lanes of a pack.
template <class T, class real, int D>
DOSEKI_FN MotionPoint<T, D> motion_point(const MotionRecord<real, D>& record) {
    MotionPoint<T, D> point;
    for (int a = 0; a < D; ++a) point.v[a] = record.v[a];
    point.mass = record.mass;
    point.inverse_support = record.inverse_support;
    return point;
}

template <class T, class real, int D>
DOSEKI_FN StressPoint<T, D> stress_point(const MotionRecord<real, D>& motion,
                                         const StressRecord<real, D>& record) {
    StressPoint<T, D> point;
    point.motion = motion_point<T>(motion);
    for (int k = 0; k < Sym<real, D>::size; ++k) point.stress.element[k] = record.stress[k];
    point.rho = record.rho, point.c = record.c, point.balsara = record.balsara;
    return point;
}

/// Eq. (9).
template <GradientOf of, int D>
struct VelocityGradientSum {
    template <class T>
    DOSEKI_FN static void add(Mat<T, D>& gradient, const Pair<T, D>& pair,
                              const MotionPoint<T, D>& i, const MotionPoint<T, D>& j) {
        add_velocity_gradient(gradient, j.mass, i.v - j.v, gradient_factor<of>(pair.r, i, j),
                              pair.r_ij);
    }
};

template <class real>
struct MomentumOptions {
    real alpha;
    bool fixed_limits_dt;  // false: in Eq. (18) a fixed j has at most the sound speed of i
};

template <class T, int D>
struct MomentumSums {
    Vec<T, D> acceleration{};
    T av_power{};  // per mass of i
    T max_v_sig{};
};

/// Eqs. (12)-(16), with the largest signal velocity for Eq. (18) and the power that the artificial
/// viscosity takes out of the moving particles.
template <GradientOf of, class real, int D>
struct MomentumSum {
    template <class T>
    using Sums = MomentumSums<T, D>;
    template <class T>
    using Point = StressPoint<T, D>;

    template <class T>
    DOSEKI_FN static void add(Sums<T>& sums, const MomentumOptions<real>& options,
                              const Pair<T, D>& pair, const Point<T>& i, const Point<T>& j) {
        add(sums, options, pair, i, j, T(0));
    }

    template <class T>
    DOSEKI_FN static void add_fixed(Sums<T>& sums, const MomentumOptions<real>& options,
                                    const Pair<T, D>& pair, const Point<T>& i, const Point<T>& j) {
        add(sums, options, pair, i, j, options.fixed_limits_dt ? T(0) : max(T(0), j.c - i.c));
    }

    /// `spared`: the part of the signal velocity that does not limit the timestep.
    template <class T>
    DOSEKI_FN static void add(Sums<T>& sums, const MomentumOptions<real>& options,
                              const Pair<T, D>& pair, const Point<T>& i, const Point<T>& j,
                              const T& spared) {
        const T F = gradient_factor<of>(pair.r, i.motion, j.motion);
        const T v_dot_r = dot(i.motion.v - j.motion.v, pair.r_ij);
        const T w_ij = approach_speed(v_dot_r, pair.r);
        const T v_sig = signal_velocity(i.c, j.c, w_ij);
        const T switched = number<T>(0.5) * (i.balsara + j.balsara);
        const T Pi_ij =
            switched * artificial_viscosity(T(options.alpha), v_sig, w_ij, i.rho, j.rho);
        add_acceleration(sums.acceleration, j.motion.mass, i.stress + j.stress, Pi_ij, F,
                         pair.r_ij);
        sums.av_power += (j.motion.mass * F) * (Pi_ij * v_dot_r);
        sums.max_v_sig = max(sums.max_v_sig, select(F < T(0), v_sig - spared, T(0)));
    }

    /// A pair of moving particles is met twice, one with a fixed particle once.
    template <class T>
    DOSEKI_FN static void moving_done(Sums<T>& sums) {
        sums.av_power *= number<T>(0.5);
    }
};

}  // namespace doseki
