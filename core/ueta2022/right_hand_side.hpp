#pragma once
#include <cstdint>
#include <limits>
#include <span>

#include "base/array.hpp"
#include "base/phase_timer.hpp"
#include "cells/list_wear.hpp"
#include "device/backend_of_build.hpp"
#include "model/fault.hpp"
#include "model/force_terms.hpp"
#include "model/material.hpp"
#include "model/options.hpp"
#include "model/scheme_work.hpp"
#include "model/step_summary.hpp"
#include "physics/equation_of_state/thermodynamic_state.hpp"
#include "physics/wall.hpp"
#include "ranks/balance.hpp"
#include "ranks/halo.hpp"
#include "ueta2022/records.hpp"
#include "ueta2022/state.hpp"

namespace doseki {

template <int D>
struct Ueta2022Model;

/// Right-hand side of the scheme of Ueta et al. (2022): rates of density, stress and velocity of
/// all particles, from two sums over pairs. How it is evaluated is in ueta2022/evaluate.hpp, which
/// a unit of its own compiles: who steps a run need not see the physics.
template <int D, class real, class BackendOf = BackendOfBuild<real>>
class Ueta2022 {
public:
    using Real = real;
    using Backend = BackendOf;
    using Lists = typename Backend::template Lists<D>;
    using State = Ueta2022State<D>;
    static constexpr int dim = D;
    /// Nothing that a sum reads was left by the one before.
    static constexpr int first_evaluations = 1;
    static constexpr bool looks_back = false;
    static constexpr SkinCosts skin_costs =
        D == 2 ? SkinCosts{0.7, 1.6, 0.3} : SkinCosts{1.0, 2.6, 0.3};

    Ueta2022(Array<Material> materials, const Options<D>& options);

    /// Fills the rates of `particles`, whose density, stress and velocity are half a step behind:
    /// the values predicted with the old rates over `half_dt` are what enters the sums. Sets
    /// timestep() and dissipated_power(). `new_lists`: they were built since the last call. Where
    /// they were not, a particle of the bed that nothing comes near has the rates it had: none.
    void evaluate(State& particles, const Lists& lists, Halo<D>& halo, double half_dt,
                  bool new_lists);

    /// Eq. (63) for every particle, once a step is complete.
    void end_step(State& particles) const;

    /// What acts on particle p, as last evaluated. All ranks call it; p is -1 on those that do not
    /// have the particle, which get nothing.
    ForceTerms<D> force_terms(const State& particles, const Lists& lists, Halo<D>& halo,
                              std::int64_t p) const;

    /// All particles are in the first pass, moving ones in the second.
    static WordCosts cost_of_lists(const ListWords& words, const PassSeconds& seconds) {
        const double fixed = seconds.first / (words.fixed + words.moving);
        return {seconds.second / words.moving + fixed, fixed};
    }

    double kernel_support() const;
    static PairArea pair_area() { return {}; }
    /// Pressure, sound speed and energy of a particle.
    ThermodynamicState<double> equation_of_state(const State& particles, std::size_t p) const;
    /// Elastic energy of a particle in shear [J], 2-D: [J/m].
    double shear_energy(const State& particles, std::size_t p) const;
    double timestep() const { return timestep_; }
    /// By artificial viscosity, of the particles of this rank [W], 2-D: [W/m].
    double dissipated_power() const { return av_power_; }
    void forget_power() { av_power_ = 0.0; }
    /// Not known of this scheme.
    SchemeWork<D> work() const { return {}; }
    PhaseTimer& phases() { return phases_; }
    /// The particle to blame where a density is absurd or rates are not finite.
    const Fault& fault() const { return fault_; }
    /// The particle that allows the shortest timestep, or -1.
    std::int64_t limiting_particle() const { return limiting_; }
    const Array<Material>& materials() const;
    std::span<const MotionRecord<real, D>> motion_records() const { return motion_; }
    std::span<const StressRecord<real, D>> stress_records() const { return stress_; }
    const CoordinateFrame<real, D>& frame() const { return frame_; }
    const Options<D>& options() const;
    /// Balsara's switch of a particle, as last summed; zero in a restored state until then.
    double balsara(std::size_t p) const {
        return p < stress_.size() ? static_cast<double>(stress_[p].balsara) : 0.0;
    }

    /// Deviatoric part of the stress of particle p: S of a solid, tau of a fluid (as last summed).
    Deviator<double, D> deviator(const State& particles, std::size_t p) const;

    /// Pairs per second of one thread in both sums over a few clusters that stay in cache, for
    /// `seconds` of processor time: for the bench.
    double bare_pair_rate(const Lists& lists, double seconds) const
        requires std::is_same_v<typename Lists::List, ClusterList>;

    /// Stress records are kept from step to step where nothing is near (see compute).
    void serialise(Archive& archive) {
        archive("stress_record", stress_), archive("next_timestep", timestep_),
            archive("av_power", av_power_);
    }

    std::size_t bytes() const {
        return motion_.bytes_held() + stress_.bytes_held() + summary_.bytes_held();
    }

private:
    void pack_motion(State& particles, const Halo<D>& halo, double half_dt);
    void agree_on_h(const State& particles, const Ranks& ranks);
    void sum_velocity_gradient(State& particles, const Lists& lists, Halo<D>& halo, double half_dt);
    void sum_momentum(State& particles, const Lists& lists, Halo<D>& halo);
    void reduce_summaries();
    void find_survivor(State& particles);

    template <class Term, class Epilogue>
    void sum_pairs(Phase phase, const Lists& lists, std::span<const typename Lists::List> clusters,
                   Halo<D>& halo, const Term& term, const Epilogue& epilogue);

    Shared<const Ueta2022Model<D>> model_;
    bool equal_h_ = true;
    bool skip_empty_ = false;
    CoordinateFrame<real, D> frame_;
    Field<MotionRecord<real, D>> motion_;
    Field<StressRecord<real, D>> stress_;
    Field<StepSummary> summary_;
    PhaseTimer phases_;
    double timestep_ = 0.0;
    double av_power_ = 0.0;
    Fault fault_;
    std::int64_t limiting_ = -1;
};

}  // namespace doseki
