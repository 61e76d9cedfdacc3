#pragma once
#include <algorithm>
#include <cmath>

#include "physics/timestep.hpp"
#include "resolved/model.hpp"
#include "resolved/records.hpp"

namespace doseki {

/// Eq. (41) of a fluid particle: dt = min(C_CFL h/(c + u), C_f sqrt(h/|a|), h^2/(8 nu)), u being
/// the speed at which neighbours may come nearer.
template <int D>
struct FlowTimestep {
    const Options<D>& options;
    double c, h, mu, rho;           // c at rest
    double approach, acceleration;  // squares of u and of |a|

    /// Neighbours come nearer by what the velocity gradient makes of the reach of the kernel,
    /// however fast all move; and by the particle's own speed, where few neighbours make a large
    /// gradient.
    DOSEKI_DEVICE_FN static FlowTimestep of(const ResolvedModel<D>& model,
                                            const ResolvedState<D>& state,
                                            const FluidFields<double, D>& record, std::size_t p) {
        const Vec<double, D>&v = state.velocity[p], &a = state.acceleration[p];
        const double h = state.smoothing_length[p], reach = model.kernel_support() * h;
        double gradient = 0.0;
        const Mat<double, D> L = state.velocity_gradient[p];
        for (double element : L.element) gradient += element * element;
        return {model.options, model.constants.c, h,
                record.mu,     record.rho,        std::min(dot(v, v), reach * reach * gradient),
                dot(a, a)};
    }

    DOSEKI_DEVICE_FN double acoustic() const {
        return options.cflnumber * h / (c + std::sqrt(approach));
    }
    DOSEKI_DEVICE_FN double forced() const {
        return force_timestep(h, std::sqrt(acceleration), options.cfl_force);
    }
    DOSEKI_DEVICE_FN double viscous() const { return 0.125 * h * h * rho / std::max(mu, 1e-300); }
    DOSEKI_DEVICE_FN double smallest() const { return std::min({acoustic(), forced(), viscous()}); }

    /// Whether it may be shorter than `dt`, without roots and divisions: few particles limit the
    /// step.
    DOSEKI_DEVICE_FN bool may_be_below(double dt) const {
        constexpr double rounding = 1e-12;
        dt *= 1.0 + rounding;
        const double left = options.cflnumber * h - c * dt, square = dt * dt,
                     pushed = options.cfl_force * options.cfl_force * h;
        return left < 0.0 || approach * square > left * left ||
               acceleration * square * square > pushed * pushed || mu * dt > 0.125 * h * h * rho;
    }
};

}  // namespace doseki
