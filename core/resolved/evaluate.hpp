#pragma once
// How the resolved scheme evaluates its right-hand side.

#include <algorithm>
#include <cmath>

#include "base/array.hpp"
#include "base/poison.hpp"
#include "physics/stress.hpp"
#include "ranks/common_frame.hpp"
#include "resolved/continuity_epilogue.hpp"
#include "resolved/flow_depth.hpp"
#include "resolved/fluid_epilogue.hpp"
#include "resolved/force_terms.hpp"
#include "resolved/interactions.hpp"
#include "resolved/model.hpp"
#include "resolved/packing.hpp"
#include "resolved/right_hand_side.hpp"
#include "resolved/wall_epilogue.hpp"

namespace doseki {

template <int D, class real, class Backend>
Resolved<D, real, Backend>::Resolved(Array<Material> materials, const Options<D>& options)
    : model_(Shared<const ResolvedModel<D>>::make(std::move(materials), options)) {}

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::advance_density(State& state, const Lists& lists, Halo<D>& halo,
                                                 double dt) {
    fluid_count_ = lists.moving();
    if (steps_since_depths_ == 0 && model_->options.flow.turbulence == Turbulence::mixing_length)
        set_mixing_lengths(state, lists, halo.ranks);
    make_room(state, halo);
    pack<ContinuityPacker>(state, 0.5 * dt);
    if (model_->options.flow.wide_kernel)
        sum_densities<WendlandC6<D>>(state, lists, halo, dt);
    else
        sum_densities<WendlandC2<D>>(state, lists, halo, dt);
}

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::evaluate(State& state, const Lists& lists, Halo<D>& halo,
                                          double half_dt, bool) {
    pack<ForcePacker>(state, half_dt);
    if (model_->options.flow.wide_kernel)
        sum_forces<WendlandC6<D>>(state, lists, halo, 2.0 * half_dt);
    else
        sum_forces<WendlandC2<D>>(state, lists, halo, 2.0 * half_dt);
    reduce_summaries();
    const std::int64_t left = is_poisoned_run() ? survivor<double>(state.acceleration) : -1;
    if (left >= 0) fault_.note(Fault::right_hand_side, static_cast<std::size_t>(left));
    fault_ = traced_to_its_source(fault_, state, model_->materials);
    agree(halo.ranks, timestep_, limiting_, fault_);
}

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::sum_walls_alone(State& state, const Lists& lists, Halo<D>& halo,
                                                 double inertia) {
    constexpr double no_time = 0.0;
    const ContinuityPacker<real, D> packer{{*model_, state, motion_, fluid_, wall_, fluid_count_,
                                            frame_, records(state).inverse_support, no_time}};
    Backend::for_each_particle(state.size() - fluid_count_,
                               PackWall<ContinuityPacker<real, D>>{packer});
    halo.start({halo_column(wall_, HaloColumn::fixed, fluid_count_)});
    halo.finish();
    const WallEpilogue<real, D> epilogue(*model_, wall_, fluid_count_, summary_, state, no_time,
                                         inertia);
    if (model_->options.flow.wide_kernel)
        sum_walls<WendlandC6<D>>(state, lists, records(state), epilogue);
    else
        sum_walls<WendlandC2<D>>(state, lists, records(state), epilogue);
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
    const ColumnsOfPlan<D> plan{lists.domain(), Upwards<D>(model_->options.gravity), 4.0 * flow.dp};
    auto z0 = [&](std::size_t p) { return model_->wall_condition(state.tag[p]).ks / 30.0; };
    const FlowDepth<D> depth(state, fluid_count_, plan, z0, ranks);
    const double min_length = flow.smagorinsky * flow.dp;
    for_each_particle(fluid_count_, [&](std::size_t p) {
        state.mixing_length[p] = depth.mixing_length(state.position[p], min_length);
    });
}

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::make_room(const State& state, const Halo<D>& halo) {
    const std::size_t n = state.size(), ghosts = halo.ghosts(), moving = halo.moving_ghosts();
    frame_ = common_frame<real, D>(state.position, halo.ranks);
    motion_.resize(n + ghosts), wall_.resize(n - fluid_count_ + ghosts);
    fluid_.resize(moving > 0 ? n + moving : fluid_count_);
    summary_.resize(Backend::summaries((n + Backend::width - 1) / Backend::width));
    Backend::for_each_particle(summary_.size(), ClearElement<FlowSummary<D>>{summary_});
    if (is_poisoned_run()) poison<real>(motion_), poison<real>(fluid_), poison<real>(wall_);
}

/// Fills the records.
template <int D, class real, class Backend>
template <template <class, int> class Packer>
void Resolved<D, real, Backend>::pack(State& state, double half_dt) {
    const auto timing = phases_.measure(Phase::pack);
    Backend::for_each_particle(
        fluid_count_, state.size(),
        Packer<real, D>{{*model_, state, motion_, fluid_, wall_, fluid_count_, frame_,
                         records(state).inverse_support, half_dt}});
}

template <int D, class real, class Backend>
template <class Kernel>
void Resolved<D, real, Backend>::sum_densities(State& state, const Lists& lists, Halo<D>& halo,
                                               double dt) {
    halo.start({halo_column(motion_), halo_column(fluid_, HaloColumn::moving),
                halo_column(wall_, HaloColumn::fixed, fluid_count_)});
    const ContinuityTerm<Kernel, real, D> term{records(state), model_->constants};
    const ContinuityEpilogue<real, D> advance(*model_, fluid_, fluid_count_, summary_, state, dt);
    sum_fluid(Phase::continuity, lists, halo, term, advance);
}

/// On many ranks the fluid's pairs are summed while records of ghosts, or the friction of their
/// beds, come.
template <int D, class real, class Backend>
template <class Kernel>
void Resolved<D, real, Backend>::sum_forces(State& state, const Lists& lists, Halo<D>& halo,
                                            double dt) {
    halo.start({halo_column(motion_), halo_column(fluid_, HaloColumn::moving)});
    const FlowRecords<real, D> records = this->records(state);
    const ForceTerm<Kernel, real, D> forces{records, model_->constants};
    const ForceEpilogue<real, D> accelerate(*model_, fluid_, fluid_count_, summary_, state, dt);
    const WallEpilogue<real, D> of_walls(*model_, wall_, fluid_count_, summary_, state, dt);
    const bool friction = model_->has_bed_friction();
    if (friction || halo.alone()) {
        halo.finish();
        sum_walls<Kernel>(state, lists, records, of_walls);
        if (friction)
            halo.start({halo_column(wall_, &WallRecord<real, D>::traction, HaloColumn::fixed,
                                    fluid_count_)});
        sum_fluid(Phase::pass_2, lists, halo, forces, accelerate);
    } else {
        sum_fluid(Phase::pass_2, lists, halo, forces, accelerate);
        sum_walls<Kernel>(state, lists, records, of_walls);
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
                                           const FlowRecords<real, D>& records,
                                           const WallEpilogue<real, D>& epilogue) {
    const auto timing = phases_.measure(Phase::pass_1);
    if (!has_wet_walls(records)) {
        std::ranges::fill(state.wall.force.stored(), Vec<double, D>{});
        std::ranges::fill(state.wall.moment.stored(), Turn<double, D>{});
        return;
    }
    const std::size_t first = fluid_count_ / Backend::width;
    Backend::sum_pairs(
        lists, {lists.clusters().subspan(first), motion_, frame_, {.first_cluster = first}},
        WallTerm<Kernel, real, D>{records, model_->constants, model_->options.gravity}, epilogue);
}

/// Keeps the sums of wall particles for a face; those of others in their clusters mean nothing.
template <int D>
struct KeepPush {
    std::size_t first_wall;
    std::span<FacePush<D>> pushes;

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const FaceAccumulators<double, D>& sums) const {
        if (p >= first_wall) pushes[p - first_wall] = {sums.all, sums.front, sums.lever};
    }
};

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::push_on(const State& state, const Lists& lists,
                                         const FacePlane<D>& face,
                                         std::span<const std::uint32_t> walls,
                                         Array<FacePush<D>>& pushes) {
    face_depth_.resize(state.size() - fluid_count_), face_push_.resize(face_depth_.size());
    Array<std::uint32_t> clusters;
    for (const std::uint32_t p : walls) {
        face_depth_[p - fluid_count_].below = static_cast<real>(face.depth(state.position[p]));
        const std::uint32_t cluster = p / static_cast<std::uint32_t>(Backend::width);
        if (clusters.empty() || clusters.back() != cluster) clusters.push_back(cluster);
    }
    if (clusters.empty()) return pushes.clear();
    if (model_->options.flow.wide_kernel)
        sum_face<WendlandC6<D>>(state, lists, face, clusters);
    else
        sum_face<WendlandC2<D>>(state, lists, face, clusters);
    pushes.clear();
    for (const std::uint32_t p : walls) pushes.push_back(face_push_[p - fluid_count_]);
}

template <int D, class real, class Backend>
template <class Kernel>
void Resolved<D, real, Backend>::sum_face(const State& state, const Lists& lists,
                                          const FacePlane<D>& face,
                                          const Array<std::uint32_t>& clusters) {
    const auto timing = phases_.measure(Phase::pass_1);
    Backend::sum_pairs(
        lists, {lists.clusters(), motion_, frame_, {.only = &clusters}},
        FaceTerm<Kernel, real, D>{records(state), model_->constants, face.normal, face_depth_},
        KeepPush<D>{fluid_count_, face_push_});
}

template <int D, class real, class Backend>
template <class Term, class Epilogue>
void Resolved<D, real, Backend>::sum_fluid(Phase phase, const Lists& lists, Halo<D>& halo,
                                           const Term& term, const Epilogue& epilogue) {
    const std::size_t clusters = (fluid_count_ + Backend::width - 1) / Backend::width;
    while_ghosts_come(halo, lists, lists.clusters().first(clusters), Backend::width,
                      [&](std::span<const typename Lists::List> part, std::size_t first) {
                          const auto timing = phases_.measure(phase);
                          Backend::sum_pairs(lists,
                                             {part, motion_, frame_, {.first_cluster = first}},
                                             term, epilogue);
                      });
}

template <int D, class real, class Backend>
void Resolved<D, real, Backend>::reduce_summaries() {
    // What enters next may be the first fluid there is.
    const Options<D>& options = model_->options;
    FlowSummary<D> total;
    total.timestep = options.cflnumber * options.eta * options.flow.dp / model_->constants.c;
    total.add(Backend::reduce(summary_.size(), FlowSummary<D>{}, joined,
                              ElementOf<FlowSummary<D>>{summary_}));
    timestep_ = total.timestep, limiting_ = total.limiting;
    power_ = total.power, work_ = total.work, fault_ = total.fault;
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
    return {model_->without_surface_tension(at.pressure, state, p), material.c0, at.bulk_energy};
}

/// Of viscosity and eddies.
template <int D, class real, class Backend>
Deviator<double, D> Resolved<D, real, Backend>::deviator(const State& state, std::size_t p) const {
    if (state.is_wall(p)) return {};
    return viscous_stress(state.velocity_gradient[p], model_->viscosity(state, p));
}

template <int D, class real, class Backend>
double Resolved<D, real, Backend>::kernel_support() const {
    return model_->kernel_support();
}

template <int D, class real, class Backend>
const PairArea& Resolved<D, real, Backend>::pair_area() const {
    return model_->pair_area;
}

template <int D, class real, class Backend>
const Array<Material>& Resolved<D, real, Backend>::materials() const {
    return model_->materials;
}

}  // namespace doseki
