#pragma once
#include "pairs/records.hpp"

namespace doseki {

/// What the sums need of a point beside its place at rest: W of them, or one in memory.
template <class T, int D>
struct ElasticFields {
    Vec<T, D> x;          // where it is now
    T volume;             // at rest [m^D]
    T kappa, kappa_rate;  // stiffness [Pa] and damping [Pa s] of the springs
    Mat<T, D> Q;          // see less_springs
    Mat<T, D> Q_damping;  // the share of both dampers in it
    Mat<T, D> F, F_rate;  // deformation gradient, and how fast it changes
    Mat<T, D> spin;       // of the misfits, Eq. (83a), times kappa_rate

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.x...), f(self.volume...), f(self.kappa...), f(self.kappa_rate...), f(self.Q...);
        f(self.Q_damping...);
        f(self.F...), f(self.F_rate...), f(self.spin...);
    }
};

template <int D>
using ElasticRecord = ElasticFields<double, D>;

template <class T, int D>
struct ElasticPoint : MotionPoint<T, D>, ElasticFields<T, D> {};

}  // namespace doseki
