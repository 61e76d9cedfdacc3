#pragma once
#include "base/vec.hpp"

namespace doseki {

/// What gravity and contacts gave to bodies in a step, and what bodies lost when parts came off
/// them; 2-D: per metre.
template <int D>
struct BodyStep {
    Vec<double, D> impulse{};                       // [N s]
    double gravity_work = 0.0, contact_work = 0.0;  // [J]
    double parting_work = 0.0;                      // [J]

    DOSEKI_DEVICE_FN BodyStep operator+(const BodyStep& other) const {
        return {impulse + other.impulse, gravity_work + other.gravity_work,
                contact_work + other.contact_work, parting_work + other.parting_work};
    }
};

/// Sums over the rigid bodies that move.
template <int D>
struct BodySums {
    Vec<double, D> momentum{}, moment{};  // sum of m v, of m x
    double kinetic_energy = 0.0;

    DOSEKI_DEVICE_FN BodySums operator+(const BodySums& other) const {
        return {momentum + other.momentum, moment + other.moment,
                kinetic_energy + other.kinetic_energy};
    }
    BodySums less(const BodySums& other) const {
        return {momentum - other.momentum, moment - other.moment,
                kinetic_energy - other.kinetic_energy};
    }
    /// What came between an earlier moment and this one, in which nothing but gravity and contacts
    /// acted.
    BodyStep<D> since(const BodySums& before, const Vec<double, D>& gravity) const {
        BodyStep<D> step;
        step.impulse = momentum - before.momentum;
        step.gravity_work = dot(gravity, moment - before.moment);
        step.contact_work = kinetic_energy - before.kinetic_energy - step.gravity_work;
        return step;
    }
};

}  // namespace doseki
