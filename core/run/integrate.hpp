#pragma once
#include "base/parallel.hpp"
#include "model/particles.hpp"
#include "run/account.hpp"

namespace doseki {

/// Half a step of everything that has a rate (kick-drift-kick leap-frog).
template <class State>
void kick(State& state, double half_dt) {
    for_each_particle(state.size(), [&](std::size_t p) {
        if (state.is_bound(p)) return;
        state.velocity[p] = state.velocity[p] + half_dt * state.acceleration[p];
        state.density[p] += half_dt * state.density_rate[p];
        state.kick(p, half_dt);
    });
}

/// A whole step of positions. Returns the largest distance that any particle went.
template <class State>
double drift(State& state, double dt) {
    const double fastest = reduce(state.size(), 0.0, maximum, [&](std::size_t p) {
        // A fixed particle may have a velocity, as a belt has: it acts on others, nothing moves.
        if (state.is_wall(p)) return 0.0;
        const auto v = state.transport_velocity(p);
        state.position[p] = state.position[p] + dt * v;
        return dot(v, v);
    });
    return dt * sqrt(fastest);
}

/// Of the free particles.
template <class State>
Weight<State::dim> weight(const State& state) {
    using Sum = Weight<State::dim>;
    return reduce(state.size(), Sum{}, std::plus<Sum>{}, [&](std::size_t p) -> Sum {
        if (!state.is_free(p)) return {};
        return {state.mass[p], state.mass[p] * state.transport_velocity(p)};
    });
}

}  // namespace doseki
