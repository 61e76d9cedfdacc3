// Steps of rigid bodies, where the bodies are.

#include <algorithm>
#include <functional>

#include "base/bulk.hpp"
#include "bodies/rigid_bodies.hpp"

namespace doseki {
namespace {

template <int D>
struct KickBody {
    RigidBodiesMoved<D> rigid;
    double half_dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        if (!rigid.seen.is_free(k)) return;
        rigid.push_by_flow(k, half_dt);
        RigidBodyState<D>& state = rigid.states[k];
        state.flow_impulse = state.flow_impulse + half_dt * state.flow_force;
    }
};

template <int D>
struct BeginStepOfBody {
    RigidBodiesMoved<D> rigid;
    BodiesBefore<D> before;
    double dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        before.spin[k] = rigid.seen.spin(k);
        before.velocity[k] = rigid.states[k].velocity;
        before.impulse[k] = rigid.states[k].contact_impulse;
        rigid.ball_turn[k] = {};
        rigid.push_by_flow(k, -0.5 * dt);
    }
};

template <int D>
struct EndStepOfBody {
    RigidBodiesMoved<D> rigid;
    BodiesBefore<D> before;
    std::span<Vec<double, D>> mean_contact_force;
    double dt, memory;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        RigidBodyState<D>& state = rigid.states[k];
        mean_contact_force[k] = (1.0 / dt) * (state.contact_impulse - before.impulse[k]);
        if (!rigid.seen.is_free(k)) return;
        rigid.push_by_flow(k, -0.5 * dt);
        state.orientation = state.orientation.turned(rigid.ball_turn[k]);
        const Vec<double, D> mean = (1.0 / dt) * (state.velocity - before.velocity[k]) +
                                    (1.0 / rigid.seen.bodies[k].mass) * state.flow_force;
        const double share = std::min(1.0, dt / memory);
        state.acceleration = state.acceleration + share * (mean - state.acceleration);
        const Vec3 turning = (1.0 / dt) * (rigid.seen.spin(k) - before.spin[k]) +
                             rigid.seen.spin_of(k, state.flow_torque);
        state.spin_rate = state.spin_rate + share * (turning - state.spin_rate);
    }
};

template <int D>
struct DriftBody {
    RigidBodiesMoved<D> rigid;
    double dt;

    DOSEKI_DEVICE_FN double operator()(std::size_t k) const { return rigid.drift(k, dt); }
};

template <int D>
struct DriftOneOf {
    RigidBodiesMoved<D> rigid;
    std::span<const std::uint32_t> which;
    double dt;

    DOSEKI_DEVICE_FN double operator()(std::size_t n) const { return rigid.drift(which[n], dt); }
};

template <int D>
struct PushBody {
    RigidBodiesMoved<D> rigid;
    Vec<double, D> gravity;
    double dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        rigid.push_by_contacts(k, dt);
        rigid.push_by_gravity(k, gravity, dt);
        rigid.push_by_flow(k, dt);
    }
};

template <int D>
struct PushBodyByContacts {
    RigidBodiesMoved<D> rigid;
    double dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const { rigid.push_by_contacts(k, dt); }
};

/// Largest speed of a point of the surface.
template <int D>
struct SpeedOfBody {
    RigidBodiesSeen<D> rigid;

    DOSEKI_DEVICE_FN double operator()(std::size_t k) const {
        if (!rigid.is_free(k)) return 0.0;
        return norm(rigid.states[k].velocity) + rigid.shape(k).radius * norm(rigid.spin(k));
    }
};

template <int D>
struct SumsOfBody {
    RigidBodiesSeen<D> rigid;

    DOSEKI_DEVICE_FN BodySums<D> operator()(std::size_t k) const {
        if (!rigid.is_free(k)) return {};
        const double mass = rigid.bodies[k].mass;
        return {mass * rigid.states[k].velocity, mass * rigid.states[k].centre,
                rigid.kinetic_energy(k)};
    }
};

}  // namespace

template <int D>
void RigidBodies<D>::kick(double half_dt) {
    bulk::for_each(size(), KickBody<D>{moved(), half_dt});
}

template <int D>
void RigidBodies<D>::begin_step(double dt) {
    velocity_before_.resize(size()), impulse_before_.resize(size()), spin_before_.resize(size());
    ball_turn_.resize(size());
    bulk::for_each(size(), BeginStepOfBody<D>{moved(), before(), dt});
}

template <int D>
void RigidBodies<D>::end_step(double dt, double memory) {
    bulk::for_each(size(), EndStepOfBody<D>{moved(), before(), mean_contact_force_, dt, memory});
}

template <int D>
double RigidBodies<D>::drift(double dt) {
    return bulk::reduce(size(), 0.0, maximum, DriftBody<D>{moved(), dt});
}

template <int D>
double RigidBodies<D>::drift(double dt, std::span<const std::uint32_t> which) {
    return bulk::reduce(which.size(), 0.0, maximum, DriftOneOf<D>{moved(), which, dt});
}

template <int D>
void RigidBodies<D>::push(const Vec<double, D>& gravity, double dt) {
    bulk::for_each(size(), PushBody<D>{moved(), gravity, dt});
}

template <int D>
void RigidBodies<D>::push_by_contacts(double dt) {
    bulk::for_each(size(), PushBodyByContacts<D>{moved(), dt});
}

template <int D>
double RigidBodies<D>::max_speed() const {
    return bulk::reduce(size(), 0.0, maximum, SpeedOfBody<D>{seen()});
}

template <int D>
BodySums<D> RigidBodies<D>::sums() const {
    return bulk::reduce(size(), BodySums<D>{}, std::plus<>{}, SumsOfBody<D>{seen()});
}

template void RigidBodies<2>::kick(double);
template void RigidBodies<2>::begin_step(double);
template void RigidBodies<2>::end_step(double, double);
template double RigidBodies<2>::drift(double);
template double RigidBodies<2>::drift(double, std::span<const std::uint32_t>);
template void RigidBodies<2>::push(const Vec<double, 2>&, double);
template void RigidBodies<2>::push_by_contacts(double);
template double RigidBodies<2>::max_speed() const;
template BodySums<2> RigidBodies<2>::sums() const;

template void RigidBodies<3>::kick(double);
template void RigidBodies<3>::begin_step(double);
template void RigidBodies<3>::end_step(double, double);
template double RigidBodies<3>::drift(double);
template double RigidBodies<3>::drift(double, std::span<const std::uint32_t>);
template void RigidBodies<3>::push(const Vec<double, 3>&, double);
template void RigidBodies<3>::push_by_contacts(double);
template double RigidBodies<3>::max_speed() const;
template BodySums<3> RigidBodies<3>::sums() const;

}  // namespace doseki
