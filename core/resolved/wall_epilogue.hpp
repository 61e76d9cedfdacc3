#pragma once
#include <cmath>
#include <span>

#include "base/pack.hpp"
#include "resolved/flow_summary.hpp"
#include "resolved/model.hpp"

namespace doseki {

/// What the scheme makes of the sums of a wall particle: force, pressure and, on a rough bed, the
/// friction that fluid particles near it share.
template <int D>
class WallEpilogue {
public:
    WallEpilogue(const ResolvedModel<D>& model, std::span<WallRecord<D>> records,
                 std::size_t first_wall, std::span<FlowSummary<D>> summaries,
                 ResolvedState<D>& state)
        : model_(model),
          records_(records),
          first_wall_(first_wall),
          summaries_(summaries),
          state_(state) {}

    void operator()(std::size_t p, const WallAccumulators<double, D>& sums) const {
        if (p < first_wall_) return;  // a fluid particle in the first cluster of walls
        WallState<D>& wall = state_.wall;
        WallRecord<D>& record = records_[p - first_wall_];
        Vec<double, D> force = sums.force;
        wall.pressure[p] = sums.weight > 0.0 ? sums.pressure / sums.weight : 0.0;
        FlowSummary<D>& summary = summaries_[p / static_cast<std::size_t>(lanes<double>)];
        if (wall.face[p] != Face::none) {
            const Vec<double, D> film = film_force(p, sums);
            force = force + film;
            // The film has no particles whose energy could pay for this.
            summary.work.power += dot(film, state_.velocity[p]);
        }
        const double ks = model_.wall_condition(state_.tag[p]).ks;
        if (ks > 0.0 && record.depth < model_.options.flow.dp && sums.weight > min_filled) {
            const Vec<double, D> drag = bed_drag(p, sums, ks);
            record.traction = (-1.0 / sums.weight) * drag;
            force = force + drag;
            // What the fluid loses by friction and a bed that moves does not get.
            summary.power -= dot(drag, state_.velocity[p]);
        }
        wall.force[p] = force;
    }

private:
    static constexpr double min_filled = 0.05;  // of the kernel, by fluid

    /// The film takes the pressure of the fluid and of the faces around it as they were a step
    /// before: it spreads from the rim of a contact inwards. Air has none; where a face sees hardly
    /// anything, that is what is there.
    Vec<double, D> film_force(std::size_t p, const WallAccumulators<double, D>& sums) const {
        WallState<D>& wall = state_.wall;
        wall.film_density[p] = sums.weight > 0.0 ? sums.density / sums.weight : 0.0;
        wall.film_traction[p] = {};
        if (sums.cover == 0.0) return {};
        const double weight = std::max(sums.weight + sums.cover, model_.full_cover);
        wall.pressure[p] = (sums.pressure + sums.film_pressure) / weight;
        wall.film_density[p] = (sums.density + sums.film_density) / weight;
        wall.film_traction[p] = (-pressure_at_surface(p, opening_speed(p, sums)) /
                                 std::max(sums.cover, model_.full_cover)) *
                                hidden_area(p, sums);
        return sums.film_force;
    }

    /// At which the faces around part from this one.
    double opening_speed(std::size_t p, const WallAccumulators<double, D>& sums) const {
        const Vec<double, D> around = (1.0 / sums.cover) * sums.face_velocity;
        return dot(around - state_.velocity[p], state_.wall.normal[p]);
    }

    /// Faces that part stretch the film between them, or its pressure would do work on them that no
    /// water brings. No film holds tension.
    double pressure_at_surface(std::size_t p, double opening) const {
        const WallState<D>& wall = state_.wall;
        const double slope = dot(model_.options.gravity, wall.normal[p]) * wall.depth[p];
        return std::max(
            0.0, wall.pressure[p] + wall.film_density[p] * (slope - model_.constants.c * opening));
    }

    /// Of the face of a body, that neither its own particles nor fluid particles take up.
    Vec<double, D> hidden_area(std::size_t p, const WallAccumulators<double, D>& sums) const {
        const Vec<double, D>& all = state_.wall.area[p];
        const Vec<double, D> hidden = all - records_[p - first_wall_].volume * sums.area;
        return dot(hidden, all) > 0.0 ? state_.wall.rows[p] * hidden : Vec<double, D>{};
    }

    Vec<double, D> bed_drag(std::size_t p, const WallAccumulators<double, D>& sums,
                            double ks) const {
        const Vec<double, D> u = (1.0 / sums.weight) * sums.velocity - state_.velocity[p];
        const Vec<double, D> along = tangential(u, state_.wall.normal[p]);
        const double rho = sums.density / sums.weight;
        const double friction =
            bed_friction(rho, sums.height / sums.weight, ks) * model_.spacing_power[D - 1];
        return friction * std::sqrt(dot(along, along)) * along;
    }

    const ResolvedModel<D>& model_;
    std::span<WallRecord<D>> records_;
    std::size_t first_wall_;
    std::span<FlowSummary<D>> summaries_;
    ResolvedState<D>& state_;
};

}  // namespace doseki
