#pragma once
// The sums of the resolved scheme as terms of the pair loop (pairs/pair_term.hpp).

#include <span>

#include "pairs/rows.hpp"
#include "resolved/accumulators.hpp"

namespace doseki {

/// Where the records of a step lie. Fluid particles come first in storage, wall particles after
/// them, and then ghosts of either kind, whose records have the same places in these arrays:
/// `fluid` has a gap where wall particles are.
template <class real, int D>
struct FlowRecords {
    std::span<const MotionRecord<real, D>> motion;
    std::span<const FluidRecord<real, D>> fluid_fields;
    std::span<const WallRecord<real, D>> wall_fields;
    std::uint32_t fluid_count, count;  // without ghosts
    real inverse_support;

    DOSEKI_DEVICE_FN std::uint32_t first_wall() const { return fluid_count; }
    /// From which distance on kernels are zero, whatever the rounding [m].
    DOSEKI_DEVICE_FN real reach() const {
        constexpr real rounding = std::is_same_v<real, double> ? 1e-12 : 1e-6;
        return (1 + rounding) / inverse_support;
    }

    template <class Rows>
    DOSEKI_FN auto fluid(Rows rows) const {
        using T = typename Rows::Number;
        return FluidPoint<T, D>{take<MotionPoint<T, D>>(motion, rows),
                                take<FluidFields<T, D>>(fluid_fields, rows)};
    }
    template <class Rows>
    DOSEKI_FN auto wall(Rows rows) const {
        using T = typename Rows::Number;
        return WallPoint<T, D>{
            take<MotionPoint<T, D>>(motion, rows),
            take<WallFields<T, D>>(wall_fields, rows.counted_from(first_wall()))};
    }
};

/// What the terms of this file have in common: their records, and how neighbours are read.
template <class real, int D>
struct FlowNeighbours {
    using Real = real;
    static constexpr int dim = D;

    FlowRecords<real, D> records;
    FlowConstants constants;

    DOSEKI_DEVICE_FN real reach() const { return records.reach(); }

    template <class Rows>
    DOSEKI_FN auto load_moving(Rows j) const {
        return records.fluid(j);
    }
    template <class Rows>
    DOSEKI_FN auto load_fixed(Rows j) const {
        return records.wall(j);
    }
};

/// Over the neighbours of fluid particles: what Sums adds up.
template <template <class, int> class Sums, class Kernel, class real, int D>
struct FluidTerm : FlowNeighbours<real, D> {
    using FlowNeighbours<real, D>::records, FlowNeighbours<real, D>::constants;
    template <class T>
    using Accumulators = Sums<T, D>;

    template <class Rows>
    DOSEKI_FN auto load(Rows rows) const {
        return records.fluid(rows.within(0, records.fluid_count - 1));
    }

    template <class T>
    DOSEKI_FN void add(Accumulators<T>& sums, const Pair<T, D>& pair, const FluidPoint<T, D>& i,
                       const FluidPoint<T, D>& j) const {
        add_fluid<Kernel>(sums, constants, T(records.inverse_support), pair, i, j);
    }
    template <class T>
    DOSEKI_FN void add_fixed(Accumulators<T>& sums, const Pair<T, D>& pair,
                             const FluidPoint<T, D>& i, const WallPoint<T, D>& w) const {
        add_wall<Kernel>(sums, constants, T(records.inverse_support), pair, i, w);
    }
};

template <class Kernel, class real, int D>
using ContinuityTerm = FluidTerm<ContinuityAccumulators, Kernel, real, D>;
template <class Kernel, class real, int D>
using ForceTerm = FluidTerm<ForceAccumulators, Kernel, real, D>;

/// What a wall particle sums of the fluid and the other faces around it.
template <class Kernel, class real, int D>
struct WallTerm : FlowNeighbours<real, D> {
    using FlowNeighbours<real, D>::records, FlowNeighbours<real, D>::constants;
    template <class T>
    using Accumulators = WallAccumulators<T, D>;

    Vec<double, D> gravity;

    template <class Rows>
    DOSEKI_FN auto load(Rows rows) const {
        return records.wall(rows.within(records.first_wall(), records.count - 1));
    }

    template <class T>
    DOSEKI_FN void add(Accumulators<T>& sums, const Pair<T, D>& pair, const WallPoint<T, D>& w,
                       const FluidPoint<T, D>& j) const {
        add_fluid_to_wall<Kernel>(sums, constants, T(records.inverse_support), pair, w, j);
    }
    /// Walls act on walls through the film between two faces alone; a cluster that has fluid as
    /// well lists others.
    template <class T>
    DOSEKI_FN void add_fixed(Accumulators<T>& sums, const Pair<T, D>& pair,
                             const WallPoint<T, D>& w, const WallPoint<T, D>& v) const {
        add_face<Kernel>(sums, gravity, T(records.inverse_support), pair, w, v);
    }
};

/// What a wall particle sums of the fluid that pushes on a face of its body, see FacePush.
template <class Kernel, class real, int D>
struct FaceTerm : FlowNeighbours<real, D> {
    using FlowNeighbours<real, D>::records, FlowNeighbours<real, D>::constants;
    template <class T>
    using Accumulators = FaceAccumulators<T, D>;

    Vec<double, D> normal;
    std::span<const FaceDepth<real>> depths;

    template <class Rows>
    DOSEKI_FN auto load(Rows rows) const {
        using T = typename Rows::Number;
        const auto walls = rows.within(records.first_wall(), records.count - 1);
        const auto depth = take<FaceDepth<T>>(depths, walls.counted_from(records.first_wall()));
        return FacedPoint<T, D>{records.wall(walls), depth.below};
    }

    template <class T>
    DOSEKI_FN void add(Accumulators<T>& sums, const Pair<T, D>& pair, const FacedPoint<T, D>& w,
                       const FluidPoint<T, D>& j) const {
        add_fluid_to_face<Kernel>(sums, constants, normal, T(records.inverse_support), pair, w, j);
    }
    template <class T>
    DOSEKI_FN void add_fixed(Accumulators<T>&, const Pair<T, D>&, const FacedPoint<T, D>&,
                             const WallPoint<T, D>&) const {}
};

}  // namespace doseki
