#pragma once
#include <cstdint>
#include <limits>

#include "model/fault.hpp"

namespace doseki {

/// What an evaluation learns of a cluster, and of all of them once they are added up.
struct StepSummary {
    double timestep = std::numeric_limits<double>::max();
    double power = 0.0;  // dissipated [W]
    Fault fault;
    std::int64_t limiting = -1;

    DOSEKI_DEVICE_FN void limit(double dt, std::int64_t particle) {
        if (dt < timestep || (dt == timestep && particle < limiting))
            timestep = dt, limiting = particle;
    }
    DOSEKI_DEVICE_FN void add(const StepSummary& other) {
        limit(other.timestep, other.limiting);
        power += other.power;
        fault.merge(other.fault);
    }
};

}  // namespace doseki
