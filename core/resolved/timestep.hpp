#pragma once
#include <algorithm>

#include "model/options.hpp"
#include "physics/timestep.hpp"
#include "resolved/records.hpp"

namespace doseki {

/// Eq. (41): dt = min(C_CFL h/(c + |v|), C_f sqrt(h/|a|), h^2/(8 nu)).
struct FlowTimestep {
    double acoustic, forced, viscous;

    /// Of a fluid particle: speed and size of its acceleration, sound speed c at rest.
    template <int D>
    static FlowTimestep of(const Options<D>& options, const FluidRecord<D>& record, double h,
                           double speed, double acceleration, double c) {
        return {options.cflnumber * h / (c + speed),
                force_timestep(h, acceleration, options.cfl_force),
                0.125 * h * h * record.rho / std::max(record.mu, 1e-300)};
    }
    double smallest() const { return std::min({acoustic, forced, viscous}); }
};

}  // namespace doseki
