#pragma once
// What an evaluation learns of the fluid as a whole.

#include <cstdint>
#include <limits>

#include "model/fault.hpp"
#include "model/scheme_work.hpp"

namespace doseki {

/// What a cluster adds to the totals of an evaluation.
template <int D>
struct FlowSummary {
    double timestep = std::numeric_limits<double>::max();
    double power = 0.0;  // dissipated [W]
    SchemeWork<D> work;
    Fault fault;
    std::int64_t limiting = -1;

    DOSEKI_DEVICE_FN void limit(double dt, std::int64_t particle) {
        if (dt < timestep || (dt == timestep && particle < limiting))
            timestep = dt, limiting = particle;
    }
    DOSEKI_DEVICE_FN void add(const FlowSummary& other) {
        limit(other.timestep, other.limiting);
        power += other.power, work.add(other.work);
        fault.merge(other.fault);
    }
};

}  // namespace doseki
