#pragma once
// How the ueta2022 scheme evaluates its right-hand side.

#include <cmath>

#include "base/array.hpp"
#include "base/poison.hpp"
#include "ranks/common_frame.hpp"
#include "ueta2022/epilogues.hpp"
#include "ueta2022/force_terms.hpp"
#include "ueta2022/interactions.hpp"
#include "ueta2022/model.hpp"
#include "ueta2022/right_hand_side.hpp"

namespace doseki {

template <int D, class real, class Backend>
Ueta2022<D, real, Backend>::Ueta2022(Array<Material> materials, const Options<D>& options)
    : model_(Shared<const Ueta2022Model<D>>::make(std::move(materials), options)) {}

template <int D, class real, class Backend>
void Ueta2022<D, real, Backend>::evaluate(State& particles, const Lists& lists, Halo<D>& halo,
                                          double half_dt, bool new_lists) {
    const bool poisoned = is_poisoned_run();
    skip_empty_ = !new_lists && !poisoned;
    if (poisoned) poison<real>(motion_);
    pack_motion(particles, halo, half_dt);
    if (new_lists && !halo.alone()) agree_on_h(particles, halo.ranks);
    stress_.resize(particles.size() + halo.ghosts());
    summary_.resize(Backend::summaries(lists.clusters().size()));
    Backend::for_each_particle(summary_.size(), ClearElement<StepSummary>{summary_});
    if (poisoned) poison<real>(stress_), poison<double>(particles.acceleration);
    halo.start({halo_column(motion_)});
    sum_velocity_gradient(particles, lists, halo, half_dt);
    halo.start({halo_column(stress_)});
    sum_momentum(particles, lists, halo);
    reduce_summaries();
    if (poisoned) find_survivor(particles);
    fault_ = traced_to_its_source(fault_, particles, model_->materials);
    agree(halo.ranks, timestep_, limiting_, fault_);
}

template <int D, class real, class Backend>
void Ueta2022<D, real, Backend>::pack_motion(State& particles, const Halo<D>& halo,
                                             double half_dt) {
    const auto timing = phases_.measure(Phase::pack);
    const std::size_t n = particles.size();
    motion_.resize(n + halo.ghosts());
    frame_ = common_frame<real, D>(particles.position, halo.ranks);
    const double h0 = n > 0 ? particles.smoothing_length[0] : 0.0;
    const bool equal =
        Backend::reduce(n, true, std::logical_and{},
                        MotionPacker<real, D>{*model_, particles, motion_, frame_, half_dt, h0});
    if (halo.alone()) equal_h_ = model_->options.h_mode == SmoothingLengthMode::constant && equal;
}

/// Whether h is the same on all ranks, which it is for as long as no particle comes.
template <int D, class real, class Backend>
void Ueta2022<D, real, Backend>::agree_on_h(const State& particles, const Ranks& ranks) {
    std::array<double, 2> far{-std::numeric_limits<double>::max(),
                              -std::numeric_limits<double>::max()};
    for (const double h : particles.smoothing_length) far = {max(far[0], h), max(far[1], -h)};
    ranks.largest(far);
    equal_h_ = model_->options.h_mode == SmoothingLengthMode::constant && far[0] == -far[1];
}

template <int D, class real, class Backend>
void Ueta2022<D, real, Backend>::sum_velocity_gradient(State& particles, const Lists& lists,
                                                       Halo<D>& halo, double half_dt) {
    const StressEpilogue<real, D> update{*model_, particles, stress_, summary_, half_dt};
    const std::span<const MotionRecord<real, D>> motion(motion_);
    auto sum = [&](const auto& term) {
        sum_pairs(Phase::pass_1, lists, lists.clusters(), halo, term, update);
    };
    if (model_->options.sym_grad && !equal_h_)
        sum(VelocityGradientTerm<GradientOf::mean_h, real, D>{motion});
    else
        sum(VelocityGradientTerm<GradientOf::own_h, real, D>{motion});
}

template <int D, class real, class Backend>
void Ueta2022<D, real, Backend>::sum_momentum(State& particles, const Lists& lists, Halo<D>& halo) {
    constexpr std::size_t width = Backend::width;
    const auto clusters = lists.clusters().first((lists.moving() + width - 1) / width);
    const auto of_walls = std::span(particles.acceleration).subspan(lists.moving());
    Backend::for_each_particle(of_walls.size(), ClearElement<Vec<double, D>>{of_walls});

    const MomentumEpilogue<real, D> accelerate{*model_, particles, stress_, summary_};
    const std::span<const MotionRecord<real, D>> motion(motion_);
    const std::span<const StressRecord<real, D>> stress(stress_);
    const MomentumOptions<real> constants{static_cast<real>(model_->options.alpha),
                                          model_->options.fixed_limits_dt};
    auto sum = [&](const auto& term) {
        sum_pairs(Phase::pass_2, lists, clusters, halo, term, accelerate);
    };
    if (equal_h_)
        sum(MomentumTerm<GradientOf::own_h, real, D>{motion, stress, constants});
    else
        sum(MomentumTerm<GradientOf::mean_h, real, D>{motion, stress, constants});
}

template <int D, class real, class Backend>
void Ueta2022<D, real, Backend>::reduce_summaries() {
    const auto total =
        Backend::reduce(summary_.size(), StepSummary{}, joined, ElementOf<StepSummary>{summary_});
    timestep_ = total.timestep, limiting_ = total.limiting;
    av_power_ = total.power, fault_ = total.fault;
}

/// In float, coordinates are whole numbers, which may look like NaN: only double motion is looked
/// at.
template <int D, class real, class Backend>
void Ueta2022<D, real, Backend>::find_survivor(State& particles) {
    const std::int64_t motion = std::is_same_v<real, double> ? survivor<real>(motion_) : -1;
    for (const std::int64_t p :
         {motion, survivor<real>(stress_), survivor<double>(particles.acceleration)})
        if (p >= 0) fault_.note(Fault::right_hand_side, static_cast<std::size_t>(p));
}

/// Sums over the clusters, those without ghosts in their lists while the ghosts' records come.
template <int D, class real, class Backend>
template <class Term, class Epilogue>
void Ueta2022<D, real, Backend>::sum_pairs(Phase phase, const Lists& lists,
                                           std::span<const typename Lists::List> clusters,
                                           Halo<D>& halo, const Term& term,
                                           const Epilogue& epilogue) {
    PhaseTimer* const sampled = phase == Phase::pass_1 ? &phases_ : nullptr;
    while_ghosts_come(halo, lists, clusters, Backend::width,
                      [&](std::span<const typename Lists::List> part, std::size_t first) {
                          const auto timing = phases_.measure(phase);
                          Backend::sum_pairs(lists,
                                             {part, motion_, frame_, {skip_empty_, first, sampled}},
                                             term, epilogue);
                      });
}

template <int D, class real, class Backend>
void Ueta2022<D, real, Backend>::end_step(State& particles) const {
    if (!model_->yields || !particles.has_strength) return;
    Backend::for_each_particle(particles.size(), StressReturn<D>{*model_, particles});
}

template <int D, class real, class Backend>
ForceTerms<D> Ueta2022<D, real, Backend>::force_terms(const State& particles, const Lists& lists,
                                                      Halo<D>& halo, std::int64_t p) const {
    Field<StressRecord<real, D>> pressure = stress_;
    Backend::for_each_particle(particles.size(),
                               IsotropicStress<real, D>{*model_, particles, stress_, pressure});
    halo.start({halo_column(pressure)});
    halo.finish();
    if (p < 0 || !particles.is_free(static_cast<std::size_t>(p))) return {};
    const MomentumPass<D, real, Backend> pass{lists, motion_, frame_, model_->options};
    const auto k = static_cast<std::size_t>(p);
    return doseki::force_terms<D, real, Backend>(pass, stress_, pressure, k,
                                                 particles.smoothing_length[k]);
}

template <int D, class real, class Backend>
double Ueta2022<D, real, Backend>::kernel_support() const {
    return WendlandC6<D>::support;
}

template <int D, class real, class Backend>
ThermodynamicState<double> Ueta2022<D, real, Backend>::equation_of_state(const State& particles,
                                                                         std::size_t p) const {
    return model_->equation_of_state(particles.tag[p], particles.density[p]);
}

template <int D, class real, class Backend>
double Ueta2022<D, real, Backend>::shear_energy(const State& particles, std::size_t p) const {
    const Material& material = model_->materials[particles.tag[p].material];
    if (!particles.has_strength || !(material.shear_modulus > 0.0)) return 0.0;
    return particles.mass[p] * doseki::shear_energy(particles.deviatoric_stress[p],
                                                    material.shear_modulus, particles.density[p]);
}

template <int D, class real, class Backend>
Deviator<double, D> Ueta2022<D, real, Backend>::deviator(const State& particles,
                                                         std::size_t p) const {
    Deviator<double, D> tau = particles.stress(p);
    const Tag& tag = particles.tag[p];
    if (model_->materials[tag.material].law == Law::solid || tag.motion != Motion::free ||
        stress_.size() <= p)
        return tau;
    const StressRecord<real, D>& record = stress_[p];
    const double rho = static_cast<double>(record.rho);
    const auto eos = model_->equation_of_state(tag, rho);
    for (int a = 0; a < D; ++a)
        for (int b = a; b < D; ++b)
            if (a < 2 || b < 2)
                tau.element[Deviator<double, D>::index(a, b)] =
                    rho * rho * static_cast<double>(record.stress(a, b)) +
                    (a == b ? eos.pressure : 0.0);
    return tau;
}

template <int D, class real, class Backend>
const Array<Material>& Ueta2022<D, real, Backend>::materials() const {
    return model_->materials;
}

template <int D, class real, class Backend>
const Options<D>& Ueta2022<D, real, Backend>::options() const {
    return model_->options;
}

}  // namespace doseki
