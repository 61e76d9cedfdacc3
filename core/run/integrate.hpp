#pragma once
#include <functional>

#include "base/parallel.hpp"
#include "model/particles.hpp"
#include "run/account.hpp"

namespace doseki {

/// Half a step of the velocity of a particle, and of what else its scheme kicks.
template <class State>
struct Kick {
    State& state;
    double half_dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        if (state.is_bound(p)) return;
        // What moves walls says their velocity at every time.
        if (!state.is_wall(p))
            state.velocity[p] = state.velocity[p] + half_dt * state.acceleration[p];
        state.kick(p, half_dt);
    }
};

/// A whole step of its position; its speed squared.
template <class State>
struct Drift {
    State& state;
    double dt;

    DOSEKI_DEVICE_FN double operator()(std::size_t p) const {
        // A fixed particle may have a velocity, as a belt has: it acts on others, nothing moves.
        if (state.is_wall(p)) return 0.0;
        const auto v = state.transport_velocity(p);
        state.position[p] = state.position[p] + dt * v;
        return dot(v, v);
    }
};

template <class State>
struct FreeWeight {
    const State& state;

    DOSEKI_DEVICE_FN Weight<State::dim> operator()(std::size_t p) const {
        if (!state.is_free(p)) return {};
        return {state.mass[p], state.mass[p] * state.transport_velocity(p)};
    }
};

template <class State>
struct PushOfWall {
    const State& state;

    DOSEKI_DEVICE_FN WallPush<State::dim> operator()(std::size_t p) const {
        if (!state.is_fixed(p)) return {};
        return {state.wall.force[p], dot(state.wall.force[p], state.velocity[p]) +
                                         dot(state.wall.moment[p], state.wall.spin[p])};
    }
};

/// Half a step of all particles (kick-drift-kick leap-frog).
template <class Backend, class State>
void kick(State& state, double half_dt) {
    Backend::for_each_particle(state.size(), Kick<State>{state, half_dt});
}

/// A whole step of positions. Returns the largest distance that any particle went.
template <class Backend, class State>
double drift(State& state, double dt) {
    return dt * sqrt(Backend::reduce(state.size(), 0.0, maximum, Drift<State>{state, dt}));
}

/// Of the free particles.
template <class Backend, class State>
Weight<State::dim> weight(const State& state) {
    using Sum = Weight<State::dim>;
    return Backend::reduce(state.size(), Sum{}, std::plus<Sum>{}, FreeWeight<State>{state});
}

/// On fixed walls.
template <class Backend, class State>
WallPush<State::dim> wall_push(const State& state) {
    using Sum = WallPush<State::dim>;
    if (!state.wall.in_use) return {};
    return Backend::reduce(state.size(), Sum{}, std::plus<Sum>{}, PushOfWall<State>{state});
}

}  // namespace doseki
