#pragma once
#include <span>

#include "pairs/records.hpp"
#include "pairs/rows.hpp"

namespace doseki {

/// What sums need of a point beside its place at rest: of W of them, or of one in memory.
template <class T, int D>
struct ElasticPlace {
    Vec<T, D> x;  // where it is now
    T volume;     // at rest [m^D]

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.x...), f(self.volume...);
    }
};

/// What follows from the places and velocities around a point.
template <class T, int D>
struct ElasticFields {
    T kappa, kappa_rate;  // stiffness [Pa] and damping [Pa s] of the springs
    Mat<T, D> Q;          // see less_springs
    Mat<T, D> Q_damping;  // the share of both dampers in it
    Mat<T, D> F, F_rate;  // deformation gradient, and how fast it changes
    Mat<T, D> spin;       // of the misfits, Eq. (83a), times kappa_rate

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.kappa...), f(self.kappa_rate...), f(self.Q...);
        f(self.Q_damping...);
        f(self.F...), f(self.F_rate...), f(self.spin...);
    }
};

template <int D>
using ElasticPlaceRecord = ElasticPlace<double, D>;
template <int D>
using ElasticRecord = ElasticFields<double, D>;

/// The records of all points. Fields are apart from places, so that a sum over places may set them
/// while other threads still take places.
template <int D>
struct ElasticRecords {
    std::span<const MotionRecord<double, D>> motion;
    std::span<const ElasticPlaceRecord<D>> place;
    std::span<const ElasticRecord<D>> solid;
};

template <class T, int D>
struct PlacedPoint : MotionPoint<T, D>, ElasticPlace<T, D> {
    template <class Rows>
    DOSEKI_FN static PlacedPoint of(const ElasticRecords<D>& records, Rows rows) {
        return {take<MotionPoint<T, D>>(records.motion, rows),
                take<ElasticPlace<T, D>>(records.place, rows)};
    }
};

template <class T, int D>
struct ElasticPoint : MotionPoint<T, D>, ElasticPlace<T, D>, ElasticFields<T, D> {
    template <class Rows>
    DOSEKI_FN static ElasticPoint of(const ElasticRecords<D>& records, Rows rows) {
        return {take<MotionPoint<T, D>>(records.motion, rows),
                take<ElasticPlace<T, D>>(records.place, rows),
                take<ElasticFields<T, D>>(records.solid, rows)};
    }
};

}  // namespace doseki
