#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "resolved/model.hpp"
#include "resolved/records.hpp"

namespace doseki {

/// Correction of kernel gradients. None near a free surface, where there is little pressure and the
/// inverse moment is large. Bounded in a hole.
template <int D>
DOSEKI_DEVICE_FN Sym<double, D> kernel_correction(const ResolvedState<D>& state, std::size_t p) {
    constexpr double min_determinant = 0.3;  // of the moment
    constexpr double max_excess = 0.5;
    const Sym<double, D>& inverse = state.inverse_moment[p];
    const bool corrected =
        std::max(state.surface_around[p], state.surface[p]) < FreeSurfaceIndicator::surface &&
        inverse(0, 0) > 0.0 && min_determinant * determinant(full(inverse)) < 1.0;
    Sym<double, D> excess{};
    if (corrected) {
        excess = inverse;
        for (int a = 0; a < D; ++a) excess(a, a) -= 1.0;
        bound_size(excess, max_excess);
    }
    for (int a = 0; a < D; ++a) excess(a, a) += 1.0;
    return excess;
}

/// What the sums for densities and those for forces read.
template <class real, int D>
struct FlowPacker {
    const ResolvedModel<D>& model;
    ResolvedState<D>& state;
    std::span<MotionRecord<real, D>> motion;
    std::span<FluidRecord<real, D>> fluid;
    std::span<WallRecord<real, D>> wall;  // the first is that of particle fluid_count
    std::size_t fluid_count;
    CoordinateFrame<real, D> frame;
    real inverse_support;
    double half_dt;

    DOSEKI_DEVICE_FN bool is_wall(std::size_t p) const { return p >= fluid_count; }

    DOSEKI_DEVICE_FN void pack_motion(std::size_t p, const Vec<double, D>& x,
                                      const Vec<double, D>& v) const {
        MotionRecord<real, D>& record = motion[p];
        for (int a = 0; a < D; ++a)
            record.x[a] = frame.coordinate(x[a], a), record.v[a] = static_cast<real>(v[a]);
        record.mass = static_cast<real>(state.mass[p]);
        record.inverse_support = inverse_support;
    }

    /// What both kinds of sums read of fluid.
    DOSEKI_DEVICE_FN FluidFields<double, D> fluid_fields(std::size_t p) const {
        FluidFields<double, D> record;
        const Material& material = model.material(state.tag[p]);
        const double rho = record.rho = state.density[p];
        record.volume = state.mass[p] / rho, record.rest_volume = state.mass[p] / material.rho0;
        record.surface = state.surface[p];
        record.p = model.without_surface_tension(pressure_at(*material.laws, rho), state, p);
        record.pressure_gradient = state.pressure_gradient[p];
        record.correction = kernel_correction(state, p);
        record.in_film = state.in_film[p];
        return record;
    }
};

/// For densities: the middle of the step, at which velocities are. Positions are those of its end.
template <class real, int D>
struct ContinuityPacker : FlowPacker<real, D> {
    using FlowPacker<real, D>::state, FlowPacker<real, D>::model, FlowPacker<real, D>::half_dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        if (this->is_wall(p)) {
            const Vec<double, D>& v = state.velocity[p];
            this->pack_motion(p, state.position[p] - (moves(p) ? half_dt : 0.0) * v, v);
            return pack_wall(p);
        }
        this->pack_motion(p, state.position[p] - half_dt * state.transport_velocity(p),
                          state.velocity[p]);
        FluidFields<double, D> record = this->fluid_fields(p);
        record.p += state.damping_pressure[p];
        record.mu = model.viscosity(state, p);
        record.strain = {}, record.turning = {}, record.carried = {}, record.resolved_strain = 0.0;
        this->fluid[p] = converted<FluidRecord<real, D>>(record);
    }

private:
    /// The walls of a belt stay where they are.
    DOSEKI_DEVICE_FN bool moves(std::size_t p) const {
        return state.is_bound(p) || model.wall_condition(state.tag[p]).moves;
    }
    DOSEKI_DEVICE_FN void pack_wall(std::size_t p) const {
        WallFields<double, D> record;
        const WallState<D>& walls = state.wall;
        const Vec<double, D> nearest = row(walls.edge_normals[p], 0);
        if (dot(nearest, nearest) > 0.0) {
            record.faces = walls.edge_normals[p], record.depths = walls.edge_depths[p];
        } else {
            record.faces = {}, record.depths = {};
            for (int a = 0; a < D; ++a) record.faces(0, a) = walls.normal[p][a];
            record.depths[0] = walls.depth[p];
        }
        record.g_normal = record.faces * (state.acceleration[p] - model.options.gravity);
        record.bend = walls.bend[p];
        record.traction = {};
        record.shear = state.has_rough_beds ? state.bed_shear[p] : Vec<double, D>{};
        record.volume = state.is_bound(p) ? state.mass[p] / state.density[p]
                                          : (1.0 - walls.cut[p]) * model.spacing_power[D];
        record.no_slip = model.wall_condition(state.tag[p]).no_slip ? 1.0 : 0.0;
        record.inverse_density = state.is_bound(p) ? 1.0 / state.density[p] : 0.0;
        const bool deforms = state.is_point_of(p, BodyKind::deformable);
        record.spin = deforms ? Turn<double, D>{} : walls.spin[p];
        record.face = walls.face[p], record.pressure = walls.pressure[p];
        record.film_density = walls.film_density[p];
        record.film_cover = walls.film_cover[p];
        record.film_traction = walls.film_traction[p];
        record.film_aside = walls.film_aside[p];
        this->wall[p - this->fluid_count] = converted<WallRecord<real, D>>(record);
    }
};

/// The wall particle of a number among them.
template <class Packer>
struct PackWall {
    Packer packer;
    DOSEKI_DEVICE_FN void operator()(std::size_t n) const { packer(packer.fluid_count + n); }
};

/// For forces: the end of the step, with the velocities of fluid predicted for it. Walls are packed
/// but for their place.
template <class real, int D>
struct ForcePacker : FlowPacker<real, D> {
    using FlowPacker<real, D>::state, FlowPacker<real, D>::model, FlowPacker<real, D>::half_dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        if (this->is_wall(p)) return this->pack_motion(p, state.position[p], state.velocity[p]);
        this->pack_motion(p, state.position[p],
                          state.velocity[p] + half_dt * state.acceleration[p]);
        FluidFields<double, D> record = this->fluid_fields(p);
        update_mean_pressure(p, record.p, 2.0 * half_dt);
        record.p += state.damping_pressure[p];
        const Mat<double, D>& L = state.velocity_gradient[p];
        const double mu = record.mu = model.viscosity(state, p), rate = strain_rate(L),
                     h = state.smoothing_length[p];
        // The outermost particles need all of what damps noise.
        record.resolved_strain = record.surface > FreeSurfaceIndicator::surface
                                     ? 0.0
                                     : rate * resolved_shear(mu, state.density[p], rate * h, h);
        record.strain = symmetric_part(L), record.turning = turning_part(L);
        record.carried = L * state.shift[p];
        this->fluid[p] = converted<FluidRecord<real, D>>(record);
    }

private:
    /// Friction between grains takes the mean over the relaxation time of the density: sound that
    /// runs to and fro is no load on a contact. What never had a pressure takes the first it gets.
    DOSEKI_DEVICE_FN void update_mean_pressure(std::size_t p, double pressure, double dt) const {
        double& mean = state.mean_pressure[p];
        const double share =
            dt * model.constants.c / (density_relaxation * state.smoothing_length[p]);
        mean = mean == 0.0 ? pressure : mean + std::min(share, 1.0) * (pressure - mean);
    }
};

}  // namespace doseki
