#pragma once
// How the resolved scheme evaluates its right-hand side.

#include <algorithm>
#include <cmath>

#include "base/array.hpp"
#include "base/poison.hpp"
#include "ranks/common_frame.hpp"
#include "resolved/flow_depth.hpp"
#include "resolved/fluid_epilogue.hpp"
#include "resolved/force_terms.hpp"
#include "resolved/interactions.hpp"
#include "resolved/model.hpp"
#include "resolved/right_hand_side.hpp"
#include "resolved/wall_epilogue.hpp"

namespace doseki {

template <int D, class real, class Backend>
Resolved<D, real, Backend>::Resolved(Array<Material> materials, const Options<D>& options)
    : model_(std::make_shared<const ResolvedModel<D>>(std::move(materials), options)) {}

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::evaluate(State& state, const Lists& lists, Halo<D>& halo,
                                          double half_dt, bool) {
    fluid_count_ = lists.moving();
    if (steps_since_depths_ == 0 && model_->options.flow.turbulence == Turbulence::mixing_length)
        set_mixing_lengths(state, lists, halo.ranks);
    pack(state, halo, half_dt);
    if (model_->options.flow.wide_kernel)
        sum_all<WendlandC6<D>>(state, lists, halo, 2.0 * half_dt);
    else
        sum_all<WendlandC2<D>>(state, lists, halo, 2.0 * half_dt);
    reduce_summaries();
    const std::int64_t left = is_poisoned_run() ? survivor<double>(state.acceleration) : -1;
    if (left >= 0) fault_.note(Fault::right_hand_side, static_cast<std::size_t>(left));
    fault_ = traced_to_its_source(fault_, state, model_->materials);
    agree(halo.ranks, timestep_, limiting_, fault_);
}

template <int D, class real, class Backend>
FlowRecords<real, D> Resolved<D, real, Backend>::records(const State& state) const {
    const std::size_t count = state.size();
    const auto inverse_support =
        static_cast<real>(1.0 / (kernel_support() * (count > 0 ? state.smoothing_length[0] : 1.0)));
    return {motion_,
            fluid_,
            wall_,
            static_cast<std::uint32_t>(fluid_count_),
            static_cast<std::uint32_t>(count),
            inverse_support};
}

/// In columns of about four spacings, such that whole ones fill a period.
template <int D, class real, class Backend>
void Resolved<D, real, Backend>::set_mixing_lengths(State& state, const Lists& lists,
                                                    const Ranks& ranks) {
    const FlowOptions& flow = model_->options.flow;
    Vec<double, D - 1> width;
    for (int a = 0; a < D - 1; ++a) {
        double period = 0.0;
        for (const auto& shift : lists.image_shifts()) period = std::max(period, shift[a]);
        const double columns = std::max(1.0, std::floor(period / (4.0 * flow.dp)));
        width[a] = period > 0.0 ? period / columns : 4.0 * flow.dp;
    }
    const FlowDepth<D> depth(state, fluid_count_, width, ranks);
    const double min_length = flow.smagorinsky * flow.dp;
    Backend::for_each_particle(fluid_count_, [&](std::size_t p) {
        state.mixing_length[p] = depth.mixing_length(state.position[p], min_length);
    });
}

/// Fills the records with what the state will be after `half_dt`.
template <int D, class real, class Backend>
void Resolved<D, real, Backend>::pack(State& state, const Halo<D>& halo, double half_dt) {
    const auto timing = phases_.measure(Phase::pack);
    const std::size_t n = state.size(), ghosts = halo.ghosts(), moving = halo.moving_ghosts();
    frame_ = common_frame<real, D>(state.position, halo.ranks);
    motion_.resize(n + ghosts), wall_.resize(n - fluid_count_ + ghosts);
    fluid_.resize(moving > 0 ? n + moving : fluid_count_);
    summary_.assign((n + Backend::width - 1) / Backend::width, {});
    if (is_poisoned_run()) poison<real>(motion_), poison<real>(fluid_), poison<real>(wall_);
    Backend::for_each_particle(n, [&](std::size_t p) {
        MotionRecord<real, D>& record = motion_[p];
        const bool wall = p >= fluid_count_;
        for (int a = 0; a < D; ++a) {
            record.x[a] = frame_.coordinate(state.position[p][a], a);
            record.v[a] = static_cast<real>(state.velocity[p][a] +
                                            (wall ? 0.0 : half_dt * state.acceleration[p][a]));
        }
        record.mass = static_cast<real>(state.mass[p]);
        record.inverse_support =
            static_cast<real>(1.0 / (kernel_support() * state.smoothing_length[p]));
        if (wall)
            pack_wall(state, p);
        else
            pack_fluid(state, p, half_dt);
    });
}

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::pack_fluid(State& state, std::size_t p, double half_dt) {
    FluidFields<double, D> record;
    const Material& material = model_->material(state.tag[p]);
    const Mat<double, D>& L = state.velocity_gradient[p];
    const double rho = state.density[p] + half_dt * state.density_rate[p];
    record.rho = rho;
    record.volume = state.mass[p] / rho, record.rest_volume = state.mass[p] / material.rho0;
    record.surface = state.surface[p];
    record.p = model_->without_surface_tension(pressure_at(*material.laws, rho), record.surface,
                                               state.parted[p]);
    update_mean_pressure(state, p, record.p, 2.0 * half_dt);
    record.p += state.damping_pressure[p];
    const ShearState<double> sheared{strain_rate(L), state.mean_pressure[p], rho};
    const double mu = viscosity(*material.laws, sheared), h = state.smoothing_length[p];
    record.mu = mu + rho * model_->eddy_viscosity(state, p);
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
    fluid_[p] = converted<FluidRecord<real, D>>(record);
}

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::pack_wall(const State& state, std::size_t p) {
    WallFields<double, D> record;
    const WallState<D>& wall = state.wall;
    const Vec<double, D> nearest = row(wall.edge_normals[p], 0);
    if (dot(nearest, nearest) > 0.0) {
        record.faces = wall.edge_normals[p], record.depths = wall.edge_depths[p];
    } else {
        record.faces = {}, record.depths = {};
        for (int a = 0; a < D; ++a) record.faces(0, a) = wall.normal[p][a];
        record.depths[0] = wall.depth[p];
    }
    record.g_normal = record.faces * (state.acceleration[p] - model_->options.gravity);
    record.bend = wall.bend[p];
    record.traction = {};
    record.volume = state.is_bound(p) ? state.mass[p] / state.density[p]
                                      : (1.0 - wall.cut[p]) * model_->spacing_power[D];
    record.no_slip = model_->wall_condition(state.tag[p]).no_slip ? 1.0 : 0.0;
    record.bound = state.is_bound(p) ? 1.0 : 0.0;
    record.face = wall.face[p], record.pressure = wall.pressure[p];
    record.film_density = wall.film_density[p];
    record.film_traction = wall.film_traction[p];
    wall_[p - fluid_count_] = converted<WallRecord<real, D>>(record);
}

/// Friction between grains takes the mean over the relaxation time of the density: sound that runs
/// to and fro is no load on a contact. What never had a pressure takes the first it gets.
template <int D, class real, class Backend>
void Resolved<D, real, Backend>::update_mean_pressure(State& state, std::size_t p, double pressure,
                                                      double dt) {
    double& mean = state.mean_pressure[p];
    const double share =
        dt * model_->constants.c / (density_relaxation * state.smoothing_length[p]);
    mean = mean == 0.0 ? pressure : mean + std::min(share, 1.0) * (pressure - mean);
}

/// On many ranks the fluid's pairs are summed while records of ghosts, or the friction of their
/// beds, come.
template <int D, class real, class Backend>
template <class Kernel>
void Resolved<D, real, Backend>::sum_all(State& state, const Lists& lists, Halo<D>& halo,
                                         double dt) {
    const std::size_t first_ghost_wall = fluid_count_;
    halo.start({halo_column(motion_), halo_column(fluid_, HaloColumn::moving),
                halo_column(wall_, HaloColumn::fixed, first_ghost_wall)});
    const FlowRecords<real, D> records = this->records(state);
    const bool friction = model_->has_bed_friction();
    if (friction || halo.alone()) {
        halo.finish();
        sum_walls<Kernel>(state, lists, records, dt);
        if (friction)
            halo.start({halo_column(wall_, &WallRecord<real, D>::traction, HaloColumn::fixed,
                                    first_ghost_wall)});
        sum_fluid<Kernel>(state, lists, halo, records, dt);
    } else {
        sum_fluid<Kernel>(state, lists, halo, records, dt);
        sum_walls<Kernel>(state, lists, records, dt);
    }
}

/// Whether fluid, or a film between faces, presses on walls here, or did a step before. Films reach
/// farther than fluid does, so a rank may have films and no fluid.
template <int D, class real, class Backend>
bool Resolved<D, real, Backend>::has_wet_walls(const FlowRecords<real, D>& records) const {
    if (records.count == records.fluid_count) return false;
    return !fluid_.empty() || std::any_of(wall_.begin(), wall_.end(), [](const auto& wall) {
        return wall.pressure != 0.0 || wall.film_density != 0.0;
    });
}

template <int D, class real, class Backend>
template <class Kernel>
void Resolved<D, real, Backend>::sum_walls(State& state, const Lists& lists,
                                           const FlowRecords<real, D>& records, double dt) {
    const auto timing = phases_.measure(Phase::pass_1);
    if (!has_wet_walls(records)) {
        std::ranges::fill(state.wall.force.stored(), Vec<double, D>{});
        return;
    }
    const std::size_t first = fluid_count_ / Backend::width;
    Backend::sum_pairs(
        lists, {lists.clusters().subspan(first), motion_, frame_, {.first_cluster = first}},
        WallTerm<Kernel, real, D>{records, model_->constants, model_->options.gravity},
        WallEpilogue<real, D>(*model_, wall_, fluid_count_, summary_, state, dt));
}

template <int D, class real, class Backend>
template <class Kernel>
void Resolved<D, real, Backend>::sum_fluid(State& state, const Lists& lists, Halo<D>& halo,
                                           const FlowRecords<real, D>& records, double dt) {
    const FluidTerm<Kernel, real, D> term{records, model_->constants};
    const FluidEpilogue<real, D> epilogue(*model_, fluid_, fluid_count_, summary_, state, dt);
    const std::size_t clusters = (fluid_count_ + Backend::width - 1) / Backend::width;
    while_ghosts_come(halo, lists, lists.clusters().first(clusters), Backend::width,
                      [&](std::span<const ClusterList> part, std::size_t first) {
                          const auto timing = phases_.measure(Phase::pass_2);
                          Backend::sum_pairs(lists,
                                             {part, motion_, frame_, {.first_cluster = first}},
                                             term, epilogue);
                      });
}

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::reduce_summaries() {
    // What enters next may be the first fluid there is.
    const Options<D>& options = model_->options;
    timestep_ = options.cflnumber * options.eta * options.flow.dp / model_->constants.c;
    power_ = 0.0, work_ = {};
    fault_ = {}, limiting_ = -1;
    for (const FlowSummary<D>& summary : summary_) {
        if (summary.timestep < timestep_)
            timestep_ = summary.timestep, limiting_ = summary.limiting;
        power_ += summary.power, work_.add(summary.work);
        fault_.merge(summary.fault);
    }
}

template <int D, class real, class Backend>
ForceTerms<D> Resolved<D, real, Backend>::force_terms(const State& state, const Lists& lists,
                                                      Halo<D>&, std::int64_t p) const {
    if (p < 0 || !state.is_free(static_cast<std::size_t>(p)) ||
        static_cast<std::size_t>(p) >= fluid_count_)
        return {};
    const FluidPass<D, real, Backend> pass{lists, frame_, records(state), *model_};
    return doseki::force_terms<D, real, Backend>(pass, state, static_cast<std::size_t>(p));
}

template <int D, class real, class Backend>
ThermodynamicState<double> Resolved<D, real, Backend>::equation_of_state(const State& state,
                                                                         std::size_t p) const {
    if (state.is_wall(p)) return {state.wall.pressure[p], model_->constants.c, 0.0};
    const Material& material = model_->material(state.tag[p]);
    const auto at = thermodynamic_state(*material.laws, state.density[p]);
    return {model_->without_surface_tension(at.pressure, state.surface[p], state.parted[p]),
            material.c0, at.bulk_energy};
}

template <int D, class real, class Backend>
double Resolved<D, real, Backend>::kernel_support() const {
    return model_->kernel_support();
}

template <int D, class real, class Backend>
const Array<Material>& Resolved<D, real, Backend>::materials() const {
    return model_->materials;
}

}  // namespace doseki
