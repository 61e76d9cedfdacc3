#pragma once
#include <algorithm>
#include <cmath>

#include "model/options.hpp"
#include "physics/timestep.hpp"
#include "resolved/records.hpp"

namespace doseki {

/// Bound on what a matrix makes of the length of a vector: its largest sum of sizes along a row.
template <int D>
DOSEKI_DEVICE_FN double row_norm(const Sym<double, D>& matrix) {
    double largest = 0.0;
    for (int a = 0; a < D; ++a) {
        double sum = 0.0;
        for (int b = 0; b < D; ++b) sum += std::abs(matrix(a, b));
        largest = std::max(largest, sum);
    }
    return largest;
}

/// Eq. (41): dt = min(C_CFL h/(c |B| + |v|), C_f sqrt(h/|a|), h^2/(8 nu)). Corrected gradients make
/// sound of the shortest waves faster by |B|.
struct FlowTimestep {
    double acoustic, forced, viscous;

    /// Of a fluid particle: speed and size of its acceleration, sound speed c at rest.
    template <int D>
    DOSEKI_DEVICE_FN static FlowTimestep of(const Options<D>& options,
                                            const FluidFields<double, D>& record, double h,
                                            double speed, double acceleration, double c) {
        return {options.cflnumber * h / (c * row_norm(record.correction) + speed),
                force_timestep(h, acceleration, options.cfl_force),
                0.125 * h * h * record.rho / std::max(record.mu, 1e-300)};
    }
    DOSEKI_DEVICE_FN double smallest() const { return std::min({acoustic, forced, viscous}); }
};

}  // namespace doseki
