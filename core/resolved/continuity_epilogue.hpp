#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "base/pack.hpp"
#include "resolved/fluid_epilogue.hpp"

namespace doseki {

/// Of those for its density: velocity gradient, free-surface indicator, the density at the end of
/// the step, and the shifting velocity.
template <class real, int D>
class ContinuityEpilogue : public FluidEpilogue<real, D, ContinuityAccumulators<double, D>> {
    using Base = FluidEpilogue<real, D, ContinuityAccumulators<double, D>>;
    using Summed = typename Base::Summed;
    using Base::model_, Base::state_, Base::dt_, Base::summary, Base::rho0;

public:
    using Sums = typename Base::Sums;
    using Base::Base;

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const Sums& sums) const {
        if (!this->is_fluid(p)) return;
        const Summed at = this->summed(p, sums);
        const Mat<double, D> B = inverse_moment(sums.moment);
        state_.inverse_moment[p] = symmetric_part(B);
        state_.velocity_gradient[p] = sums.velocity_gradient * transposed(B);
        const FreeSurfaceIndicator indicator = free_surface(at);
        state_.surface[p] = indicator.x;
        state_.surface_around[p] = sums.surface.value;
        state_.least_pressure[p] = least_pressure(at);
        summary(p).fault.note_density(at.fields.rho, rho0(p), p);
        if (state_.is_free(p)) {
            const double strain = std::sqrt(sum_of_squares(state_.velocity_gradient[p]));
            set_density(at, indicator, strain);
            shift(at, strain);
        } else {
            state_.shift[p] = {};
            take_pressure(at), push_of_layer(at);
        }
        damp_sound(at);
        summary(p).power +=
            at.fields.volume * (sums.power + state_.damping_pressure[p] * sums.density_rate);
    }

private:
    /// Time [h/c] in which water that comes to a body under tension gives it up.
    static constexpr double tension_release = 10.0;
    /// Cap on the shifting velocity over the sound speed, half of the fastest flow; it diverges in
    /// a closing gap.
    static constexpr double max_shift = 0.05;

    /// Without what damps sound.
    DOSEKI_DEVICE_FN double pressure(const Summed& at) const {
        return at.fields.p - state_.damping_pressure[at.p];
    }
    /// As the next evaluation will see it.
    DOSEKI_DEVICE_FN bool on_surface(std::size_t p) const {
        return state_.surface[p] > FreeSurfaceIndicator::surface;
    }

    /// Eq. (163): of a particle along the free surface, where the pressure falls inwards. Zero at
    /// corners and of spray, which have no inside.
    DOSEKI_DEVICE_FN double least_pressure(const Summed& at) const {
        constexpr double depth = 1.5;  // dp; the row lies at a half
        const double indicator = state_.surface[at.p];
        if (!on_surface(at.p) || indicator >= FreeSurfaceIndicator::edge) return 0.0;
        const Vec<double, D>& inwards = at.sums.concentration_gradient;
        const double slope =
            dot(state_.pressure_gradient[at.p], inwards) / std::sqrt(dot(inwards, inwards));
        return std::min(0.0, depth * model_.spacing_power[1] * slope);
    }

    DOSEKI_DEVICE_FN FreeSurfaceIndicator free_surface(const Summed& at) const {
        const Vec<double, D>& gradient = at.sums.concentration_gradient;
        const double slope = std::sqrt(dot(gradient, gradient));
        return FreeSurfaceIndicator::of(
            (at.sums.concentration + at.sums.wall_share) / model_.lattice_concentration,
            model_.kernel_support() * state_.smoothing_length[at.p] * slope,
            model_.options.flow.wide_kernel);
    }

    /// Over the step. The particle has gone with the shifting velocity of the step before.
    DOSEKI_DEVICE_FN void set_density(const Summed& at, const FreeSurfaceIndicator& indicator,
                                      double strain) const {
        const std::size_t p = at.p;
        const double rho = at.fields.rho, c = model_.material(state_.tag[p]).c0;
        const double of_pairs = rho * at.sums.density_rate;
        double rate = of_pairs + rho * edge_rate(at.sums.sliding_rate, at.sums.sliding_size) +
                      dot(state_.pressure_gradient[p], state_.shift[p]) / (c * c);
        if (indicator.is_spray()) rate = std::min(0.0, rate);  // Eq. (147)
        const double relaxed = relaxation(at, indicator.normalised_density, strain);
        rate += relaxed;
        const double in_film = state_.in_film[p] = share_in_film(at);
        if (in_film > 0.0) rate += in_film * (rate_towards_film(at) - rate);
        rate = with_least_density(at, rate);
        SchemeWork<D>& work = summary(p).work;
        work.power -= state_.mass[p] * dot(model_.options.gravity, state_.shift[p]);
        work.relaxation += dt_ * power_of_corrections(at, relaxed);
        work.energy += part_on_surface(at) + dt_ * power_of_corrections(at, rate - of_pairs);
        state_.density_rate[p] = rate;
        state_.density[p] = rho + dt_ * rate;
    }

    /// Eq. (156): of water between faces that leave no room for it.
    DOSEKI_DEVICE_FN double share_in_film(const Summed& at) const {
        const Sums& sums = at.sums;
        if (!(sums.film_share > 0.0)) return 0.0;
        const Vec<double, D>& gradient = sums.wall_gradient;
        return std::min(1.0, 2.0 * sums.film_share / sums.wall_share) *
               model_.narrow_gap.share(sums.wall_share, std::sqrt(dot(gradient, gradient)));
    }

    /// With which the density goes to that of the film around, in h/c or a step.
    DOSEKI_DEVICE_FN double rate_towards_film(const Summed& at) const {
        const double c = model_.constants.c, h = state_.smoothing_length[at.p],
                     film = at.sums.film_pressure / at.sums.film_share;
        return (film - pressure(at)) / (c * std::max(h, c * dt_));
    }

    /// Whether air comes in under tension: beside a body that moves, and where what has a free
    /// surface slides past an edge of a wall.
    DOSEKI_DEVICE_FN bool is_vented(const Summed& at) const {
        const Sums& sums = at.sums;
        return sums.at_body.value > 0.0 || (sums.surface.value > FreeSurfaceIndicator::surface &&
                                            edge_rate(sums.sliding_rate, sums.sliding_size) != 0.0);
    }

    /// What a rate of density that is not that of the pairs gives to the energy of compression [W].
    DOSEKI_DEVICE_FN double power_of_corrections(const Summed& at, double density_rate) const {
        return at.fields.volume * pressure(at) / at.fields.rho * density_rate;
    }

    /// A driven particle has the pressure of the flow in front of it, by continuity alone: the
    /// arrangement of its layers is given and says nothing. Layers do not pull.
    DOSEKI_DEVICE_FN void take_pressure(const Summed& at) const {
        const std::size_t p = at.p;
        const double least = rho0(p), rate = at.fields.rho * at.sums.density_rate,
                     rho = at.fields.rho + dt_ * rate;
        state_.density_rate[p] = rho < least ? 0.0 : rate;
        state_.density[p] = std::max(least, rho);
    }

    /// A driven particle hands on the rate of density that it is kept up against.
    DOSEKI_DEVICE_FN void push_of_layer(const Summed& at) const {
        summary(at.p).work.layer_power -= at.fields.volume * pressure(at) * at.sums.density_rate;
    }

    /// How the particle moves next relative to the fluid. Pairs see to its velocity. Disorder is
    /// undone in no less than a few steps, or a step would go past the goal: Eq. (153).
    DOSEKI_DEVICE_FN void shift(const Summed& at, double strain) const {
        const Sums& sums = at.sums;
        Vec<double, D>& velocity = state_.shift[at.p];
        velocity = {};
        if (!model_.options.flow.shifting || on_surface(at.p)) return;
        const double c = model_.constants.c, h = state_.smoothing_length[at.p];
        const double rate =
            std::min(strain, max_shifting_rate * c / (model_.options.cflnumber * h));
        velocity = shifting_velocity(sums.concentration_gradient, rate, h);
        if (sums.surface.value > FreeSurfaceIndicator::surface)
            velocity = tangential(velocity, sums.surface_gradient);
        const double fastest = max_shift * c, square = dot(velocity, velocity);
        if (square > fastest * fastest) velocity = (fastest / std::sqrt(square)) * velocity;
    }

    /// What continuity sums up over many steps forgets how far apart particles are: the density
    /// goes towards the one that their arrangement says, and the faster the more the flow disturbs
    /// it.
    DOSEKI_DEVICE_FN double relaxation(const Summed& at, double normalised_density,
                                       double strain) const {
        constexpr double per_strain = 10.0;
        const double sound = model_.constants.c / state_.smoothing_length[at.p];
        const double rate = std::clamp(per_strain * strain, sound / density_relaxation_at_rest,
                                       sound / density_relaxation);
        return rate * (normalised_density * rho0(at.p) - at.fields.rho);
    }

    /// Below its least density a fluid does not expand any further, and no step goes past it.
    DOSEKI_DEVICE_FN double with_least_density(const Summed& at, double rate) const {
        const bool vented = is_vented(at);
        const double least = model_.min_density[state_.tag[at.p].material].at(vented);
        const double missing = least - at.fields.rho;
        if (missing <= 0.0) return dt_ > 0.0 ? std::max(missing / dt_, rate) : rate;
        const double time = tension_release * state_.smoothing_length[at.p] / model_.constants.c;
        return std::max(vented ? missing / time : 0.0, rate);
    }

    /// Eq. (144): what is stretched on the surface is a void and has no tension, also where it
    /// meets again, until it has closed. Returns the energy of the tension that is lost, or there
    /// again [J].
    DOSEKI_DEVICE_FN double part_on_surface(const Summed& at) const {
        const std::size_t p = at.p;
        const auto now = thermodynamic_state(*model_.material(state_.tag[p]).laws, at.fields.rho);
        const bool closed = now.pressure >= state_.least_pressure[p],
                   parts = !closed && on_surface(p) && dt_ > 0.0;
        const double before = state_.parted[p];
        state_.parted[p] = parts ? 1.0 : closed ? 0.0 : before;
        const bool had_tension = pressure(at) < 0.0, has_again = before > 0.0 && closed;
        if (dt_ <= 0.0 || !(now.pressure < 0.0)) return 0.0;
        const double energy = state_.mass[p] * now.bulk_energy;
        return parts && had_tension ? -energy : has_again ? energy : 0.0;
    }

    /// Of sound, over c h. Beside bodies that move it is that of the fluid: what they squeeze out
    /// is a flow.
    DOSEKI_DEVICE_FN double damping(const Summed& at) const {
        const double alpha = model_.options.flow.acoustic_damping;
        const double walls = at.sums.wall_share, all = at.sums.concentration + walls;
        if (!(walls > 0.0) || at.sums.at_body.value > 0.0) return alpha;
        return damping_beside_walls(alpha, walls / all);
    }

    /// Of the forces that come. It brings no tension that the liquid does not bear, none on a free
    /// surface.
    DOSEKI_DEVICE_FN void damp_sound(const Summed& at) const {
        const std::size_t p = at.p;
        const Material& material = model_.material(state_.tag[p]);
        const double rho = at.fields.rho, h = state_.smoothing_length[p],
                     divergence = trace(state_.velocity_gradient[p]);
        double added = damping_pressure(damping(at), rho, model_.constants.c, h, divergence);
        if (added < 0.0) {
            const double least = model_.min_density[state_.tag[p].material].at(is_vented(at));
            const double bound = pressure_at(*material.laws, least);
            added = std::max(added, std::min(0.0, bound - pressure(at)));
        }
        state_.damping_pressure[p] = on_surface(p) ? 0.0 : added;
    }
};

}  // namespace doseki
