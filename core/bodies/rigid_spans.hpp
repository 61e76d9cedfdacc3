#pragma once
#include <cmath>
#include <span>

#include "base/matrix.hpp"
#include "bodies/rigid_body.hpp"

namespace doseki {

/// Rigid bodies, as loops over them refer to them.
template <int D>
struct RigidBodiesSeen {
    std::span<const RigidBody<D>> bodies;
    std::span<const RigidBodyState<D>> states;
    std::span<const Mat<double, 3>> inverse_inertia;  // 3-D: of bodies that do not turn alike
    std::span<const std::uint8_t> turns_alike;        // about all axes, as balls do
    std::span<const Shape<D>> shapes;

    DOSEKI_DEVICE_FN bool is_free(std::size_t k) const {
        return !bodies[k].fixed && !states[k].is_removed();
    }
    DOSEKI_DEVICE_FN const Shape<D>& shape(std::size_t k) const {
        return shapes[static_cast<std::size_t>(bodies[k].shape)];
    }
    /// omega = R I^-1 R^T L (eq. 51).
    DOSEKI_DEVICE_FN Vec3 spin_of(std::size_t k, const Vec3& L) const {
        return spin_of(k, L, states[k].orientation);
    }
    DOSEKI_DEVICE_FN Vec3 spin_of(std::size_t k, const Vec3& L,
                                  const Quaternion& orientation) const {
        if (bodies[k].fixed) return L;
        if (turns_alike[k]) {
            const double I = bodies[k].inertia(2, 2);
            Vec3 spin;
            for (int c = 0; c < 3; ++c) spin[c] = L[c] / I;
            return spin;
        }
        const Mat<double, 3> R = orientation.matrix();
        return rotated(R, inverse_inertia[k] * rotated_back(R, L));
    }
    DOSEKI_DEVICE_FN Vec3 spin(std::size_t k) const {
        return spin_of(k, states[k].angular_momentum);
    }
    /// When the fluid will have acted for `ahead` more.
    DOSEKI_DEVICE_FN Vec3 spin(std::size_t k, double ahead) const {
        return spin_of(k, states[k].angular_momentum + ahead * states[k].flow_torque);
    }
    /// By what it turns in dt while nothing turns it, Eq. (51a): with the spin that it has half the
    /// way. With that of the start it would gain energy until it turns about its longest axis.
    DOSEKI_DEVICE_FN Vec3 free_turn(std::size_t k, double dt) const {
        constexpr int most = 12;  // each brings two digits at the steps of Eq. (52)
        constexpr double rounding = 1e-15;
        Vec3 turn = dt * spin(k);
        if (turns_alike[k]) return turn;
        for (int n = 0; n < most; ++n) {
            const Quaternion half_way = states[k].orientation.turned(0.5 * turn);
            const Vec3 before = turn;
            turn = dt * spin_of(k, states[k].angular_momentum, half_way);
            if (norm(turn - before) < rounding) break;
        }
        return turn;
    }
    /// Of the centre, when the fluid will have acted for `ahead` more.
    DOSEKI_DEVICE_FN Vec<double, D> velocity(std::size_t k, double ahead) const {
        return states[k].velocity + (ahead / bodies[k].mass) * states[k].flow_force;
    }
    DOSEKI_DEVICE_FN double kinetic_energy(std::size_t k) const {
        return 0.5 * bodies[k].mass * dot(states[k].velocity, states[k].velocity) +
               0.5 * dot(spin(k), states[k].angular_momentum);
    }
};

/// The same, to be moved.
template <int D>
struct RigidBodiesMoved {
    RigidBodiesSeen<D> seen;
    std::span<RigidBodyState<D>> states;
    std::span<Vec<double, D>> contact_force;  // of the last contact step
    std::span<Vec3> contact_torque;
    // Within a step: neither contacts nor its spin see how a ball is turned that turns alike about
    // all axes. Dust does not: it is a ball with the inertia of its points.
    std::span<Vec3> ball_turn;

    /// Position and orientation; returns the largest distance that a point of the surface goes.
    DOSEKI_DEVICE_FN double drift(std::size_t k, double dt) const {
        if (!seen.is_free(k)) return 0.0;
        RigidBodyState<D>& state = states[k];
        const Vec3 turn = seen.free_turn(k, dt);
        const double distance = std::abs(dt) * norm(state.velocity);
        state.centre = state.centre + dt * state.velocity;
        const bool is_ball = seen.shape(k).is_ball();
        if (is_ball && seen.turns_alike[k]) {
            ball_turn[k] = ball_turn[k] + turn;
            return distance;
        }
        state.orientation = state.orientation.turned(turn);
        return is_ball ? distance : distance + seen.shape(k).radius * norm(turn);
    }
    DOSEKI_DEVICE_FN void push_by_contacts(std::size_t k, double dt) const {
        RigidBodyState<D>& state = states[k];
        state.contact_impulse = state.contact_impulse + dt * contact_force[k];
        if (!seen.is_free(k)) return;
        state.velocity = state.velocity + (dt / seen.bodies[k].mass) * contact_force[k];
        state.angular_momentum = state.angular_momentum + dt * contact_torque[k];
    }
    DOSEKI_DEVICE_FN void push_by_gravity(std::size_t k, const Vec<double, D>& gravity,
                                          double dt) const {
        if (seen.is_free(k)) states[k].velocity = states[k].velocity + dt * gravity;
    }
    /// By the forces that the fluid had when it was evaluated.
    DOSEKI_DEVICE_FN void push_by_flow(std::size_t k, double dt) const {
        if (!seen.is_free(k)) return;
        RigidBodyState<D>& state = states[k];
        state.velocity = state.velocity + (dt / seen.bodies[k].mass) * state.flow_force;
        state.angular_momentum = state.angular_momentum + dt * state.flow_torque;
    }
};

}  // namespace doseki
