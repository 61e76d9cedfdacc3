#pragma once
// What an evaluation learns of the fluid as a whole.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "model/fault.hpp"

namespace doseki {

/// What a cluster adds to the totals of an evaluation, reduced in the order of clusters.
struct FlowSummary {
    double timestep = std::numeric_limits<double>::max();
    double power = 0.0, strain = 0.0;  // dissipated [W]; sum of |L|^2
    Fault fault;
    std::int64_t limiting = -1;
};

/// How lively the fluid as a whole is, from the evaluation before.
struct FlowActivity {
    /// Root mean square of |L| h/c below which a fluid counts as at rest.
    static constexpr double at_rest = 5e-4;

    double strain = 0.0;             // root mean square of |L| [1/s]
    double interior_blending = 0.0;  // 0: at rest, pairs conserve momentum; 1: corrected gradients

    void update(double mean_square_strain, double h, double c) {
        strain = std::sqrt(mean_square_strain);
        interior_blending = std::clamp(h * strain / (at_rest * c) - 1.0, 0.0, 1.0);
    }
};

}  // namespace doseki
