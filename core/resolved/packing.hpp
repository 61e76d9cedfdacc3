#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "resolved/model.hpp"
#include "resolved/records.hpp"

namespace doseki {

/// Fills the records of a particle with what its state will be after `half_dt`.
template <class real, int D>
struct FlowPacker {
    const ResolvedModel<D>& model;
    ResolvedState<D>& state;
    std::span<MotionRecord<real, D>> motion;
    std::span<FluidRecord<real, D>> fluid;
    std::span<WallRecord<real, D>> wall;  // the first is that of particle fluid_count
    std::size_t fluid_count;
    CoordinateFrame<real, D> frame;
    double half_dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        MotionRecord<real, D>& record = motion[p];
        const bool is_wall = p >= fluid_count;
        for (int a = 0; a < D; ++a) {
            record.x[a] = frame.coordinate(state.position[p][a], a);
            record.v[a] = static_cast<real>(state.velocity[p][a] +
                                            (is_wall ? 0.0 : half_dt * state.acceleration[p][a]));
        }
        record.mass = static_cast<real>(state.mass[p]);
        record.inverse_support =
            static_cast<real>(1.0 / (model.kernel_support() * state.smoothing_length[p]));
        if (is_wall)
            pack_wall(p);
        else
            pack_fluid(p);
    }

private:
    DOSEKI_DEVICE_FN void pack_fluid(std::size_t p) const {
        FluidFields<double, D> record;
        const Material& material = model.material(state.tag[p]);
        const Mat<double, D>& L = state.velocity_gradient[p];
        const double rho = state.density[p] + half_dt * state.density_rate[p];
        record.rho = rho;
        record.volume = state.mass[p] / rho, record.rest_volume = state.mass[p] / material.rho0;
        record.surface = state.surface[p];
        record.p = model.without_surface_tension(pressure_at(*material.laws, rho), record.surface,
                                                 state.parted[p]);
        update_mean_pressure(p, record.p, 2.0 * half_dt);
        record.p += state.damping_pressure[p];
        const ShearState<double> sheared{strain_rate(L), state.mean_pressure[p], rho};
        const double mu = viscosity(*material.laws, sheared), h = state.smoothing_length[p];
        record.mu = mu + rho * model.eddy_viscosity(state, p);
        // The outermost particles need all of what damps noise.
        record.resolved_strain = record.surface > FreeSurfaceIndicator::surface
                                     ? 0.0
                                     : sheared.rate * resolved_shear(mu, rho, sheared.rate * h, h);
        for (int a = 0; a < D; ++a)
            for (int b = a; b < D; ++b) record.strain(a, b) = 0.5 * (L(a, b) + L(b, a));
        record.pressure_gradient = state.pressure_gradient[p];
        record.correction = state.correction_excess[p];
        for (int a = 0; a < D; ++a) record.correction(a, a) += 1.0;
        record.carried = L * state.shift[p];
        fluid[p] = converted<FluidRecord<real, D>>(record);
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
        record.volume = state.is_bound(p) ? state.mass[p] / state.density[p]
                                          : (1.0 - walls.cut[p]) * model.spacing_power[D];
        record.no_slip = model.wall_condition(state.tag[p]).no_slip ? 1.0 : 0.0;
        record.bound = state.is_bound(p) ? 1.0 : 0.0;
        // Areas of faces are those of a body that keeps its shape.
        const bool deforms = state.is_point_of(p, BodyKind::deformable);
        record.face = deforms ? Face::none : walls.face[p], record.pressure = walls.pressure[p];
        record.film_density = walls.film_density[p];
        record.film_traction = walls.film_traction[p];
        wall[p - fluid_count] = converted<WallRecord<real, D>>(record);
    }

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
