#pragma once
#include <algorithm>
#include <cmath>

#include "physics/timestep.hpp"
#include "resolved/accumulators.hpp"
#include "resolved/model.hpp"

namespace doseki {

/// Eq. (41) of a fluid particle: dt = min(C_CFL h/(c + u), C_f sqrt(h/|a|), 0.9/lambda), u being
/// the speed at which neighbours may come nearer, lambda the greatest rate at which viscosity
/// damps: what is predicted with the acceleration of the step before is damped up to lambda dt = 1.
template <int D>
struct FlowTimestep {
    static constexpr double stable = 0.9;  // rate of viscosity over 1/dt

    const Options<D>& options;
    double c, h;  // c at rest
    double viscous_rate;
    double approach, acceleration;  // squares of u and of |a|

    /// Neighbours come nearer by what the velocity gradient makes of the reach of the kernel,
    /// however fast all move; and by the particle's own speed, where few neighbours make a large
    /// gradient.
    DOSEKI_DEVICE_FN static FlowTimestep of(const ResolvedModel<D>& model,
                                            const ResolvedState<D>& state,
                                            const ForceAccumulators<double, D>& sums,
                                            const FluidFields<double, D>& fields, std::size_t p) {
        const Vec<double, D>&v = state.velocity[p], &a = state.acceleration[p];
        const double h = state.smoothing_length[p], reach = model.kernel_support() * h;
        const double gradient = sum_of_squares(state.velocity_gradient[p]);
        // The sums count the particle itself among its neighbours.
        const double own =
            -model.constants.roughest * fields.volume * model.own_gradient_factor * fields.mu;
        return {model.options,
                model.constants.c,
                h,
                (sums.viscous_rate - own + model.constants.nearest * sums.viscous_pair.value) /
                    fields.rho,
                std::min(dot(v, v), reach * reach * gradient),
                dot(a, a)};
    }

    DOSEKI_DEVICE_FN double acoustic() const {
        return options.cflnumber * h / (c + std::sqrt(approach));
    }
    DOSEKI_DEVICE_FN double forced() const {
        return force_timestep(h, std::sqrt(acceleration), options.cfl_force);
    }
    DOSEKI_DEVICE_FN double viscous() const { return stable / std::max(viscous_rate, 1e-300); }
    DOSEKI_DEVICE_FN double smallest() const { return std::min({acoustic(), forced(), viscous()}); }

    /// Whether it may be shorter than `dt`, without roots and divisions: few particles limit the
    /// step.
    DOSEKI_DEVICE_FN bool may_be_below(double dt) const {
        constexpr double rounding = 1e-12;
        dt *= 1.0 + rounding;
        const double left = options.cflnumber * h - c * dt, square = dt * dt,
                     pushed = options.cfl_force * options.cfl_force * h;
        return left < 0.0 || approach * square > left * left ||
               acceleration * square * square > pushed * pushed || viscous_rate * dt > stable;
    }
};

}  // namespace doseki
