#pragma once
#include "model/scheme_work.hpp"
#include "model/step_summary.hpp"

namespace doseki {

/// What an evaluation learns of the fluid.
template <int D>
struct FlowSummary : StepSummary {
    SchemeWork<D> work;

    DOSEKI_DEVICE_FN void add(const FlowSummary& other) {
        StepSummary::add(other);
        work.add(other.work);
    }
};

}  // namespace doseki
