#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "base/pack.hpp"
#include "resolved/flow_summary.hpp"
#include "resolved/model.hpp"
#include "resolved/timestep.hpp"

namespace doseki {

/// What the scheme makes of the sums of a fluid particle: gradients, free-surface indicator,
/// acceleration, rate of density, shifting velocity and timestep.
template <class real, int D>
class FluidEpilogue {
public:
    using Sums = FluidAccumulators<double, D>;

    /// `dt`: since the evaluation before.
    FluidEpilogue(const ResolvedModel<D>& model, std::span<const FluidRecord<real, D>> records,
                  std::size_t fluid_count, std::span<FlowSummary<D>> summaries,
                  ResolvedState<D>& state, double dt)
        : model_(model),
          records_(records),
          fluid_count_(fluid_count),
          summaries_(summaries),
          state_(state),
          dt_(dt) {}

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const Sums& sums) const {
        if (p >= fluid_count_) return;  // a wall particle in the last cluster of fluid
        const Summed at{p, sums, fields(p)};
        const Mat<double, D> B = inverse_moment(sums.moment);
        correct_gradients(at, B);
        const FreeSurfaceIndicator indicator = free_surface(at);
        state_.surface[p] = indicator.x;
        state_.correction_excess[p] = correction_excess(at, B);
        state_.shift[p] = {};
        summary(p).fault.note_density(at.fields.rho, rho0(p), p);
        summary(p).power +=
            at.fields.volume * (sums.power - dot(sums.traction, predicted_velocity(p)) +
                                state_.damping_pressure[p] * sums.density_rate);
        summary(p).work.power += at.fields.volume * sums.made_power;
        if (!state_.is_free(p)) {
            state_.acceleration[p] = {}, state_.density_rate[p] = 0.0;
            push_of_layers(at);
            damp_sound(at);
            return;
        }
        const Mat<double, D>& L = state_.velocity_gradient[p];
        double square = 0.0;
        for (double element : L.element) square += element * element;
        const double strain = std::sqrt(square);

        const Rates of_pairs = momentum_and_continuity(at);
        Rates rates = of_pairs;
        rates.density += at.fields.rho * edge_rate(sums.sliding_rate, sums.sliding_size);
        if (model_.options.flow.shifting && indicator.x < FreeSurfaceIndicator::surface)
            shift(at, strain, rates);
        if (indicator.is_spray()) rates.density = std::min(0.0, rates.density);  // Eq. (147)
        relax_density(at, indicator.normalised_density, strain, rates);
        bound_tension(at, rates);
        summary(p).work.power += part_on_surface(at);
        state_.acceleration[p] = rates.acceleration;
        state_.density_rate[p] = rates.density;
        summary(p).work.power += power_of_corrections(at, rates.density - of_pairs.density);
        limit_timestep(at);
        damp_sound(at);
    }

private:
    /// Time [h/c] in which water that comes to a body under tension gives it up.
    static constexpr double tension_release = 10.0;
    /// Cap on the shifting velocity over the sound speed, half of the fastest flow; it diverges in
    /// a closing gap.
    static constexpr double max_shift = 0.05;

    /// A particle, its sums, and what they have seen of it.
    struct Summed {
        std::size_t p;
        const Sums& sums;
        FluidFields<double, D> fields;
    };
    struct Rates {
        Vec<double, D> acceleration;
        double density;
    };

    /// With the density of the state, which has more digits than pairs may see.
    DOSEKI_DEVICE_FN FluidFields<double, D> fields(std::size_t p) const {
        auto fields = converted<FluidFields<double, D>>(records_[p]);
        fields.rho = state_.density[p] + (0.5 * dt_) * state_.density_rate[p];
        return fields;
    }

    DOSEKI_DEVICE_FN double rho0(std::size_t p) const {
        return model_.material(state_.tag[p]).rho0;
    }
    /// Without what damps sound.
    DOSEKI_DEVICE_FN double pressure(const Summed& at) const {
        return at.fields.p - state_.damping_pressure[at.p];
    }
    /// That the sums have seen; `state_` has the acceleration of the evaluation before.
    DOSEKI_DEVICE_FN Vec<double, D> predicted_velocity(std::size_t p) const {
        return state_.velocity[p] + (0.5 * dt_) * state_.acceleration[p];
    }
    /// As the next evaluation will see it.
    DOSEKI_DEVICE_FN bool on_surface(std::size_t p) const {
        return state_.surface[p] > FreeSurfaceIndicator::surface;
    }
    DOSEKI_DEVICE_FN FlowSummary<D>& summary(std::size_t p) const {
        return summary_of<real>(summaries_, p);
    }

    /// Gradients of first order: those of the kernel times B, the inverse of their moment.
    DOSEKI_DEVICE_FN void correct_gradients(const Summed& at, const Mat<double, D>& B) const {
        auto corrected = [&B](const Vec<double, D>& raw) {
            Vec<double, D> v;
            for (int a = 0; a < D; ++a)
                for (int b = 0; b < D; ++b) v[a] += B(a, b) * raw[b];
            return v;
        };
        state_.pressure_gradient[at.p] = company(at) * corrected(at.sums.pressure_gradient);
        Mat<double, D>& L = state_.velocity_gradient[at.p];
        for (int a = 0; a < D; ++a) {
            Vec<double, D> row;
            for (int b = 0; b < D; ++b) row[b] = at.sums.velocity_gradient(a, b);
            row = corrected(row);
            for (int b = 0; b < D; ++b) L(a, b) = row[b];
        }
    }

    /// Eq. (131), 0 for a particle that sees no other fluid. What walls say of the pressure along
    /// them is what it told them a step before: alone with a wall it would keep its gradient for
    /// ever, on a ridge add to it, and be driven along by it.
    DOSEKI_DEVICE_FN double company(const Summed& at) const {
        constexpr double enough = 0.05;  // of the sum on a lattice; one neighbour adds 0.07 or more
        const double own =
            at.fields.rest_volume / model_.spacing_power[D] * model_.own_concentration;
        return std::clamp((at.sums.concentration - own) / (enough * model_.lattice_concentration),
                          0.0, 1.0);
    }

    /// None near a free surface, where there is little pressure and the inverse is large. Bounded
    /// in a hole.
    DOSEKI_DEVICE_FN Sym<double, D> correction_excess(const Summed& at,
                                                      const Mat<double, D>& B) const {
        constexpr double min_determinant = 0.3;  // of the moment
        constexpr double max_excess = 0.5;
        const bool corrected =
            std::max(at.sums.surface.value, state_.surface[at.p]) < FreeSurfaceIndicator::surface &&
            B(0, 0) > 0.0 && min_determinant * determinant(B) < 1.0;
        if (!corrected) return {};
        Sym<double, D> excess = symmetric_part(B - identity<double, D>());
        const double share = max_excess / std::max(largest_size(excess), max_excess);
        for (double& element : excess.element) element *= share;
        return excess;
    }

    DOSEKI_DEVICE_FN FreeSurfaceIndicator free_surface(const Summed& at) const {
        const Vec<double, D>& gradient = at.sums.concentration_gradient;
        const double slope = std::sqrt(dot(gradient, gradient));
        return FreeSurfaceIndicator::of(
            (at.sums.concentration + at.sums.wall_share) / model_.lattice_concentration,
            model_.kernel_support() * state_.smoothing_length[at.p] * slope,
            model_.options.flow.wide_kernel);
    }

    /// Over the particle's volume.
    DOSEKI_DEVICE_FN Vec<double, D> force_of_pairs(const Summed& at) const {
        return pressure_force(at.sums, at.fields) + 2.0 * at.sums.force + at.sums.traction;
    }

    DOSEKI_DEVICE_FN Rates momentum_and_continuity(const Summed& at) const {
        const double rho = at.fields.rho, B = model_.options.attraction;
        Vec<double, D> a = (1.0 / rho) * force_of_pairs(at) + model_.options.gravity;
        a = a - B * B * state_.position[at.p];
        return {a, rho * at.sums.density_rate};
    }

    /// Whether air comes in under tension: beside a body that moves, and where what has a free
    /// surface slides past an edge of a wall.
    DOSEKI_DEVICE_FN bool is_vented(const Summed& at) const {
        const Sums& sums = at.sums;
        return sums.at_body.value > 0.0 || (sums.surface.value > FreeSurfaceIndicator::surface &&
                                            edge_rate(sums.sliding_rate, sums.sliding_size) != 0.0);
    }

    /// What shifting and the relaxation of density give to energies of compression and height [W].
    DOSEKI_DEVICE_FN double power_of_corrections(const Summed& at, double density_rate) const {
        return at.fields.volume * pressure(at) / at.fields.rho * density_rate -
               state_.mass[at.p] * dot(model_.options.gravity, state_.shift[at.p]);
    }

    /// A driven particle hands on the force and the rate of density that it is kept up against.
    DOSEKI_DEVICE_FN void push_of_layers(const Summed& at) const {
        const Vec<double, D> force = at.fields.volume * force_of_pairs(at);
        SchemeWork<D>& work = summary(at.p).work;
        work.layer_force = work.layer_force - force;
        work.layer_power -= dot(force, state_.velocity[at.p]) +
                            at.fields.volume * pressure(at) * at.sums.density_rate;
    }

    /// Moves the particle relative to the fluid, and its density with it. Pairs see to its
    /// velocity.
    DOSEKI_DEVICE_FN void shift(const Summed& at, double strain, Rates& rates) const {
        const Sums& sums = at.sums;
        const double c = model_.constants.c;
        Vec<double, D> velocity =
            shifting_velocity(sums.concentration_gradient, strain, state_.smoothing_length[at.p]);
        if (sums.surface.value > FreeSurfaceIndicator::surface)
            velocity = tangential(velocity, sums.surface_gradient);
        const double fastest = max_shift * c, square = dot(velocity, velocity);
        if (square > fastest * fastest) velocity = (fastest / std::sqrt(square)) * velocity;
        state_.shift[at.p] = velocity;
        rates.density += dot(state_.pressure_gradient[at.p], velocity) / (c * c);
    }

    /// What continuity sums up over many steps forgets how far apart particles are: the density
    /// goes towards the one that their arrangement says, and the faster the more the flow disturbs
    /// it.
    DOSEKI_DEVICE_FN void relax_density(const Summed& at, double normalised_density, double strain,
                                        Rates& rates) const {
        constexpr double per_strain = 10.0;
        const double rho = at.fields.rho,
                     sound = model_.constants.c / state_.smoothing_length[at.p];
        const double rate = std::clamp(per_strain * strain, sound / density_relaxation_at_rest,
                                       sound / density_relaxation);
        rates.density += rate * (normalised_density * rho0(at.p) - rho);
    }

    /// Below its least density a fluid does not expand any further.
    DOSEKI_DEVICE_FN void bound_tension(const Summed& at, Rates& rates) const {
        const bool vented = is_vented(at);
        const double least = model_.min_density[state_.tag[at.p].material].at(vented);
        const double missing = least - at.fields.rho;
        if (missing <= 0.0) return;
        const double time = tension_release * state_.smoothing_length[at.p] / model_.constants.c;
        rates.density = std::max(vented ? missing / time : 0.0, rates.density);
    }

    /// Eq. (144): what is stretched on the surface is a void and has no tension, also where it
    /// meets again, until it has closed. Returns the power of the tension that is lost [W].
    DOSEKI_DEVICE_FN double part_on_surface(const Summed& at) const {
        const std::size_t p = at.p;
        const double rho = at.fields.rho;
        const bool had_tension = pressure(at) < 0.0;
        if (rho >= rho0(p)) state_.parted[p] = 0.0;
        if (rho >= rho0(p) || !on_surface(p)) return 0.0;
        state_.parted[p] = 1.0;
        if (!had_tension || dt_ <= 0.0) return 0.0;
        const Material& material = model_.material(state_.tag[p]);
        return -state_.mass[p] * thermodynamic_state(*material.laws, rho).bulk_energy / dt_;
    }

    /// For the next evaluation. It brings no tension that the liquid does not bear, none on a free
    /// surface.
    DOSEKI_DEVICE_FN void damp_sound(const Summed& at) const {
        const std::size_t p = at.p;
        const Material& material = model_.material(state_.tag[p]);
        const double rho = at.fields.rho, h = state_.smoothing_length[p],
                     divergence = trace(state_.velocity_gradient[p]);
        double added = damping_pressure(model_.options.flow.acoustic_damping, rho,
                                        model_.constants.c, h, divergence);
        if (added < 0.0) {
            const double least = model_.min_density[state_.tag[p].material].at(is_vented(at));
            const double bound = pressure_at(*material.laws, least);
            added = std::max(added, std::min(0.0, bound - pressure(at)));
        }
        state_.damping_pressure[p] = on_surface(p) ? 0.0 : added;
    }

    DOSEKI_DEVICE_FN void limit_timestep(const Summed& at) const {
        const auto limits = FlowTimestep<D>::of(model_, state_, at.fields, at.p);
        FlowSummary<D>& of_cluster = summary(at.p);
        of_cluster.fault.note_right_hand_side(limits.acceleration + state_.density_rate[at.p],
                                              at.p);
        if (limits.may_be_below(of_cluster.timestep))
            of_cluster.limit(limits.smallest(), static_cast<std::int64_t>(at.p));
    }

    const ResolvedModel<D>& model_;
    std::span<const FluidRecord<real, D>> records_;
    std::size_t fluid_count_;
    std::span<FlowSummary<D>> summaries_;
    ResolvedState<D>& state_;
    double dt_;
};

}  // namespace doseki
