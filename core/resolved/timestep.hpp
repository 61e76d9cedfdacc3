#pragma once
#include <algorithm>
#include <cmath>

#include "model/options.hpp"
#include "physics/timestep.hpp"
#include "resolved/records.hpp"

namespace doseki {

/// Eq. (41): dt = min(C_CFL h/(c + |v|), C_f sqrt(h/|a|), h^2/(8 nu)). Corrected gradients do not
/// make the shortest waves faster: B is large where neighbours are missing.
struct FlowTimestep {
    double acoustic, forced, viscous;

    /// Of a fluid particle: speed and size of its acceleration, sound speed c at rest.
    template <int D>
    DOSEKI_DEVICE_FN static FlowTimestep of(const Options<D>& options,
                                            const FluidFields<double, D>& record, double h,
                                            double speed, double acceleration, double c) {
        return {options.cflnumber * h / (c + speed),
                force_timestep(h, acceleration, options.cfl_force),
                0.125 * h * h * record.rho / std::max(record.mu, 1e-300)};
    }
    DOSEKI_DEVICE_FN double smallest() const { return std::min({acoustic, forced, viscous}); }

    /// Whether it may be shorter than `dt`, without roots and divisions: few particles limit the
    /// step. Takes the squares of speed and acceleration.
    template <int D>
    DOSEKI_DEVICE_FN static bool may_be_below(double dt, const Options<D>& options,
                                              const FluidFields<double, D>& record, double h,
                                              double square_of_speed,
                                              double square_of_acceleration, double c) {
        constexpr double rounding = 1e-12;
        dt *= 1.0 + rounding;
        const double left = options.cflnumber * h - c * dt, square = dt * dt,
                     pushed = options.cfl_force * options.cfl_force * h;
        return left < 0.0 || square_of_speed * square > left * left ||
               square_of_acceleration * square * square > pushed * pushed ||
               record.mu * dt > 0.125 * h * h * record.rho;
    }
};

}  // namespace doseki
