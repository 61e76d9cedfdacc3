#pragma once
// Steps of rigid bodies, which bodies.cpp compiles.

#include <algorithm>

#include "bodies/rigid_bodies.hpp"

namespace doseki {

template <int D>
void RigidBodies<D>::kick(double half_dt) {
    for_each_particle(size(), [&](std::size_t k) {
        if (!is_free(k)) return;
        push_by_flow(k, half_dt);
        states_[k].flow_impulse = states_[k].flow_impulse + half_dt * states_[k].flow_force;
    });
}

template <int D>
void RigidBodies<D>::begin_step(double dt) {
    spin_before_ = spins(0.0);
    velocity_before_.resize(size()), impulse_before_.resize(size());
    ball_turn_.assign(size(), {});
    for_each_particle(size(), [&](std::size_t k) {
        velocity_before_[k] = states_[k].velocity;
        impulse_before_[k] = states_[k].contact_impulse;
        push_by_flow(k, -0.5 * dt);
    });
}

template <int D>
double RigidBodies<D>::drift_one(std::size_t k, double dt) {
    if (!is_free(k)) return 0.0;
    RigidBodyState<D>& state = states_[k];
    const Vec3 turn = dt * spin(k);
    const double distance = dt * norm(state.velocity);
    state.centre = state.centre + dt * state.velocity;
    if (shape(k).is_ball()) {
        ball_turn_[k] = ball_turn_[k] + turn;
        return distance;
    }
    state.orientation = state.orientation.turned(turn);
    return distance + shape(k).radius * norm(turn);
}

template <int D>
void RigidBodies<D>::put_back(std::size_t k, const Vec<double, D>& centre,
                              const Vec<double, D>& velocity, const Quaternion& orientation,
                              const Vec3& angular_momentum) {
    RigidBodyState<D>& state = states_[k];
    state.removed = 0.0, state.centre = centre, state.velocity = velocity;
    state.orientation = orientation, state.angular_momentum = angular_momentum;
    state.acceleration = {}, state.spin_rate = {}, state.flow_force = {}, state.flow_torque = {};
    ball_turn_[k] = {};
}

template <int D>
void RigidBodies<D>::push(const Vec<double, D>& gravity, double dt) {
    for_each_particle(size(), [&](std::size_t k) {
        push_by_contacts(k, dt);
        if (!is_free(k)) return;
        states_[k].velocity = states_[k].velocity + dt * gravity;
        push_by_flow(k, dt);
    });
}

template <int D>
void RigidBodies<D>::push_by_contacts(double dt) {
    for_each_particle(size(), [&](std::size_t k) { push_by_contacts(k, dt); });
}

template <int D>
void RigidBodies<D>::push_by_contacts(std::size_t k, double dt) {
    RigidBodyState<D>& state = states_[k];
    state.contact_impulse = state.contact_impulse + dt * contact_force_[k];
    if (!is_free(k)) return;
    state.velocity = state.velocity + (dt / bodies_[k].mass) * contact_force_[k];
    state.angular_momentum = state.angular_momentum + dt * contact_torque_[k];
}

template <int D>
void RigidBodies<D>::push_by_flow(std::size_t k, double dt) {
    if (!is_free(k)) return;
    RigidBodyState<D>& state = states_[k];
    state.velocity = state.velocity + (dt / bodies_[k].mass) * state.flow_force;
    state.angular_momentum = state.angular_momentum + dt * state.flow_torque;
}

template <int D>
void RigidBodies<D>::end_step(double dt, double memory) {
    for_each_particle(size(), [&](std::size_t k) {
        RigidBodyState<D>& state = states_[k];
        mean_contact_force_[k] = (1.0 / dt) * (state.contact_impulse - impulse_before_[k]);
        if (!is_free(k)) return;
        push_by_flow(k, -0.5 * dt);
        state.orientation = state.orientation.turned(ball_turn_[k]);
        const Vec<double, D> mean = (1.0 / dt) * (state.velocity - velocity_before_[k]) +
                                    (1.0 / bodies_[k].mass) * state.flow_force;
        const double share = std::min(1.0, dt / memory);
        state.acceleration = state.acceleration + share * (mean - state.acceleration);
        state.spin_rate =
            state.spin_rate + share * ((1.0 / dt) * (spin(k) - spin_before_[k]) - state.spin_rate);
    });
}

}  // namespace doseki
