#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "base/pack.hpp"
#include "resolved/model.hpp"
#include "resolved/timestep.hpp"

namespace doseki {

/// A fluid particle, its sums, and what they have seen of it.
template <class Sums, int D>
struct SummedFluid {
    std::size_t p;
    const Sums& sums;
    FluidFields<double, D> fields;
};

/// What is made of the sums of fluid particles.
template <class real, int D, class SumsOf>
class FluidEpilogue {
public:
    using Sums = SumsOf;
    using Summed = SummedFluid<Sums, D>;

    /// `dt`: of the step.
    FluidEpilogue(const ResolvedModel<D>& model, std::span<const FluidRecord<real, D>> records,
                  std::size_t fluid_count, std::span<FlowSummary<D>> summaries,
                  ResolvedState<D>& state, double dt)
        : model_(model),
          records_(records),
          fluid_count_(fluid_count),
          summaries_(summaries),
          state_(state),
          dt_(dt) {}

protected:
    /// False for a wall particle in the last cluster of fluid.
    DOSEKI_DEVICE_FN bool is_fluid(std::size_t p) const { return p < fluid_count_; }
    /// With the density of the state, which has more digits than pairs may see.
    DOSEKI_DEVICE_FN Summed summed(std::size_t p, const Sums& sums) const {
        auto fields = converted<FluidFields<double, D>>(records_[p]);
        fields.rho = state_.density[p];
        return {p, sums, fields};
    }
    DOSEKI_DEVICE_FN double rho0(std::size_t p) const {
        return model_.material(state_.tag[p]).rho0;
    }
    DOSEKI_DEVICE_FN FlowSummary<D>& summary(std::size_t p) const {
        return summary_of<real>(summaries_, p);
    }

    const ResolvedModel<D>& model_;
    std::span<const FluidRecord<real, D>> records_;
    std::size_t fluid_count_;
    std::span<FlowSummary<D>> summaries_;
    ResolvedState<D>& state_;
    double dt_;
};

/// Of those for its forces: acceleration, pressure gradient and timestep.
template <class real, int D>
class ForceEpilogue : public FluidEpilogue<real, D, ForceAccumulators<double, D>> {
    using Base = FluidEpilogue<real, D, ForceAccumulators<double, D>>;
    using Summed = typename Base::Summed;
    using Base::model_, Base::state_, Base::dt_, Base::summary;

public:
    using Sums = typename Base::Sums;
    using Base::Base;

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const Sums& sums) const {
        if (!this->is_fluid(p)) return;
        const Summed at = this->summed(p, sums);
        state_.pressure_gradient[p] =
            company(at) * (state_.inverse_moment[p] * sums.pressure_gradient);
        const Vec<double, D> force = force_of_pairs(at);
        FlowSummary<D>& of_cluster = summary(p);
        of_cluster.power +=
            at.fields.volume * (sums.power - dot(sums.traction, predicted_velocity(p)));
        of_cluster.work.power += at.fields.volume * sums.made_power;
        if (!state_.is_free(p)) {
            state_.acceleration[p] = {};
            push_of_layer(at, at.fields.volume * force);
            return;
        }
        const double attraction = model_.options.attraction;
        state_.acceleration[p] = (1.0 / at.fields.rho) * force + model_.options.gravity -
                                 attraction * attraction * state_.position[p];
        limit_timestep(at);
    }

private:
    /// That the sums have seen; `state_` has the acceleration of the evaluation before.
    DOSEKI_DEVICE_FN Vec<double, D> predicted_velocity(std::size_t p) const {
        return state_.velocity[p] + (0.5 * dt_) * state_.acceleration[p];
    }

    /// Eq. (131), 0 for a particle that sees no other fluid, or one neighbour alone. What walls say
    /// of the pressure along them is what it told them a step before. Alone with a wall it would
    /// keep its gradient for ever, on a ridge add to it; two that lie askew would tell a gradient
    /// that is nothing but their places. Both would be driven along the wall.
    DOSEKI_DEVICE_FN double company(const Summed& at) const {
        constexpr double enough = 0.05;  // of the sum on a lattice; one neighbour adds 0.07 or more
        constexpr double few = 1.2, several = 2.4;
        const double own =
            at.fields.rest_volume / model_.spacing_power[D] * model_.own_concentration;
        const double others = at.sums.concentration - own, squares = at.sums.squares - own * own;
        const double share = others / (enough * model_.lattice_concentration);
        if (!(share > 0.0 && squares > 0.0)) return 0.0;
        const double neighbours = others * others / squares;  // as if all were as near
        return std::min(share, 1.0) * std::clamp((neighbours - few) / (several - few), 0.0, 1.0);
    }

    /// Over the particle's volume.
    DOSEKI_DEVICE_FN Vec<double, D> force_of_pairs(const Summed& at) const {
        return pressure_force(at.sums, at.fields) + 2.0 * at.sums.force + at.sums.traction;
    }

    /// A driven particle hands on the force that it is kept up against.
    DOSEKI_DEVICE_FN void push_of_layer(const Summed& at, const Vec<double, D>& force) const {
        SchemeWork<D>& work = summary(at.p).work;
        work.layer_force = work.layer_force - force;
        work.layer_power -= dot(force, state_.velocity[at.p]);
    }

    DOSEKI_DEVICE_FN void limit_timestep(const Summed& at) const {
        const auto limits = FlowTimestep<D>::of(model_, state_, at.sums, at.fields, at.p);
        FlowSummary<D>& of_cluster = summary(at.p);
        of_cluster.fault.note_right_hand_side(limits.acceleration + state_.density_rate[at.p],
                                              at.p);
        if (limits.may_be_below(of_cluster.timestep))
            of_cluster.limit(limits.smallest(), static_cast<std::int64_t>(at.p));
    }
};

}  // namespace doseki
