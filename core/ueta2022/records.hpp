#pragma once
#include "pairs/records.hpp"

namespace doseki {

/// What the momentum sum needs of a particle beside its motion: W of them, or one in memory.
template <class T, int D>
struct StressPoint {
    Sym<T, D> stress;  // sigma / rho^2
    T rho, c, balsara;

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.stress...), f(self.rho...), f(self.c...), f(self.balsara...);
    }
};

template <class real, int D>
using StressRecord = StressPoint<real, D>;

/// Particle i or j of the momentum sum.
template <class T, int D>
struct MomentumPoint : MotionPoint<T, D>, StressPoint<T, D> {};

}  // namespace doseki
