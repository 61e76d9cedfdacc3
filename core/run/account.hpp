#pragma once
#include "model/body_step.hpp"
#include "model/particles.hpp"
#include "model/scheme_work.hpp"

namespace doseki {

/// Mass and momentum of particles, with the velocities that they are moved with.
template <int D>
struct Weight {
    double mass = 0.0;
    Vec<double, D> momentum{};

    DOSEKI_DEVICE_FN Weight operator+(const Weight& other) const {
        return {mass + other.mass, momentum + other.momentum};
    }
};

/// Of the fluid on fixed walls: force, and power where these have a velocity.
template <int D>
struct WallPush {
    Vec<double, D> force{};
    double power = 0.0;

    DOSEKI_DEVICE_FN WallPush operator+(const WallPush& other) const {
        return {force + other.force, power + other.power};
    }
};

/// What free particles and bodies that move have got since the start from what is around them;
/// 2-D: per metre.
template <int D>
struct Account {
    /// Of gravity, walls, contacts with fixed bodies and the layers behind inflows [N s].
    Vec<double, D> impulse{};
    double gravity_work = 0.0;     // the potential that was released [J]
    double wall_work = 0.0;        // of walls that have a velocity and of those layers [J]
    double contact_work = 0.0;     // of contacts of bodies: less than nothing where they damp [J]
    double scheme_work = 0.0;      // see SchemeWork::power and energy [J]
    double relaxation_work = 0.0;  // of it, see SchemeWork::relaxation [J]
    double parting_work = 0.0;     // that bodies lost when parts came off them [J]

    /// Half a step of the forces on walls and of `scheme`, before the step or after it.
    void add_forces(const WallPush<D>& push, const SchemeWork<D>& scheme, double half_dt) {
        impulse = impulse + half_dt * (scheme.layer_force - push.force);
        wall_work += half_dt * (scheme.layer_power - push.power);
        scheme_work += half_dt * scheme.power;
    }

    /// The second half of a step, and what happened at once in it.
    void add_evaluated(const WallPush<D>& push, const SchemeWork<D>& scheme, double half_dt) {
        add_forces(push, scheme, half_dt), scheme_work += scheme.energy;
        relaxation_work += scheme.relaxation;
    }

    /// A step of gravity on the free particles.
    void add_weight(const Weight<D>& weight, const Vec<double, D>& gravity, double dt) {
        impulse = impulse + (dt * weight.mass) * gravity;
        gravity_work += dt * dot(gravity, weight.momentum);
    }

    void add(const BodyStep<D>& step) {
        impulse = impulse + step.impulse;
        gravity_work += step.gravity_work, contact_work += step.contact_work;
        parting_work += step.parting_work;
    }
};

}  // namespace doseki
