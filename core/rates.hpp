#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "fault.hpp"
#include "halo.hpp"
#include "material.hpp"
#include "neighbours.hpp"
#include "options.hpp"
#include "particles.hpp"
#include "phase_timer.hpp"
#include "physics/equation_of_state.hpp"
#include "physics/stress.hpp"
#include "physics/timestep.hpp"
#include "physics/yield.hpp"
#include "poison.hpp"
#include "terms.hpp"

namespace doseki {

template <class real, int D>
class PairProbe;

/// Where a solid yields.
template <int D>
YieldSurface<double> yield_surface(const Material& material) {
    if (material.law != Law::solid) return unyielding();
    if (material.yield_strength > 0.0) return von_mises(material.yield_strength);
    if (material.cohesion > 0.0 || material.friction_angle > 0.0)
        return drucker_prager<D>(material.cohesion, material.friction_angle);
    return unyielding();
}

/// Pressure and sound speed of a particle as its scheme sees them: Eqs. (8), (17) and the rule on
/// tension.
struct Thermodynamics {
    double pressure, sound_speed, bulk_energy;
};

inline Thermodynamics equation_of_state(const Material& material, double rho, Motion motion,
                                        Tension tension) {
    const auto eos = BirchMurnaghan<double>::at(rho, material.rho0, material.c0);
    const bool clamped = motion == Motion::fixed || tension == Tension::clamp_all ||
                         (tension == Tension::clamp_fluid && material.law == Law::fluid);
    return {clamped ? max(0.0, eos.pressure) : eos.pressure, eos.sound_speed, eos.bulk_energy};
}

/// Eq. (11), drho/dt = -rho div v. Driven particles bring their density along; voids do not expand.
template <int D>
double density_rate(const Material& material, Motion motion, double rho, const Mat<double, D>& L) {
    if (motion == Motion::driven) return 0.0;
    const double rate = -rho * trace(L);
    return rho < void_ratio * material.rho0 ? max(0.0, rate) : rate;
}

/// The right-hand side: density, stress and velocity rates of all particles.
template <class real, int D>
class Rates {
public:
    using Real = real;
    static constexpr int dim = D;
    static constexpr bool has_flow = false;

    Rates(std::vector<Material> materials, const Options<D>& options, bool periodic)
        : materials_(std::move(materials)), options_(options), periodic_(periodic) {
        for (const Material& material : materials_) {
            surfaces_.push_back(yield_surface<D>(material));
            yields_ |= std::isfinite(surfaces_.back().k);
        }
    }

    /// Fills the rates of `particles`, whose density, stress and velocity are half a step behind:
    /// the values predicted with the old rates over `half_dt` are what enters the sums. Two passes
    /// over pairs with the stress of each particle between them. Sets timestep() and av_power().
    /// `new_lists`: neighbours were built since the last call. Where they were not, a particle of
    /// the bed that nothing comes near has the rates it had: none.
    void compute(Particles<D>& particles, const Neighbours<D>& neighbours, Halo<D>& halo,
                 double half_dt, bool new_lists) {
        const bool poisoned = is_poisoned_run();
        skip_empty_ = !new_lists && !poisoned;
        if (poisoned) poison<real>(motion_);
        pack_motion(particles, halo, half_dt);
        if (new_lists && !halo.alone()) agree_on_h(particles, halo.ranks);
        stress_.resize(particles.size() + halo.ghosts());
        summary_.assign(neighbours.clusters().size(), {});
        if (poisoned) poison<real>(stress_), poison<double>(particles.acceleration);
        halo.start({halo_column(motion_)});
        sum_velocity_gradient(particles, neighbours, halo, half_dt);
        halo.start({halo_column(stress_)});
        sum_momentum(particles, neighbours, halo);
        reduce_summaries();
        if (poisoned) find_survivor(particles);
        fault_ = traced_to_its_source(fault_, particles, materials_);
        agree(halo.ranks, timestep_, limiting_, fault_);
    }

    static constexpr double kernel_support() { return WendlandC6<D>::support; }
    Thermodynamics thermodynamics(const Particles<D>& particles, std::size_t p) const {
        const Tag& tag = particles.tag[p];
        return thermodynamics(tag, particles.density[p]);
    }
    /// Eq. (63) for every particle, at the end of a step.
    void yield(Particles<D>& particles) const {
        if (!yields_ || !particles.has_strength) return;
#pragma omp parallel for schedule(static) if (particles.size() > light_loop)
        for (std::size_t p = 0; p < particles.size(); ++p) {
            const YieldSurface<double>& surface =
                surfaces_[static_cast<std::size_t>(particles.tag[p].material)];
            if (particles.is_free(p) && std::isfinite(surface.k))
                particles.deviatoric_stress[p] = return_map(
                    particles.deviatoric_stress[p], thermodynamics(particles, p).pressure, surface);
        }
    }
    double timestep() const { return timestep_; }
    /// Of the particles of this rank.
    double av_power() const { return av_power_; }
    PhaseTimer& phases() { return phases_; }
    /// The particle to blame where a density is absurd or rates are not finite.
    const Fault& fault() const { return fault_; }
    /// The particle that allows the shortest timestep, or -1.
    std::int64_t limiting_particle() const { return limiting_; }
    const std::vector<Material>& materials() const { return materials_; }
    const std::vector<StressRecord<real, D>>& stress_records() const { return stress_; }

    /// Deviatoric part of the stress of particle p: S of a solid, tau of a fluid (as last summed).
    Deviator<double, D> deviator(const Particles<D>& particles, std::size_t p) const {
        Deviator<double, D> tau = particles.stress(p);
        const Tag& tag = particles.tag[p];
        if (materials_[tag.material].law == Law::solid || tag.motion != Motion::free ||
            stress_.size() <= p)
            return tau;
        const StressRecord<real, D>& record = stress_[p];
        const double rho = static_cast<double>(record.rho);
        const auto eos = thermodynamics(tag, rho);
        for (int a = 0; a < D; ++a)
            for (int b = a; b < D; ++b)
                if (a < 2 || b < 2)
                    tau.element[Deviator<double, D>::index(a, b)] =
                        rho * rho * static_cast<double>(record.stress[Sym<real, D>::index(a, b)]) +
                        (a == b ? eos.pressure : 0.0);
        return tau;
    }
    /// Stress records are kept from step to step where nothing is near (see compute).
    template <class Archive>
    void serialise(Archive& archive) {
        archive("stress_record", stress_), archive("next_timestep", timestep_),
            archive("av_power", av_power_);
    }

    std::size_t bytes() const {
        return motion_.capacity() * sizeof(MotionRecord<real, D>) +
               stress_.capacity() * sizeof(StressRecord<real, D>) +
               summary_.capacity() * sizeof(ClusterSummary);
    }

private:
    friend class PairProbe<real, D>;
    template <class, class>
    friend class PairCounter;

    /// What a cluster adds to the step's totals, reduced in the order of clusters.
    struct ClusterSummary {
        double timestep = std::numeric_limits<double>::max();
        double av_power = 0.0;
        Fault fault;
        std::int64_t limiting = -1;
    };

    /// With the tension cut of what yields, Eq. (62).
    Thermodynamics thermodynamics(const Tag& tag, double rho) const {
        auto state = equation_of_state(materials_[tag.material], rho, tag.motion, options_.tension);
        state.pressure = tension_cut(surfaces_[tag.material], state.pressure);
        return state;
    }
    void pack_motion(Particles<D>& particles, const Halo<D>& halo, double half_dt);
    void agree_on_h(const Particles<D>& particles, const Ranks& ranks);
    double smoothing_length(const Particles<D>& particles, std::size_t p, double rho) const;
    void update_particle(Particles<D>& particles, std::size_t p, Mat<double, D> L, double half_dt);
    void sum_velocity_gradient(Particles<D>& particles, const Neighbours<D>& neighbours,
                               Halo<D>& halo, double half_dt);
    void sum_momentum(Particles<D>& particles, const Neighbours<D>& neighbours, Halo<D>& halo);
    void reduce_summaries();
    void find_survivor(Particles<D>& particles);

    template <class Term>
    void sum_over_pairs(Phase phase, const Neighbours<D>& neighbours,
                        std::span<const ClusterList> clusters, Halo<D>& halo, const Term& term) {
        const std::span<const MotionRecord<real, D>> records(motion_);
        while_ghosts_come(halo, neighbours, clusters, lanes<real>,
                          [&](std::span<const ClusterList> part, std::size_t first) {
                              const auto timing = phases_.measure(phase);
                              if (periodic_)
                                  for_each_pair<true>(neighbours, part, records, frame_,
                                                      skip_empty_, term, first);
                              else
                                  for_each_pair<false>(neighbours, part, records, frame_,
                                                       skip_empty_, term, first);
                          });
    }

    template <class Term>
    auto timed(const Term& term) {
        return TimedFinish<Term, lanes<real>>{term, phases_};
    }

    std::vector<Material> materials_;
    std::vector<YieldSurface<double>> surfaces_;  // by material
    bool yields_ = false;                         // any of them
    Options<D> options_;
    bool periodic_;
    bool equal_h_ = true;
    bool skip_empty_ = false;
    CoordinateFrame<real, D> frame_;
    std::vector<MotionRecord<real, D>> motion_;
    std::vector<StressRecord<real, D>> stress_;
    std::vector<ClusterSummary> summary_;
    PhaseTimer phases_;
    double timestep_ = 0.0;
    double av_power_ = 0.0;
    Fault fault_;
    std::int64_t limiting_ = -1;
};

/// Eq. (10), held within a quarter of its value at rest (a solid in tension would grow h for ever).
template <class real, int D>
double Rates<real, D>::smoothing_length(const Particles<D>& particles, std::size_t p,
                                        double rho) const {
    if (options_.h_mode == SmoothingLengthMode::constant) return particles.smoothing_length[p];
    const double mass = particles.mass[p];
    const double rest =
        options_.eta * std::pow(mass / materials_[particles.tag[p].material].rho0, 1.0 / D);
    return std::clamp(options_.eta * std::pow(mass / rho, 1.0 / D), 0.8 * rest, 1.25 * rest);
}

template <class real, int D>
void Rates<real, D>::pack_motion(Particles<D>& particles, const Halo<D>& halo, double half_dt) {
    const auto timing = phases_.measure(Phase::pack);
    const std::size_t n = particles.size();
    motion_.resize(n + halo.ghosts());
    if constexpr (std::is_same_v<real, float>) {
        std::array<double, 2 * D> far;  // -low, high
        far.fill(-std::numeric_limits<double>::max());
        for (const auto& x : particles.position)
            for (int a = 0; a < D; ++a)
                far[a] = max(far[a], -x[a]), far[D + a] = max(far[D + a], x[a]);
        halo.ranks.largest(far);
        Vec<double, D> low, high;
        for (int a = 0; a < D; ++a) low[a] = -far[a], high[a] = far[D + a];
        frame_ = CoordinateFrame<real, D>::covering(low, high);
    }
    const double h0 = n > 0 ? particles.smoothing_length[0] : 0.0;
    bool equal = options_.h_mode == SmoothingLengthMode::constant;
#pragma omp parallel for schedule(static) reduction(&& : equal) if (n > light_loop)
    for (std::size_t p = 0; p < n; ++p) {
        MotionRecord<real, D>& record = motion_[p];
        for (int a = 0; a < D; ++a) {
            record.x[a] = frame_.coordinate(particles.position[p][a], a);
            record.v[a] = static_cast<real>(particles.velocity[p][a] +
                                            half_dt * particles.acceleration[p][a]);
        }
        const double rho = particles.density[p] + half_dt * particles.density_rate[p];
        const double h = smoothing_length(particles, p, rho);
        particles.smoothing_length[p] = h;
        record.mass = static_cast<real>(particles.mass[p]);
        record.inverse_support = static_cast<real>(1.0 / (WendlandC6<D>::support * h));
        equal = equal && h == h0;
    }
    if (halo.alone()) equal_h_ = equal;
}

/// Whether h is the same on all ranks, which it is for as long as no particle comes.
template <class real, int D>
void Rates<real, D>::agree_on_h(const Particles<D>& particles, const Ranks& ranks) {
    std::array<double, 2> far{-std::numeric_limits<double>::max(),
                              -std::numeric_limits<double>::max()};
    for (const double h : particles.smoothing_length) far = {max(far[0], h), max(far[1], -h)};
    ranks.largest(far);
    equal_h_ = options_.h_mode == SmoothingLengthMode::constant && far[0] == -far[1];
}

/// Between the passes: Eqs. (11), (8), (4) or (7) and Balsara's switch of one particle.
template <class real, int D>
void Rates<real, D>::update_particle(Particles<D>& particles, std::size_t p, Mat<double, D> L,
                                     double half_dt) {
    const Tag& tag = particles.tag[p];
    const Material& material = materials_[tag.material];
    const double rho = particles.density[p] + half_dt * particles.density_rate[p];
    for (double& element : L.element) element /= rho;

    const auto eos = thermodynamics(tag, rho);
    summary_[p / lanes<real>].fault.note_density(rho, material.rho0, p);
    Deviator<double, D> stress{}, rate{};
    if (tag.motion == Motion::free) {
        if (material.law == Law::fluid) {
            stress = newtonian_stress(L, rho, material.nu);
        } else if (material.shear_modulus > 0.0) {
            stress = particles.deviatoric_stress[p];
            add_scaled(stress, half_dt, particles.deviatoric_stress_rate[p]);
            if (yields_) stress = return_map(stress, eos.pressure, surfaces_[tag.material]);
            rate = elastic_stress_rate(L, stress, material.shear_modulus);
        }
    }
    particles.density_rate[p] = density_rate(material, tag.motion, rho, L);
    if (particles.has_strength) particles.deviatoric_stress_rate[p] = rate;

    const auto scaled = stress_over_rho_squared(eos.pressure, stress, rho);
    StressRecord<real, D>& record = stress_[p];
    for (int k = 0; k < Sym<real, D>::size; ++k)
        record.stress[k] = static_cast<real>(scaled.element[k]);
    record.rho = static_cast<real>(rho);
    record.c = static_cast<real>(eos.sound_speed);
    record.balsara = static_cast<real>(
        options_.balsara ? balsara_switch(L, eos.sound_speed, particles.smoothing_length[p]) : 1.0);
}

template <class real, int D>
void Rates<real, D>::sum_velocity_gradient(Particles<D>& particles, const Neighbours<D>& neighbours,
                                           Halo<D>& halo, double half_dt) {
    auto update = [&](std::size_t p, const Mat<double, D>& gradient) {
        update_particle(particles, p, gradient, half_dt);
    };
    const std::span<const MotionRecord<real, D>> motion(motion_);
    using Update = decltype(update);
    if (options_.sym_grad && !equal_h_)
        sum_over_pairs(
            Phase::pass_1, neighbours, neighbours.clusters(), halo,
            timed(VelocityGradientTerm<GradientOf::mean_h, real, D, Update>{motion, update}));
    else
        sum_over_pairs(
            Phase::pass_1, neighbours, neighbours.clusters(), halo,
            timed(VelocityGradientTerm<GradientOf::own_h, real, D, Update>{motion, update}));
}

template <class real, int D>
void Rates<real, D>::sum_momentum(Particles<D>& particles, const Neighbours<D>& neighbours,
                                  Halo<D>& halo) {
    constexpr std::size_t width = lanes<real>;
    const auto clusters = neighbours.clusters().first((neighbours.moving() + width - 1) / width);
    std::fill(particles.acceleration.begin() + static_cast<std::ptrdiff_t>(neighbours.moving()),
              particles.acceleration.end(), Vec<double, D>{});

    auto finish = [&](std::size_t p, const auto& sums) {
        if (!particles.is_free(p)) {
            particles.acceleration[p] = {};
            return;
        }
        const Vec<double, D> a = sums.acceleration + options_.gravity;
        particles.acceleration[p] = a;
        const double v_sig = max(sums.max_v_sig, 2.0 * static_cast<double>(stress_[p].c));
        ClusterSummary& summary = summary_[p / width];
        summary.av_power += particles.mass[p] * sums.av_power;
        const double dt = doseki::timestep(particles.smoothing_length[p], v_sig, sqrt(dot(a, a)),
                                           options_.cflnumber, options_.cfl_force);
        if (dt < summary.timestep)
            summary.timestep = dt, summary.limiting = static_cast<std::int64_t>(p);
        summary.fault.note_rates(dot(a, a) + particles.density_rate[p], p);
    };
    const std::span<const MotionRecord<real, D>> motion(motion_);
    const std::span<const StressRecord<real, D>> stress(stress_);
    const MomentumOptions<real> constants{static_cast<real>(options_.alpha),
                                          options_.fixed_limits_dt};
    using Finish = decltype(finish);
    if (equal_h_)
        sum_over_pairs(
            Phase::pass_2, neighbours, clusters, halo,
            MomentumTerm<GradientOf::own_h, real, D, Finish>{motion, stress, constants, finish});
    else
        sum_over_pairs(
            Phase::pass_2, neighbours, clusters, halo,
            MomentumTerm<GradientOf::mean_h, real, D, Finish>{motion, stress, constants, finish});
}

template <class real, int D>
void Rates<real, D>::reduce_summaries() {
    timestep_ = std::numeric_limits<double>::max();
    av_power_ = 0.0;
    fault_ = {}, limiting_ = -1;
    for (const ClusterSummary& summary : summary_) {
        if (summary.timestep < timestep_)
            timestep_ = summary.timestep, limiting_ = summary.limiting;
        av_power_ += summary.av_power;
        fault_.merge(summary.fault);
    }
}

/// In float, coordinates are whole numbers, which may look like NaN: only double motion is looked
/// at.
template <class real, int D>
void Rates<real, D>::find_survivor(Particles<D>& particles) {
    const std::int64_t motion = std::is_same_v<real, double> ? survivor<real>(motion_) : -1;
    for (const std::int64_t p :
         {motion, survivor<real>(stress_), survivor<double>(particles.acceleration)})
        if (p >= 0) fault_.note(Fault::rates, static_cast<std::size_t>(p));
}

}  // namespace doseki
