#pragma once
// Steps of bodies of which some are rigid until they are struck, which bodies.cpp compiles.

#include <cmath>

#include "bodies/bodies.hpp"
#include "bodies/fragments/rigid_motion.hpp"

namespace doseki {

template <int D>
void Bodies<D>::find_companions() {
    if (!breakable_.any()) return;
    Array<std::uint8_t> is_companion(rigid.size(), 0);
    auto mark = [&](std::int32_t k) {
        if (static_cast<std::size_t>(k) < rigid.size()) is_companion[static_cast<std::size_t>(k)] = 1;
    };
    contacts_.for_each_pair_of(PairKind::deformable,
                               [&](std::int32_t a, std::int32_t b) { mark(a), mark(b); });
    companions_.clear(), others_.clear();
    for (std::uint32_t k = 0; k < rigid.size(); ++k)
        (is_companion[k] ? companions_ : others_).push_back(k);
}

/// Eq. (142): contacts of rigid bodies push once, in the middle of a step, in each half of which
/// deformable bodies and their companions have steps of their own (Tuckerman, Berne and Martyna, J.
/// Chem. Phys. 97, 1992).
template <int D>
void Bodies<D>::advance_apart(const MovingWalls<D>& walls, double t, double dt, Course& course) {
    for (double left = dt; left > 0.0;) {
        const double steps = steps_of(left, longest_step(PairKind::rigid)), step = left / steps,
                     now = t + dt - left;
        course.gravity_lag = 0.0;
        drift_apart(walls, now, 0.5 * step, course);
        push_rigid(step, course);
        course.gravity_lag = -0.5 * step;
        drift_apart(walls, now + 0.5 * step, 0.5 * step, course);
        left = steps > 1.0 ? left - step : 0.0;
    }
}

template <int D>
void Bodies<D>::drift_apart(const MovingWalls<D>& walls, double t, double dt, Course& course) {
    Array<std::uint32_t> together = companions_;  // and dust that is born on the way
    double ahead = rigid.drift(dt, others_);
    moved_ += ahead;
    if (!deformable.any_deforms()) {
        follow_walls(walls, t, dt);
        moved_ += std::max(0.0, rigid.drift(dt, together) - ahead);
        return;
    }
    auto drift_together = [&](double step) {
        const double way = std::max(deformable.drift(step), rigid.drift(step, together));
        moved_ += std::max(0.0, way - ahead), ahead = std::max(0.0, ahead - way);
    };
    for (double left = dt; left > 0.0;) {
        const double longest = std::min(longest_step(PairKind::deformable), deformable_step_),
                     steps = steps_of(left, longest), step = left / steps, now = t + dt - left;
        drift_together(0.5 * step);
        follow_walls(walls, now, step);
        touch(PairKind::deformable, step, course);
        course.gravity_lag += step;
        deformable.collect(contact_);
        course.given = course.given + deformable.push(step, gravity_);
        rigid.push({}, step);
        const auto before = static_cast<std::uint32_t>(rigid.size());
        part_if_cracked(now, step, course);
        for (std::uint32_t k = before; k < rigid.size(); ++k) together.push_back(k);
        drift_together(0.5 * step);
        left = steps > 1.0 ? left - step : 0.0;
    }
}

template <int D>
void Bodies<D>::push_rigid(double dt, Course& course) {
    course.gravity_lag = 0.5 * dt;
    touch(PairKind::rigid, dt, course);
    rigid.push(gravity_, dt);
}

template <int D>
void Bodies<D>::touch(PairKind kind, double dt, Course& course) {
    if (2.0 * moved_ >= margin_) show_bodies(all_points_), find_contacts();
    show(kind);
    contacts_.apply(contact_, kind, dt);
    const Array<std::size_t> struck =
        breakable_.struck(contacts_, kind, deformable, rigid.size());
    if (!struck.empty()) {
        contacts_.revert(kind);
        make_deformable(struck, course);
        show(kind);
        contacts_.apply(contact_, kind, dt);
    }
    add_loads(kind, dt);
    rigid.collect(contact_, contacts_.points(kind));
}

template <int D>
void Bodies<D>::make_deformable(const Array<std::size_t>& struck, Course& course) {
    const Fragments<D> before = deformable.as_they_are();
    for (const std::size_t n : struck) {
        RigidBodyState<D>& state = rigid.state(breakable_[n].rigid);
        state.velocity = state.velocity + course.gravity_lag * gravity_;
    }
    const BodySums<D> had = rigid.sums();
    const double kinetic = deformable.kinetic_energy();
    for (const std::size_t n : struck) {
        BreakableBody<D>& body = breakable_[n];
        RigidBodyState<D>& state = rigid.state(body.rigid);
        const Quaternion now = rigid.orientation(body.rigid);
        const Mat<double, 3> turn = now.matrix() * transposed(body.orientation.matrix());
        deformable.make_deformable(
            body.deformable,
            {body.centre, state.centre, state.velocity, state.angular_momentum, turn},
            state.acceleration);
        rigid.take_out(body.rigid);
        body.deforms_for = 0.0;
    }
    const BodySums<D> gone = rigid.sums().less(had);
    course.before = course.before + gone;
    course.given.parting_work -= gone.kinetic_energy + (deformable.kinetic_energy() - kinetic);
    change_breakable(struck, before);
}

/// A body that is whole and has come to rest within itself is rigid again, with the momenta that it
/// has; what it still has of vibration counts as damped.
template <int D>
void Bodies<D>::make_rigid_again(double dt, Course& course) {
    Array<std::size_t> still;
    for (std::size_t n = 0; n < breakable_.size(); ++n) {
        BreakableBody<D>& body = breakable_[n];
        if (deformable.solids().is_rigid(body.deformable)) continue;
        body.deforms_for += dt;
        if (is_still(body)) still.push_back(n);
    }
    if (still.empty()) return;
    const Fragments<D> before = deformable.as_they_are();
    const BodySums<D> had = rigid.sums();
    for (const std::size_t n : still) {
        const BreakableBody<D>& body = breakable_[n];
        const auto& solids = deformable.solids();
        const RigidMotion<D> motion = rigid_motion<D>(solids, solids.points_of(body.deformable));
        const Mat<double, 3> turn = motion.orientation.matrix();
        const Vec<double, D> centre =
            motion.centre + rotated(turn, body.centre - motion.rest_centre);
        const Vec3 own = motion.angular_momentum +
                         motion.mass * cross(in_space(motion.centre - centre),
                                             in_space(motion.velocity));
        rigid.put_back(body.rigid, centre, motion.velocity,
                       motion.orientation.after(body.orientation), own);
        deformable.make_rigid(body.deformable, rigid.kinetic_energy_of(body.rigid));
    }
    course.before = course.before + rigid.sums().less(had);
    change_breakable(still, before);
}

/// Whether it has no crack, has had time for waves to go to and fro, and has but a small part of
/// the energy with which a crack begins, Eq. (141).
template <int D>
bool Bodies<D>::is_still(const BreakableBody<D>& body) const {
    constexpr double crossings = 20.0;  // of waves, before anything is judged
    constexpr double share = 0.2;       // of the tension that it bears
    const auto& solids = deformable.solids();
    const DeformableBody& material = solids.material(body.deformable);
    if (body.deforms_for * material.wave_speed() < crossings * body.diameter) return false;
    if (solids.is_cracked(body.deformable)) return false;
    const Array<std::uint32_t> points = solids.points_of(body.deformable);
    const RigidMotion<D> motion = rigid_motion<D>(solids, points);
    const double stress = share * body.strength,
                 enough = motion.mass / material.rho0 * stress * stress /
                          (2.0 * material.young_modulus());
    double kinetic = -0.5 * motion.mass * dot(motion.velocity, motion.velocity) -
                     0.5 * dot(motion.spin, motion.angular_momentum);
    for (const std::uint32_t p : points)
        kinetic += 0.5 * solids.mass(p) * dot(solids.v[p], solids.v[p]);
    return kinetic + solids.strain_energy(points) <= enough;
}

/// Contacts of bodies that have changed begin with the overlaps that they have at rest, Eq. (115).
template <int D>
void Bodies<D>::change_breakable(const Array<std::size_t>& which, const Fragments<D>& before) {
    prepare_contacts();
    renumber_contacts(before);
    std::set<std::int32_t> changed;
    for (const std::size_t n : which) {
        changed.insert(static_cast<std::int32_t>(breakable_[n].rigid));
        changed.insert(static_cast<std::int32_t>(rigid.size() + breakable_[n].deformable));
    }
    contacts_.accept_overlaps(contact_, [&](const ContactPair& pair) {
        const auto [a, b] = contact_.bodies(pair);
        return changed.contains(a) || changed.contains(b);
    });
    rebinds_ = true;
}

}  // namespace doseki
