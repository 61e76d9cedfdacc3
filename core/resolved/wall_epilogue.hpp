#pragma once
#include <cmath>
#include <span>

#include "base/pack.hpp"
#include "physics/contact.hpp"
#include "resolved/model.hpp"

namespace doseki {

/// What the scheme makes of the sums of a wall particle: force, pressure and, on a rough bed or
/// Voellmy's, the friction that fluid particles near it share.
template <class real, int D>
class WallEpilogue {
public:
    /// Share of its last change with which the pressure of a film goes on: it runs in from the rim
    /// like a wave. By the mean of its surroundings alone it would creep in, the more slowly the
    /// longer the steps are.
    static constexpr double film_inertia = 0.5;

    /// `dt`: since the evaluation before.
    WallEpilogue(const ResolvedModel<D>& model, std::span<WallRecord<real, D>> records,
                 std::size_t first_wall, std::span<FlowSummary<D>> summaries,
                 ResolvedState<D>& state, double dt, double inertia = film_inertia)
        : model_(model),
          records_(records),
          first_wall_(first_wall),
          summaries_(summaries),
          state_(state),
          dt_(dt),
          inertia_(inertia) {}

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const WallAccumulators<double, D>& sums) const {
        if (p < first_wall_) return;  // a fluid particle in the first cluster of walls
        WallState<D>& wall = state_.wall;
        WallRecord<real, D>& record = records_[p - first_wall_];
        Vec<double, D> force = sums.force;
        const double before = wall.pressure[p];
        wall.pressure[p] = sums.weight > 0.0 ? sums.pressure / sums.weight : 0.0;
        FlowSummary<D>& summary = summary_of<real>(summaries_, p);
        if (wall.face[p] != Face::none) {
            wall.wetted[p] = wetted(p, sums);
            const Vec<double, D> film = film_force(p, sums, before);
            force = force + film;
            // The film has no particles whose energy could pay for this.
            summary.work.power += dot(film, state_.velocity[p]);
        }
        const WallCondition& condition = model_.wall_condition(state_.tag[p]);
        if (condition.has_friction()) {
            const Vec<double, D> drag =
                condition.voellmy ? voellmy_drag(p, sums, condition) : bed_drag(p, sums, condition);
            if (dot(drag, drag) > 0.0)
                record.traction = converted<Vec<real, D>>((-1.0 / sums.weight) * drag);
            force = force + drag;
            // What the fluid loses by friction and a bed that moves does not get.
            summary.power -= dot(drag, state_.velocity[p]);
        }
        wall.force[p] = force, wall.moment[p] = moment_about(p, sums);
    }

    /// See KnowsIdleParticles: where neither fluid nor a film is, nor was a step before.
    bool needs_sums(std::size_t p) const {
        const WallState<D>& wall = state_.wall;
        return p < first_wall_ || acts(p) || wall.film_change[p] != 0.0 ||
               dot(wall.force[p], wall.force[p]) > 0.0;
    }
    bool acts(std::size_t p) const {
        const WallRecord<real, D>& record = records_[p - first_wall_];
        return record.pressure != 0 || record.film_density != 0 ||
               dot(record.film_traction, record.film_traction) > 0;
    }

private:
    static constexpr double min_filled = 0.05;  // of the kernel, by fluid
    static constexpr double min_weight = 1e-9;  // the same; less presses with nothing

    /// Share of what it would see of a plane face that a face sees at least where no air is: one of
    /// a shape with edges, beside one that curves; and one without, of balls and of what deforms,
    /// or beside a crack, which goes up and down by a spacing.
    static constexpr double of_edged = 0.9, of_others = 0.6;

    /// Of the pairs, about the particle; the sums of a ball are about its centre.
    DOSEKI_DEVICE_FN Turn<double, D> moment_about(std::size_t p,
                                                  const WallAccumulators<double, D>& sums) const {
        const WallState<D>& wall = state_.wall;
        const double radius = radius_of_ball(wall.bend[p], wall.normal[p]);
        if (!(radius > 0.0) || !state_.is_bound(p)) return sums.moment;
        const double out = radius - 0.5 * model_.spacing_power[1] - wall.depth[p];
        return sums.moment - moment_of(out * wall.normal[p], sums.force);
    }

    DOSEKI_DEVICE_FN double volume(std::size_t p) const { return records_[p - first_wall_].volume; }

    /// The film goes towards the pressure of the fluid and of the faces around it as they were a
    /// step `before`, Eq. (137). Air has none; where a face sees hardly anything, that is what is
    /// there.
    DOSEKI_DEVICE_FN Vec<double, D> film_force(std::size_t p,
                                               const WallAccumulators<double, D>& sums,
                                               double before) const {
        WallState<D>& wall = state_.wall;
        wall.film_density[p] = sums.weight > 0.0 ? sums.density / sums.weight : 0.0;
        wall.film_traction[p] = {}, wall.film_aside[p] = {};
        const bool dry = sums.weight == 0.0 && sums.film_density == 0.0 && before == 0.0;
        wall.film_cover[p] = dry ? 0.0 : std::min(1.0, sums.cover / least_cover(p));
        if (sums.cover == 0.0) {
            wall.film_change[p] = 0.0;
            return {};
        }
        const double weight = with_air(p, sums);
        const double mean = (sums.pressure + sums.film_pressure) / weight;
        wall.film_change[p] = mean - before + inertia_ * wall.film_change[p];
        wall.pressure[p] = before + wall.film_change[p];
        wall.film_density[p] = (sums.density + sums.film_density) / weight;
        set_film_traction(p, sums);
        return sums.film_force;
    }

    DOSEKI_DEVICE_FN void set_film_traction(std::size_t p,
                                            const WallAccumulators<double, D>& sums) const {
        const Vec<double, D> hidden = without_air(p, hidden_area(p, sums), sums);
        const double size = std::sqrt(dot(hidden, hidden));
        if (size == 0.0) return;
        const double pressure = pressure_at_surface(p, (1.0 / size) * hidden, sums),
                     of_area = -pressure / std::max(sums.cover, least_cover(p));
        const auto inverse_support =
            static_cast<real>(1.0 / (model_.kernel_support() * state_.smoothing_length[p]));
        if (is_at_edge<real, D>(records_[p - first_wall_], inverse_support))
            deal_out(p, hidden, of_area, sums);
        else
            state_.wall.film_traction[p] = of_area * hidden;
    }

    /// At an edge: what acts along each face, over how much others are in front of it, and what of
    /// it acts aside, over how much they are in front of other faces: what adds up to all of it.
    DOSEKI_DEVICE_FN void deal_out(std::size_t p, const Vec<double, D>& hidden, double of_area,
                                   const WallAccumulators<double, D>& sums) const {
        WallState<D>& wall = state_.wall;
        const Vec<double, D> along = along_faces(p, hidden);
        Vec<double, D> aside{};
        if constexpr (D == 2) aside = area_aside(p, along, sums);
        for (int k = 0; k < D; ++k)
            wall.film_traction[p][k] = of_area * (along[k] + aside[k]) * sums.cover /
                                       (sums.facing[k] + in_front_of_none * sums.cover);
        if constexpr (D == 2)
            for (int k = 0; k < D; ++k)
                if (const double other = sums.facing[1 - k]; other > 0.0)
                    wall.film_aside[p][k] = -of_area * aside[k] * sums.cover / other;
    }

    /// What of an area is along each face at an edge.
    DOSEKI_DEVICE_FN Vec<double, D> along_faces(std::size_t p, const Vec<double, D>& area) const {
        constexpr int sweeps = 8;  // of faces that are not at right angles
        const Mat<double, D>& faces = state_.wall.edge_normals[p];
        Vec<double, D> left = area, found{};
        for (int n = 0; n < sweeps; ++n)
            for (int k = 0; k < D; ++k) {
                const double of_face = dot(left, row(faces, k));
                found[k] += of_face, left = left - of_face * row(faces, k);
            }
        return found;
    }

    /// Eq. (182): what an edge lacks of a face that goes on, where others cover it and a face
    /// beside it. What goes on there is another body, which presses aside on it as water would;
    /// what is `hidden` along each face lacks nothing of that where there is water.
    DOSEKI_DEVICE_FN Vec<double, D> area_aside(std::size_t p, const Vec<double, D>& hidden,
                                               const WallAccumulators<double, D>& sums) const {
        const WallState<D>& wall = state_.wall;
        const Vec<double, D> own = along_faces(p, wall.area[p]);
        Vec<double, D> covered{}, aside{};
        for (int k = 0; k < D; ++k)
            covered[k] = std::min(1.0, met_by_faces(p, row(wall.edge_normals[p], k), sums)) *
                         much_in_front(sums.facing[k], sums.cover);
        for (int k = 0; k < D; ++k) {
            const double flat = volume(p) * model_.flat_area.at(wall.edge_depths[p][k]),
                         lacks = std::min(flat - own[k], flat - hidden[k]);
            aside[k] = covered[0] * covered[1] * std::max(0.0, lacks);
        }
        return aside;
    }

    /// From 0 to 1 as more of what covers a particle is in front of a face. The force of a step is
    /// dealt out by what is there in the next, where little may be many times as much.
    DOSEKI_DEVICE_FN static double much_in_front(double facing, double cover) {
        constexpr double little = 0.003;  // of the cover; a plane face has some 0.05
        const double square = facing * facing;
        return square > 0.0 ? square / (square + little * little * cover * cover) : 0.0;
    }

    DOSEKI_DEVICE_FN double farthest(std::size_t p) const {
        const FullCover& full = model_.full_cover;
        return state_.wall.face[p] > Face::none ? full.farthest : full.farthest_below;
    }
    DOSEKI_DEVICE_FN double least_cover(std::size_t p) const {
        return model_.full_cover.at(farthest(p));
    }
    /// Eq. (174): what a face sees of water, other faces and air. That of a body knows air by what
    /// is missing of a face that goes on all around, at the distance of the one that is there; one
    /// that curves lacks some as well. At edges half of what is around is on the other side.
    DOSEKI_DEVICE_FN double with_air(std::size_t p, const WallAccumulators<double, D>& sums) const {
        const double seen = sums.weight + sums.cover, least = std::max(seen, least_cover(p));
        if (state_.wall.face[p] < Face::first_body) return least;
        const double least_share = has_edges(p) ? of_edged : of_others,
                     share = std::min(
                         1.0, seen / (least_share * model_.full_cover.at(to_face(p, sums)))),
                     square = share * share;
        return std::max(least, 2.0 * seen / (square * square * (1.0 + met_beyond_edges(p, sums))));
    }

    /// Whether its body tells of edges.
    DOSEKI_DEVICE_FN bool has_edges(std::size_t p) const {
        const Vec<double, D> nearest = row(state_.wall.edge_normals[p], 0);
        return dot(nearest, nearest) > 0.0;
    }

    /// How far the nearest of the other faces is in front of one of its own.
    DOSEKI_DEVICE_FN double to_face(std::size_t p, const WallAccumulators<double, D>& sums) const {
        double least = farthest(p);
        for (int k = 0; k < D; ++k)
            if (sums.facing[k] > in_front_of_none * sums.cover)
                least = std::min(least, sums.facing_height[k] / sums.facing[k]);
        return least;
    }

    /// The least of `met` of the faces at an edge.
    DOSEKI_DEVICE_FN double met_beyond_edges(std::size_t p,
                                             const WallAccumulators<double, D>& sums) const {
        const WallState<D>& wall = state_.wall;
        double least = 1.0;
        for (int k = 0; k < D; ++k)
            if (wall.edge_depths[p][k] < model_.options.flow.dp)
                least = std::min(least, met(p, row(wall.edge_normals[p], k), sums));
        return least;
    }

    /// What is hidden of a face that meets nothing has air in front of it: below its foot it sees
    /// the face on which its body stands.
    DOSEKI_DEVICE_FN Vec<double, D> without_air(std::size_t p, const Vec<double, D>& hidden,
                                                const WallAccumulators<double, D>& sums) const {
        const WallState<D>& wall = state_.wall;
        if (!has_edges(p)) return met(p, wall.normal[p], sums) * hidden;
        Vec<double, D> pressed = hidden;
        for (int k = 0; k < D; ++k) {
            const Vec<double, D> n = row(wall.edge_normals[p], k);
            const double air = 1.0 - met(p, n, sums);
            pressed = pressed - (air * std::max(0.0, dot(pressed, n))) * n;
        }
        return pressed;
    }

    /// Eq. (175): whether the face with the normal n meets water or another face, from 0, air,
    /// to 1.
    DOSEKI_DEVICE_FN double met(std::size_t p, const Vec<double, D>& n,
                                const WallAccumulators<double, D>& sums) const {
        const double all = dot(state_.wall.area[p], n);
        if (!(all > 0.0)) return 1.0;
        const double water = 3.0 * volume(p) * dot(sums.area, n) / all;
        return std::min(1.0, std::max(0.0, water) + met_by_faces(p, n, sums));
    }
    DOSEKI_DEVICE_FN double met_by_faces(std::size_t p, const Vec<double, D>& n,
                                         const WallAccumulators<double, D>& sums) const {
        const double little = 0.5 * farthest(p) * least_cover(p),
                     lean = 0.01 * std::sqrt(dot(sums.to_face, sums.to_face));
        return std::max(0.0, (dot(sums.to_face, n) - lean) / little);
    }

    /// That of the film where it presses against the direction n. Faces that part stretch the film
    /// between them, or its pressure would do work on them that no water brings. Those that close
    /// squeeze it out, which water around them resists. No film holds tension.
    DOSEKI_DEVICE_FN double pressure_at_surface(std::size_t p, const Vec<double, D>& n,
                                                const WallAccumulators<double, D>& sums) const {
        const WallState<D>& wall = state_.wall;
        const Vec<double, D> around = (1.0 / sums.cover) * sums.face_velocity;
        const double opening = std::max(0.0, dot(around - state_.velocity[p], n));
        const double slope = dot(model_.options.gravity, n) * wall.depth[p];
        return std::max(
            0.0, wall.pressure[p] + wall.film_density[p] * (slope - model_.constants.c * opening));
    }

    /// Of the face of a body, that neither its own particles nor fluid particles take up.
    DOSEKI_DEVICE_FN Vec<double, D> hidden_area(std::size_t p,
                                                const WallAccumulators<double, D>& sums) const {
        const Vec<double, D>& all = state_.wall.area[p];
        return dot(all, all) > 0.0 ? all - volume(p) * sums.area : Vec<double, D>{};
    }

    /// Eq. (152), where no other face is near.
    DOSEKI_DEVICE_FN double wetted(std::size_t p, const WallAccumulators<double, D>& sums) const {
        const Vec<double, D>& all = state_.wall.area[p];
        const double square = dot(all, all);
        if (sums.cover > 0.0 || square == 0.0) return 0.0;
        return volume(p) * dot(sums.area, all) / square;
    }

    /// Velocity of the fluid around along the wall and against it.
    DOSEKI_DEVICE_FN Vec<double, D> sliding(std::size_t p,
                                            const WallAccumulators<double, D>& sums) const {
        return tangential((1.0 / sums.weight) * sums.velocity, state_.wall.normal[p]);
    }

    /// On a particle of the first row that is near enough to the fluid, Eq. (39), and the slope of
    /// the law for all rows, Eq. (183). Where fluid sticks to the bed as well, its viscous stress
    /// there is a part of this one.
    DOSEKI_DEVICE_FN Vec<double, D> bed_drag(std::size_t p, const WallAccumulators<double, D>& sums,
                                             const WallCondition& wall) const {
        const bool is_first = state_.wall.depth[p] < model_.options.flow.dp;
        Vec<double, D>& shear = state_.bed_shear[p];
        shear = {};
        if (!(sums.weight > min_weight)) return {};
        const Vec<double, D> along = sliding(p, sums);
        const double rho = sums.density / sums.weight, height = sums.height / sums.weight;
        const double turbulent = bed_friction(rho, height, wall.ks) * std::sqrt(dot(along, along)),
                     viscosity = wall.no_slip ? sums.viscosity / sums.weight : 0.0,
                     viscous = viscosity / std::max(height, 0.25 * model_.options.flow.dp);
        const double added = std::max(0.0, turbulent - viscous);
        if (!(added > 0.0)) return {};
        shear = (added / turbulent * bed_slope(height, wall.ks)) * along;
        const bool bears = is_first && sums.weight > min_filled;
        return (bears ? added * model_.spacing_power[D - 1] : 0.0) * along;
    }

    /// Eqs. (92) and (93). Each row takes the friction of the force that the fluid presses on it
    /// with, so that friction belongs to the whole weight of what lies on the bed, whatever its
    /// depth is and wherever it ends.
    DOSEKI_DEVICE_FN Vec<double, D> voellmy_drag(std::size_t p,
                                                 const WallAccumulators<double, D>& sums,
                                                 const WallCondition& wall) const {
        const Vec<double, D>& n = state_.wall.normal[p];
        Vec<double, D>& slip = state_.bed_slip[p];
        const double area = volume(p) * dot(sums.area, n);
        if (!(sums.weight > min_weight) || !(area > 0.0)) {
            state_.bed_load[p] = 0.0;
            return slip = {};
        }
        const Vec<double, D> u = sliding(p, sums);
        const Vec<double, D>& g = model_.options.gravity;
        const double rho = sums.density / sums.weight, speed = std::sqrt(dot(u, u)),
                     gravity = std::sqrt(dot(g, g)),
                     load = mean_load(p, -dot(sums.force, n) / area, rho * gravity);
        const double stress = voellmy_stress(wall.mu, wall.effective_share * load, rho, gravity,
                                             speed, wall.turbulent_xi);
        const BedSpring spring = BedSpring::of(rho, model_.constants.c, model_.options.flow.dp);
        slip = tangential(slip, n);
        // The fluid is held; the wall gets the opposite.
        return -1.0 * sliding_spring(slip, u, dt_, area * spring.stiffness, area * spring.damping,
                                     area * stress);
    }

    /// Eq. (107); `weight` is that of the fluid [N/m^3]. Friction that followed each wave of sound
    /// would drive the waves along the bed until they lift the fluid off it.
    DOSEKI_DEVICE_FN double mean_load(std::size_t p, double pressed, double weight) const {
        double& load = state_.bed_load[p];
        const double depth = weight > 0.0 ? load / weight : 0.0,
                     time = bed_load_crossings * depth / model_.constants.c;
        load = dt_ < time ? load + dt_ / time * (pressed - load) : pressed;
        return load;
    }

    const ResolvedModel<D>& model_;
    std::span<WallRecord<real, D>> records_;
    std::size_t first_wall_;
    std::span<FlowSummary<D>> summaries_;
    ResolvedState<D>& state_;
    double dt_, inertia_;
};

}  // namespace doseki
