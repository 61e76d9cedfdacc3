#pragma once
// The sums of the resolved scheme as terms of the pair loop: flow_sums.hpp in packs.

#include <span>

#include "pair_loop.hpp"
#include "resolved/flow_sums.hpp"

namespace doseki {

/// Where the records of a step lie. Fluid particles come first in storage, wall particles after
/// them, and then ghosts of either kind, whose records have the same places in these arrays:
/// `fluid` has a gap where wall particles are.
template <int D>
struct FlowRecords {
    std::span<const MotionRecord<double, D>> motion;
    std::span<const FluidRecord<D>> fluid;
    std::span<const WallRecord<D>> wall;
    std::uint32_t fluid_count, count;  // without ghosts
    double inverse_support;

    std::uint32_t first_wall() const { return fluid_count; }

    DOSEKI_FN FluidPoint<Pack<double>, D> fluid_at(std::uint32_t j) const {
        return fluid_point<Pack<double>>(motion.data(), fluid.data(),
                                         [j](auto member) { return Pack<double>(member(j)); });
    }
    DOSEKI_FN WallPoint<Pack<double>, D> wall_at(std::uint32_t j) const {
        return wall_point<Pack<double>>(motion.data(), wall.data(), first_wall(),
                                        [j](auto member) { return Pack<double>(member(j)); });
    }
    /// W in a row; lanes beyond the last fluid particle repeat it.
    FluidPoint<Pack<double>, D> fluid_lanes(std::uint32_t first) const {
        const std::uint32_t last = fluid_count - 1;
        return fluid_point<Pack<double>>(motion.data(), fluid.data(), [=](auto member) {
            return Pack<double>(
                [&](auto l) { return member(std::min<std::uint32_t>(first + l, last)); });
        });
    }
    /// W in a row; lanes before the first wall particle, or beyond the last, repeat it.
    WallPoint<Pack<double>, D> wall_lanes(std::uint32_t first) const {
        const std::uint32_t least = first_wall(), last = count - 1;
        return wall_point<Pack<double>>(motion.data(), wall.data(), least, [=](auto member) {
            return Pack<double>(
                [&](auto l) { return member(std::clamp<std::uint32_t>(first + l, least, last)); });
        });
    }
};

/// Lane `l` of sums over packs.
template <int D>
FluidSums<double, D> lane_of(const FluidSums<Pack<double>, D>& sums, int l) {
    FluidSums<double, D> lane;
    for (int a = 0; a < D; ++a) {
        lane.force[a] = sums.force[a][l], lane.traction[a] = sums.traction[a][l];
        lane.pressure_gradient[a] = sums.pressure_gradient[a][l];
        lane.concentration_gradient[a] = sums.concentration_gradient[a][l];
        lane.surface_gradient[a] = sums.surface_gradient[a][l];
    }
    for (int k = 0; k < D * D; ++k)
        lane.velocity_gradient.element[k] = sums.velocity_gradient.element[k][l];
    for (int k = 0; k < Sym<double, D>::size; ++k)
        lane.moment.element[k] = sums.moment.element[k][l];
    lane.density_rate = sums.density_rate[l], lane.power = sums.power[l];
    lane.concentration = sums.concentration[l], lane.wall_share = sums.wall_share[l];
    lane.largest_surface = sums.largest_surface[l];
    return lane;
}

template <int D>
WallSums<double, D> lane_of(const WallSums<Pack<double>, D>& sums, int l) {
    WallSums<double, D> lane;
    for (int a = 0; a < D; ++a)
        lane.force[a] = sums.force[a][l], lane.velocity[a] = sums.velocity[a][l];
    lane.weight = sums.weight[l], lane.height = sums.height[l], lane.pressure = sums.pressure[l];
    lane.density = sums.density[l];
    return lane;
}

/// Everything a fluid particle sums, in one pass; `finish(p, sums)` is called once for each of
/// them.
template <class Kernel, int D, class Finish>
struct FluidTerm {
    template <class T>
    using Point = FluidPoint<T, D>;
    template <class T>
    using Sums = FluidSums<T, D>;
    using Sum = FluidSum<Kernel, D>;
    using Lanes = Pack<double>;

    FlowRecords<D> records;
    FlowConstants constants;
    const Finish& finish_particle;

    auto load(std::uint32_t first) const { return records.fluid_lanes(first); }
    DOSEKI_FN auto load_one(std::uint32_t j) const { return records.fluid_at(j); }
    DOSEKI_FN auto load_fixed(std::uint32_t j) const { return records.wall_at(j); }

    DOSEKI_FN void add(Sums<Lanes>& sums, const Pair<Lanes, D>& pair, const FluidPoint<Lanes, D>& i,
                       const FluidPoint<Lanes, D>& j) const {
        Sum::add(sums, constants, Lanes(records.inverse_support), pair, i, j);
    }
    DOSEKI_FN void add_fixed(Sums<Lanes>& sums, const Pair<Lanes, D>& pair,
                             const FluidPoint<Lanes, D>& i, const WallPoint<Lanes, D>& w) const {
        Sum::add_wall(sums, constants, Lanes(records.inverse_support), pair, i, w);
    }
    void moving_done(Sums<Lanes>&) const {}

    void finish(std::uint32_t first, int count, const Sums<Lanes>& sums) const {
        for (int l = 0; l < count; ++l)
            if (first + l < records.first_wall()) finish_particle(first + l, lane_of(sums, l));
    }
};

/// What a wall particle sums of the fluid around it.
template <class Kernel, int D, class Finish>
struct WallTerm {
    template <class T>
    using Point = WallPoint<T, D>;
    template <class T>
    using Sums = WallSums<T, D>;
    using Sum = WallSum<Kernel, D>;
    using Lanes = Pack<double>;

    FlowRecords<D> records;
    FlowConstants constants;
    const Finish& finish_particle;

    auto load(std::uint32_t first) const { return records.wall_lanes(first); }
    DOSEKI_FN auto load_one(std::uint32_t j) const { return records.fluid_at(j); }
    DOSEKI_FN auto load_fixed(std::uint32_t j) const { return records.wall_at(j); }

    DOSEKI_FN void add(Sums<Lanes>& sums, const Pair<Lanes, D>& pair, const WallPoint<Lanes, D>& w,
                       const FluidPoint<Lanes, D>& j) const {
        Sum::add(sums, constants, Lanes(records.inverse_support), pair, w, j);
    }
    /// Walls do not act on walls; a cluster that has fluid as well lists some.
    DOSEKI_FN void add_fixed(Sums<Lanes>&, const Pair<Lanes, D>&, const WallPoint<Lanes, D>&,
                             const WallPoint<Lanes, D>&) const {}
    void moving_done(Sums<Lanes>&) const {}

    void finish(std::uint32_t first, int count, const Sums<Lanes>& sums) const {
        for (int l = 0; l < count; ++l)
            if (first + l >= records.first_wall()) finish_particle(first + l, lane_of(sums, l));
    }
};

}  // namespace doseki
