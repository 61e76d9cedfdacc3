#pragma once
// What a run asks of a scheme. A scheme is a right-hand side with a state of its own: it owns what
// it keeps of particles and says what happens to that at each point of a step.

#include "base/array.hpp"
#include "base/named.hpp"
#include "base/phase_timer.hpp"
#include "cells/list_wear.hpp"
#include "model/fault.hpp"
#include "model/force_terms.hpp"
#include "model/material.hpp"
#include "model/options.hpp"
#include "model/particles.hpp"
#include "model/scheme_work.hpp"
#include "pairs/backend.hpp"
#include "physics/wall.hpp"
#include "ranks/balance.hpp"
#include "ranks/halo.hpp"

namespace doseki {

/// `State`: Particles and the scheme's own fields, all listed in for_each_field(f(name, field)).
template <class State>
concept SchemeState =
    std::derived_from<State, Particles<State::dim>> &&
    std::constructible_from<StateOf<State>, const Array<Material>&, const Options<State::dim>&> &&
    requires(State& state, const State& known, std::size_t p, double dt) {
        state.for_each_field(IgnoreNamed{});
        state.enter(p);     // a particle that an inflow has just added
        state.kick(p, dt);  // over half a step, what goes with the velocity
        { known.transport_velocity(p) } -> std::same_as<Vec<double, State::dim>>;
        { known.has_density(p) } -> std::same_as<bool>;
        { known.sum_of_fields(p) } -> std::same_as<double>;  // not finite where a field is not
    };

template <class S>
concept Scheme = SchemeState<typename S::State> && Backend<typename S::Backend, S::dim> &&
                 std::constructible_from<S, Array<Material>, const Options<S::dim>&> &&
                 requires(S& scheme, const S& known, typename S::State& state,
                          const typename S::Backend::template Lists<S::dim>& lists,
                          Halo<S::dim>& halo, double half_dt, bool new_lists, std::size_t p) {
                     scheme.evaluate(state, lists, halo, half_dt, new_lists);
                     scheme.end_step(state);
                     {
                         known.force_terms(state, lists, halo, std::int64_t{})
                     } -> std::same_as<ForceTerms<S::dim>>;
                     { known.timestep() } -> std::same_as<double>;
                     { known.dissipated_power() } -> std::same_as<double>;
                     { known.work() } -> std::same_as<SchemeWork<S::dim>>;
                     { known.kernel_support() } -> std::same_as<double>;
                     { known.pair_area() } -> std::convertible_to<PairArea>;
                     { known.fault() } -> std::same_as<const Fault&>;
                     { known.limiting_particle() } -> std::same_as<std::int64_t>;
                     { known.materials() } -> std::same_as<const Array<Material>&>;
                     { scheme.phases() } -> std::same_as<PhaseTimer&>;
                     known.equation_of_state(state, p).pressure;
                     { known.shear_energy(state, p) } -> std::same_as<double>;
                     // How often the right-hand side is evaluated before the first step.
                     { S::first_evaluations + 0 } -> std::same_as<int>;
                     // Whether densities come first, from pairs as they were half a step before.
                     { S::looks_back } -> std::convertible_to<bool>;
                     { S::skin_costs } -> std::convertible_to<SkinCosts>;
                     { S::cost_of_lists(ListWords{}, PassSeconds{}) } -> std::same_as<WordCosts>;
                 };

}  // namespace doseki
