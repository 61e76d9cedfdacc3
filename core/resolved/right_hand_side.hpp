#pragma once
#include <span>

#include "base/array.hpp"
#include "base/phase_timer.hpp"
#include "boundaries/face_push.hpp"
#include "cells/list_wear.hpp"
#include "device/backend_of_build.hpp"
#include "model/force_terms.hpp"
#include "model/material.hpp"
#include "model/options.hpp"
#include "model/scheme_work.hpp"
#include "physics/equation_of_state/thermodynamic_state.hpp"
#include "physics/wall.hpp"
#include "ranks/balance.hpp"
#include "ranks/halo.hpp"
#include "resolved/records.hpp"
#include "resolved/state.hpp"

namespace doseki {

template <class real, int D>
struct FlowRecords;
template <class real, int D>
class WallEpilogue;
template <int D>
struct ResolvedModel;

/// Right-hand side of the resolved scheme: fluid among walls. One pass over the pairs of fluid
/// particles gives their densities at the end of the step, from where they are and how they move in
/// the middle of it; with these, one over walls and one over fluid give forces. So sound takes
/// leap-frog steps, of density and velocity in turns. Gradients and the free-surface indicator are
/// those of the last sums where a pair needs them; a timestep is short against what they describe.
/// How it is evaluated is in resolved/evaluate.hpp, which a unit of its own compiles: who steps a
/// run need not see the physics.
template <int D, class real, class BackendOf = BackendOfBuild<real>>
class Resolved {
public:
    using Real = real;
    using Backend = BackendOf;
    using Lists = typename Backend::template Lists<D>;
    using State = ResolvedState<D>;
    static constexpr int dim = D;
    /// The second one reads the gradients that the first one has left.
    static constexpr int first_evaluations = 2;
    static constexpr bool looks_back = true;
    /// The sums leave out what is not in reach (KnowsItsReach), so a skin costs its distances
    /// alone.
    static constexpr SkinCosts skin_costs =
        D == 2 ? SkinCosts{1.25, 0.15, 0.4} : SkinCosts{1.0, 0.25, 0.3};

    Resolved(Array<Material> materials, const Options<D>& options);

    /// Takes the density of `state` over a step. Positions are those of the end of the step,
    /// velocities those of its middle.
    void advance_density(State& state, const Lists& lists, Halo<D>& halo, double dt);

    /// Fills the accelerations of `state`, after advance_density(). Velocities of fluid are half a
    /// step behind: those predicted with the old accelerations over `half_dt` enter the forces.
    /// Sets timestep() and dissipated_power(). Nothing depends on whether lists are new.
    void evaluate(State& state, const Lists& lists, Halo<D>& halo, double half_dt, bool);

    /// The part of evaluate() that gives pressures to wall particles, where no time passes; those
    /// of films go on with this share of their last change.
    void sum_walls_alone(State& state, const Lists& lists, Halo<D>& halo, double inertia);

    /// See Ueta2022::force_terms.
    ForceTerms<D> force_terms(const State& state, const Lists& lists, Halo<D>&,
                              std::int64_t p) const;

    /// What the fluid gives to these wall particles, in rising order, against the normal of a face:
    /// as of the last evaluation.
    void push_on(const State& state, const Lists& lists, const FacePlane<D>& face,
                 std::span<const std::uint32_t> walls, Array<FacePush<D>>& pushes);

    void end_step(State&) { steps_since_depths_ = (steps_since_depths_ + 1) % depth_interval; }

    /// Wall particles are in the first phase, fluid particles in the second.
    static WordCosts cost_of_lists(const ListWords& words, const PassSeconds& seconds) {
        return {seconds.second / words.moving, seconds.first / words.fixed};
    }

    double kernel_support() const;
    const PairArea& pair_area() const;
    double timestep() const { return timestep_; }
    /// By the viscosity of fluid and scheme, of the particles of this rank [W], 2-D: [W/m].
    double dissipated_power() const { return power_; }
    SchemeWork<D> work() const { return work_; }
    /// Where another rank has them.
    void forget_power() { power_ = 0.0, work_ = {}; }
    PhaseTimer& phases() { return phases_; }
    const Fault& fault() const { return fault_; }
    std::int64_t limiting_particle() const { return limiting_; }
    const Array<Material>& materials() const;
    std::span<const MotionRecord<real, D>> motion_records() const { return motion_; }
    const CoordinateFrame<real, D>& frame() const { return frame_; }
    Deviator<double, D> deviator(const State& state, std::size_t p) const;
    double shear_energy(const State&, std::size_t) const { return 0.0; }

    /// Pressure and energy of a particle; of a wall particle, those of the fluid at its place. The
    /// sound speed is the one of the scheme, that at rest.
    ThermodynamicState<double> equation_of_state(const State& state, std::size_t p) const;

    void serialise(Archive& archive) {
        archive("next_timestep", timestep_), archive("av_power", power_),
            archive("scheme_work", work_);
        archive("steps_since_depths", steps_since_depths_);
    }

    std::size_t bytes() const {
        return motion_.bytes_held() + fluid_.bytes_held() + wall_.bytes_held() +
               summary_.bytes_held() + face_depth_.bytes_held() + face_push_.bytes_held();
    }

private:
    /// Steps for which depths of the flow and mixing lengths hold: particles go a fraction of their
    /// spacing meanwhile. When lists are built does not matter, for that follows the skin and the
    /// ranks.
    static constexpr std::int64_t depth_interval = 8;

    FlowRecords<real, D> records(const State& state) const;
    void set_mixing_lengths(State& state, const Lists& lists, const Ranks& ranks);
    void make_room(const State& state, const Halo<D>& halo);
    template <template <class, int> class Packer>
    void pack(State& state, double half_dt);
    template <class Kernel>
    void sum_densities(State& state, const Lists& lists, Halo<D>& halo, double dt);
    template <class Kernel>
    void sum_forces(State& state, const Lists& lists, Halo<D>& halo, double dt);
    template <class Kernel>
    void sum_walls(State& state, const Lists& lists, const FlowRecords<real, D>& records,
                   const WallEpilogue<real, D>& epilogue);
    template <class Kernel>
    void sum_face(const State& state, const Lists& lists, const FacePlane<D>& face,
                  const Array<std::uint32_t>& clusters);
    template <class Term, class Epilogue>
    void sum_fluid(Phase phase, const Lists& lists, Halo<D>& halo, const Term& term,
                   const Epilogue& epilogue);
    bool has_wet_walls(const FlowRecords<real, D>& records) const;
    void reduce_summaries();

    Shared<const ResolvedModel<D>> model_;
    CoordinateFrame<real, D> frame_;
    Field<MotionRecord<real, D>> motion_;
    Field<FluidRecord<real, D>> fluid_;
    Field<WallRecord<real, D>> wall_;  // the first is that of particle fluid_count_
    Field<FlowSummary<D>> summary_;
    // Of the face that is looked at, of wall particles:
    Field<FaceDepth<real>> face_depth_;
    Field<FacePush<D>> face_push_;
    PhaseTimer phases_;
    std::size_t fluid_count_ = 0;
    double timestep_ = 0.0, power_ = 0.0;
    SchemeWork<D> work_;
    Fault fault_;
    std::int64_t limiting_ = -1;
    std::int64_t steps_since_depths_ = 0;
};

}  // namespace doseki
