#pragma once
// What an evaluation learns of the fluid as a whole.

#include <cstdint>
#include <limits>

#include "model/fault.hpp"
#include "model/scheme_work.hpp"

namespace doseki {

/// What a cluster adds to the totals of an evaluation, reduced in the order of clusters.
template <int D>
struct FlowSummary {
    double timestep = std::numeric_limits<double>::max();
    double power = 0.0;  // dissipated [W]
    SchemeWork<D> work;
    Fault fault;
    std::int64_t limiting = -1;
};

}  // namespace doseki
