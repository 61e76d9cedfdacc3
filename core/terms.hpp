#pragma once
// The two sums of the ueta2022 scheme, as terms of the pair loop.

#include <span>

#include "pair_loop.hpp"
#include "physics/kernel.hpp"
#include "physics/momentum.hpp"
#include "physics/velocity_gradient.hpp"

namespace doseki {

/// Where a kernel gradient is taken: with the h of i alone, as Eq. (9) is printed, or as the mean
/// over h_i and h_j, as Eq. (12) is.
enum class GradientOf { own_h, mean_h };

template <GradientOf of, int D, class T>
DOSEKI_FN T gradient_factor(const T& r, const MotionPoint<T, D>& i, const MotionPoint<T, D>& j) {
    const T own = WendlandC6<D>::gradient_factor(r, i.inverse_support);
    if constexpr (of == GradientOf::own_h) return own;
    return number<T>(0.5) * (own + WendlandC6<D>::gradient_factor(r, j.inverse_support));
}

template <class real, int D>
MotionPoint<Pack<real>, D> load_motion(std::span<const MotionRecord<real, D>> records,
                                       std::uint32_t first) {
    const auto last = static_cast<std::uint32_t>(records.size() - 1);
    auto lane = [&](auto&& get) {
        return Pack<real>([&](auto l) { return get(records[std::min<std::uint32_t>(first + l, last)]); });
    };
    MotionPoint<Pack<real>, D> point;
    for (int a = 0; a < D; ++a) point.v[a] = lane([a](const auto& record) { return record.v[a]; });
    point.mass = lane([](const auto& record) { return record.mass; });
    point.inverse_support = lane([](const auto& record) { return record.inverse_support; });
    return point;
}

template <class real, int D>
DOSEKI_FN MotionPoint<Pack<real>, D> broadcast_motion(const MotionRecord<real, D>& record) {
    MotionPoint<Pack<real>, D> point;
    for (int a = 0; a < D; ++a) point.v[a] = record.v[a];
    point.mass = record.mass;
    point.inverse_support = record.inverse_support;
    return point;
}

/// Eq. (9); `finish(p, rho_i L)` is called once for each particle.
template <GradientOf of, class real, int D, class Finish>
struct VelocityGradientTerm {
    template <class T>
    using Point = MotionPoint<T, D>;
    template <class T>
    using Sums = Mat<T, D>;

    std::span<const MotionRecord<real, D>> motion;
    const Finish& finish_particle;

    auto load(std::uint32_t first) const { return load_motion<real, D>(motion, first); }
    DOSEKI_FN auto load_one(std::uint32_t j) const { return broadcast_motion(motion[j]); }

    template <class T>
    DOSEKI_FN void add(Mat<T, D>& gradient, const Pair<T, D>& pair, const Point<T>& i,
             const Point<T>& j) const {
        add_velocity_gradient(gradient, j.mass, i.v - j.v, gradient_factor<of>(pair.r, i, j), pair.r_ij);
    }

    template <class T>
    void moving_done(Mat<T, D>&) const {}

    template <class T>
    DOSEKI_FN void add_fixed(Mat<T, D>& gradient, const Pair<T, D>& pair, const Point<T>& i, const Point<T>& j) const {
        add(gradient, pair, i, j);
    }

    template <class T>
    void finish(std::uint32_t first, int count, const Mat<T, D>& gradient) const {
        for (int l = 0; l < count; ++l) {
            Mat<double, D> lane;
            for (int k = 0; k < D * D; ++k) lane.element[k] = static_cast<double>(gradient.element[k][l]);
            finish_particle(first + l, lane);
        }
    }
};

template <class real>
struct MomentumOptions {
    real alpha;
    bool fixed_limits_dt;    // false: in Eq. (18) a fixed j has at most the sound speed of i
};

/// Eqs. (12)-(16), with the largest signal velocity for Eq. (18) and the power that the artificial
/// viscosity takes out of the moving particles.
template <GradientOf of, class real, int D, class Finish>
struct MomentumTerm {
    template <class T>
    using Point = StressPoint<T, D>;

    template <class T>
    struct Sums {
        Vec<T, D> acceleration{};
        T av_power{};    // per mass of i
        T max_v_sig{};
    };

    std::span<const MotionRecord<real, D>> motion;
    std::span<const StressRecord<real, D>> stress;
    MomentumOptions<real> options;
    const Finish& finish_particle;

    auto load(std::uint32_t first) const {
        const auto last = static_cast<std::uint32_t>(stress.size() - 1);
        auto lane = [&](auto&& get) {
            return Pack<real>([&](auto l) { return get(stress[std::min<std::uint32_t>(first + l, last)]); });
        };
        Point<Pack<real>> point;
        point.motion = load_motion<real, D>(motion, first);
        for (int k = 0; k < Sym<real, D>::size; ++k)
            point.stress.element[k] = lane([k](const auto& record) { return record.stress[k]; });
        point.rho = lane([](const auto& record) { return record.rho; });
        point.c = lane([](const auto& record) { return record.c; });
        point.balsara = lane([](const auto& record) { return record.balsara; });
        return point;
    }

    DOSEKI_FN auto load_one(std::uint32_t j) const {
        const StressRecord<real, D>& record = stress[j];
        Point<Pack<real>> point;
        point.motion = broadcast_motion(motion[j]);
        for (int k = 0; k < Sym<real, D>::size; ++k) point.stress.element[k] = record.stress[k];
        point.rho = record.rho, point.c = record.c, point.balsara = record.balsara;
        return point;
    }

    template <class T>
    DOSEKI_FN void add(Sums<T>& sums, const Pair<T, D>& pair, const Point<T>& i, const Point<T>& j) const {
        add(sums, pair, i, j, T(0));
    }

    template <class T>
    DOSEKI_FN void add_fixed(Sums<T>& sums, const Pair<T, D>& pair, const Point<T>& i, const Point<T>& j) const {
        add(sums, pair, i, j, options.fixed_limits_dt ? T(0) : max(T(0), j.c - i.c));
    }

    /// `spared`: the part of the signal velocity that does not limit the timestep.
    template <class T>
    DOSEKI_FN void add(Sums<T>& sums, const Pair<T, D>& pair, const Point<T>& i, const Point<T>& j,
                       const T& spared) const {
        const T F = gradient_factor<of>(pair.r, i.motion, j.motion);
        const T v_dot_r = dot(i.motion.v - j.motion.v, pair.r_ij);
        const T w_ij = approach_speed(v_dot_r, pair.r);
        const T v_sig = signal_velocity(i.c, j.c, w_ij);
        const T switched = number<T>(0.5) * (i.balsara + j.balsara);
        const T Pi_ij = switched * artificial_viscosity(T(options.alpha), v_sig, w_ij, i.rho, j.rho);
        add_acceleration(sums.acceleration, j.motion.mass, i.stress + j.stress, Pi_ij, F, pair.r_ij);
        sums.av_power += (j.motion.mass * F) * (Pi_ij * v_dot_r);
        sums.max_v_sig = max(sums.max_v_sig, select(F < T(0), v_sig - spared, T(0)));
    }

    /// A pair of moving particles is met twice, one with a fixed particle once.
    template <class T>
    void moving_done(Sums<T>& sums) const { sums.av_power *= number<T>(0.5); }

    template <class T>
    void finish(std::uint32_t first, int count, const Sums<T>& sums) const {
        for (int l = 0; l < count; ++l) {
            Sums<double> lane;
            for (int a = 0; a < D; ++a) lane.acceleration[a] = static_cast<double>(sums.acceleration[a][l]);
            lane.av_power = static_cast<double>(sums.av_power[l]);
            lane.max_v_sig = static_cast<double>(sums.max_v_sig[l]);
            finish_particle(first + l, lane);
        }
    }
};

}  // namespace doseki
