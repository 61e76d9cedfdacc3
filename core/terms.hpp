#pragma once
// The two sums of the ueta2022 scheme, as terms of the pair loop: pair_sums.hpp in packs.

#include <span>

#include "pair_loop.hpp"
#include "pair_sums.hpp"

namespace doseki {

template <class real, int D>
MotionPoint<Pack<real>, D> load_motion(std::span<const MotionRecord<real, D>> records,
                                       std::uint32_t first) {
    const auto last = static_cast<std::uint32_t>(records.size() - 1);
    auto lane = [&](auto&& get) {
        return Pack<real>(
            [&](auto l) { return get(records[std::min<std::uint32_t>(first + l, last)]); });
    };
    MotionPoint<Pack<real>, D> point;
    for (int a = 0; a < D; ++a) point.v[a] = lane([a](const auto& record) { return record.v[a]; });
    point.mass = lane([](const auto& record) { return record.mass; });
    point.inverse_support = lane([](const auto& record) { return record.inverse_support; });
    return point;
}

template <class real, int D>
DOSEKI_FN MotionPoint<Pack<real>, D> broadcast_motion(const MotionRecord<real, D>& record) {
    return motion_point<Pack<real>>(record);
}

/// Eq. (9); `finish(p, rho_i L)` is called once for each particle.
template <GradientOf of, class real, int D, class Finish>
struct VelocityGradientTerm {
    template <class T>
    using Point = MotionPoint<T, D>;
    template <class T>
    using Sums = Mat<T, D>;
    using Sum = VelocityGradientSum<of, D>;

    std::span<const MotionRecord<real, D>> motion;
    const Finish& finish_particle;

    auto load(std::uint32_t first) const { return load_motion<real, D>(motion, first); }
    DOSEKI_FN auto load_one(std::uint32_t j) const { return broadcast_motion(motion[j]); }
    DOSEKI_FN auto load_fixed(std::uint32_t j) const { return load_one(j); }

    template <class T>
    DOSEKI_FN void add(Mat<T, D>& gradient, const Pair<T, D>& pair, const Point<T>& i,
                       const Point<T>& j) const {
        Sum::add(gradient, pair, i, j);
    }

    template <class T>
    void moving_done(Mat<T, D>&) const {}

    template <class T>
    DOSEKI_FN void add_fixed(Mat<T, D>& gradient, const Pair<T, D>& pair, const Point<T>& i,
                             const Point<T>& j) const {
        Sum::add(gradient, pair, i, j);
    }

    template <class T>
    void finish(std::uint32_t first, int count, const Mat<T, D>& gradient) const {
        for (int l = 0; l < count; ++l) {
            Mat<double, D> lane;
            for (int k = 0; k < D * D; ++k)
                lane.element[k] = static_cast<double>(gradient.element[k][l]);
            finish_particle(first + l, lane);
        }
    }
};

/// Eqs. (12)-(16) and (18); `finish(p, sums)` is called once for each particle.
template <GradientOf of, class real, int D, class Finish>
struct MomentumTerm {
    template <class T>
    using Point = StressPoint<T, D>;
    template <class T>
    using Sums = MomentumSums<T, D>;
    using Sum = MomentumSum<of, real, D>;

    std::span<const MotionRecord<real, D>> motion;
    std::span<const StressRecord<real, D>> stress;
    MomentumOptions<real> options;
    const Finish& finish_particle;

    auto load(std::uint32_t first) const {
        const auto last = static_cast<std::uint32_t>(stress.size() - 1);
        auto lane = [&](auto&& get) {
            return Pack<real>(
                [&](auto l) { return get(stress[std::min<std::uint32_t>(first + l, last)]); });
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
        return stress_point<Pack<real>>(motion[j], stress[j]);
    }
    DOSEKI_FN auto load_fixed(std::uint32_t j) const { return load_one(j); }

    template <class T>
    DOSEKI_FN void add(Sums<T>& sums, const Pair<T, D>& pair, const Point<T>& i,
                       const Point<T>& j) const {
        Sum::add(sums, options, pair, i, j);
    }

    template <class T>
    DOSEKI_FN void add_fixed(Sums<T>& sums, const Pair<T, D>& pair, const Point<T>& i,
                             const Point<T>& j) const {
        Sum::add_fixed(sums, options, pair, i, j);
    }

    template <class T>
    void moving_done(Sums<T>& sums) const {
        Sum::moving_done(sums);
    }

    template <class T>
    void finish(std::uint32_t first, int count, const Sums<T>& sums) const {
        for (int l = 0; l < count; ++l) {
            Sums<double> lane;
            for (int a = 0; a < D; ++a)
                lane.acceleration[a] = static_cast<double>(sums.acceleration[a][l]);
            lane.av_power = static_cast<double>(sums.av_power[l]);
            lane.max_v_sig = static_cast<double>(sums.max_v_sig[l]);
            finish_particle(first + l, lane);
        }
    }
};

}  // namespace doseki
