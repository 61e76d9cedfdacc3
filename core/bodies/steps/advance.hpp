#pragma once
// Steps of bodies, of which some may be rigid until they are struck, which bodies.cpp compiles.

#include <cmath>

#include "bodies/bodies.hpp"
#include "bodies/fragments/rigid_motion.hpp"

namespace doseki {

template <int D>
BodyStep<D> Bodies<D>::advance(const MovingWalls<D>& walls, double t, double dt) {
    if (!any_moves() || dt <= 0.0) return {};
    Course course{.before = rigid.sums(), .half = 0.5 * dt};
    rigid.begin_step(dt), deformable.begin_step(dt);
    deformable_step_ = deformable.timestep();
    wall_speed_ = rigid.speed_of_walls(walls, t);
    if (breakable_.any())
        contacts_.forget_forces(), advance_apart(walls, t, dt, course);  // a checkpoint has none
    else
        advance_together(walls, t, dt, course);
    deformable.end_step(dt, memory_);
    rigid.end_step(dt, memory_);
    if (breakable_.any()) make_rigid_again(dt, course);
    return course.given + rigid.sums().since(course.before, gravity_);
}

template <int D>
double Bodies<D>::steps_of(double time, double longest) {
    const double steps = std::max(1.0, std::ceil(time / longest));
    if (!(steps <= most_contact_steps))
        throw PhysicsFailure("bodies are too fast for their contacts to be followed",
                             FailureKind::speed);
    return steps;
}

/// Looks for contacts where bodies might meet within a step that were not known when its length was
/// chosen: a step without contacts is much too long for one, whose first overlap would be deep.
/// Returns whether it did.
template <int D>
bool Bodies<D>::look_ahead(double step) {
    const double way = step * (speed_ + 0.5 * step * norm(gravity_));
    if (moved_ == 0.0 || 2.0 * (moved_ + way) < margin_) return false;
    show_bodies(all_points_), find_contacts();
    return true;
}

/// Half a step of all that moves. Walls go along, so that contacts see both sides where they are
/// at one time, whatever moves the two of them together.
template <int D>
void Bodies<D>::drift(const MovingWalls<D>& walls, double t, double dt) {
    moved_ += std::max(deformable.drift(dt), rigid.drift(dt));
    follow_walls(walls, t, dt);
}

template <int D>
void Bodies<D>::follow_walls(const MovingWalls<D>& walls, double t, double dt) {
    const auto step = rigid.follow_walls(walls, t, dt);
    if (step.any_removed) moved_ = margin_;
    moved_ += step.distance;
}

/// Position Verlet in the steps of eq. (52): contacts see the velocities of the middle of a step.
template <int D>
void Bodies<D>::advance_together(const MovingWalls<D>& walls, double t, double dt, Course& course) {
    for (double left = dt; left > 0.0;) {
        measure_speed();
        double steps = steps_of(left, contact_step());
        if (look_ahead(left / steps)) steps = steps_of(left, contact_step());
        const double step = left / steps, now = t + (dt - left);
        drift(walls, now, 0.5 * step);
        if (2.0 * moved_ >= margin_)
            show_bodies(all_points_), find_contacts();
        else if (contacts_.any(PairKind::all))
            show(PairKind::all);
        contacts_.apply(contact_, PairKind::all, moved_, step);
        add_loads(PairKind::all, step);
        rigid.collect(contact_, contacts_.points(PairKind::all)), deformable.collect(contact_);
        if (!deformable.empty()) push_deformable(step, course);
        rigid.push(gravity_, step);
        course.on_rigid += step, course.on_points += step;
        part_if_cracked(now, step, course);
        drift(walls, now + 0.5 * step, 0.5 * step);
        left = steps > 1.0 ? left - step : 0.0;
    }
}

/// Dust that was born where there was little room is smaller than its mass: if contacts were looked
/// for whenever it has gone a part of its radius, that would take most of the time.
template <int D>
void Bodies<D>::choose_margin() {
    constexpr double share = 0.3;  // of a radius
    const double points = deformable.smallest_radius();
    auto radius = [this](std::size_t k) { return share * rigid.shape(k).radius; };
    auto reach = [&](std::size_t k) { return is_dust(k) ? rigid.gyration(k) : radius(k); };
    auto finite_or_none = [](double length) { return std::isfinite(length) ? length : 0.0; };
    margin_ = finite_or_none(std::min(rigid.smallest(reach), points));
    longest_way_ = finite_or_none(0.25 * std::min(rigid.smallest(radius), points));
}

template <int D>
void Bodies<D>::find_companions() {
    if (!breakable_.any()) return;
    Array<std::uint8_t> is_companion(rigid.size(), 0);
    auto mark = [&](std::int32_t k) {
        if (static_cast<std::size_t>(k) < rigid.size())
            is_companion[static_cast<std::size_t>(k)] = 1;
    };
    contacts_.for_each_pair_of(PairKind::fast,
                               [&](std::int32_t a, std::int32_t b) { mark(a), mark(b); });
    companions_.choose(is_companion);
    const Array<std::uint32_t> late = companions_.take_late();
    if (late.empty()) return;
    moved_ += rigid.drift(-companions_.ahead(), late);
    rigid.show(contact_, all_points_);
}

/// The longest of slow contacts, in each half of which are whole short ones.
template <int D>
double Bodies<D>::step_apart(double shorter) const {
    const double longest = longest_step(PairKind::slow),
                 halves = std::floor(0.5 * longest / shorter);
    return halves >= 1.0 ? 2.0 * halves * shorter : std::min(longest, shorter);
}

/// Eq. (142): slow contacts push once, in the middle of a step, in each half of which what is
/// deformable, dust and what they may touch have steps of their own (Tuckerman, Berne and Martyna,
/// J. Chem. Phys. 97, 1992).
template <int D>
void Bodies<D>::advance_apart(const MovingWalls<D>& walls, double t, double dt, Course& course) {
    for (double left = dt; left > 0.0;) {
        measure_speed();
        double steps = steps_of(left, step_apart(shorter_step()));
        if (look_ahead(left / steps)) steps = steps_of(left, step_apart(shorter_step()));
        const double shorter = shorter_step(), step = left / steps, now = t + (dt - left);
        if (step <= std::min(shorter, deformable.unstrained_timestep()))
            step_at_once(walls, now, step, course);
        else {
            drift_apart(walls, now, 0.5 * step, course);
            push_slow(step, course);
            drift_apart(walls, now + 0.5 * step, 0.5 * step, course);
        }
        left = steps > 1.0 ? left - step : 0.0;
    }
}

/// Where two short steps are longer than a long one, also those of what may be struck in it.
template <int D>
void Bodies<D>::step_at_once(const MovingWalls<D>& walls, double t, double dt, Course& course) {
    drift(walls, t, 0.5 * dt);
    push_slow(dt, course);
    push_fast(t, dt, course);
    drift(walls, t + 0.5 * dt, 0.5 * dt);
}

template <int D>
void Bodies<D>::drift_apart(const MovingWalls<D>& walls, double t, double dt, Course& course) {
    const double ahead = rigid.drift(dt, companions_.others());
    companions_.begin(dt, ahead, rigid.size());
    moved_ += ahead;
    auto drift_together = [&](double now, double step) {
        const double way =
            std::max(deformable.drift(step), rigid.drift(step, companions_.together()));
        moved_ += companions_.catch_up(step, way);
        follow_walls(walls, now, step);
    };
    for (double left = dt; left > 0.0;) {
        measure_speed();
        const double steps = steps_of(left, shorter_step()), step = left / steps,
                     now = t + (dt - left);
        drift_together(now, 0.5 * step);
        const std::size_t before = rigid.size();
        if (!companions_.together().empty() || deformable.any_deforms())
            push_fast(now, step, course);
        else
            course.on_points += step;
        companions_.take_born(before, rigid.size());
        drift_together(now + 0.5 * step, 0.5 * step);
        left = steps > 1.0 ? left - step : 0.0;
    }
    companions_.end();
}

template <int D>
void Bodies<D>::push_slow(double dt, Course& course) {
    touch(PairKind::slow, dt, course);
    rigid.push(gravity_, dt);
    course.on_rigid += dt;
}

template <int D>
void Bodies<D>::push_fast(double t, double dt, Course& course) {
    touch(PairKind::fast, dt, course);
    rigid.push_by_contacts(dt);
    course.on_points += dt;
    if (!deformable.any_deforms()) return;
    deformable.collect(contact_);
    push_deformable(dt, course);
    part_if_cracked(t, dt, course);
}

/// What is pressed together becomes stiffer within a step of the run.
template <int D>
void Bodies<D>::push_deformable(double dt, Course& course) {
    course.given = course.given + deformable.push(dt, gravity_);
    deformable_step_ = deformable.timestep();
}

template <int D>
void Bodies<D>::touch(PairKind kind, double dt, Course& course) {
    if (2.0 * moved_ >= margin_) show_bodies(all_points_), find_contacts();
    show(kind);
    contacts_.apply(contact_, kind, moved_, dt);
    auto of_dust = [this](std::int32_t k) {
        const auto body = static_cast<std::size_t>(k);
        return body < rigid.size() && is_dust(body);
    };
    const Array<std::size_t> struck =
        breakable_.struck(contacts_, contact_, kind, deformable, rigid, of_dust);
    if (!struck.empty()) {
        contacts_.revert(kind);
        make_deformable(struck, course);
        show(kind);
        contacts_.apply(contact_, kind, moved_, dt);
    }
    add_loads(kind, dt);
    rigid.collect(contact_, contacts_.points(kind));
}

template <int D>
void Bodies<D>::make_deformable(const Array<std::size_t>& struck, Course& course) {
    const Fragments<D> before = deformable.as_they_are();
    for (const std::size_t n : struck) {
        rigid.push_by_gravity(breakable_[n].rigid, gravity_, course.on_points - course.on_rigid);
        rigid.push_by_flow(breakable_[n].rigid, course.half - course.on_rigid);
    }
    const BodySums<D> had = rigid.sums();
    const double kinetic = deformable.kinetic_energy();
    for (const std::size_t n : struck) {
        BreakableBody<D>& body = breakable_[n];
        RigidBodyState<D>& state = rigid.state(body.rigid);
        deformable.make_deformable(
            body.deformable,
            {body.centre, state.centre, state.velocity, state.angular_momentum, body.turned(rigid)},
            state.acceleration);
        deformable.set_unwetted(body.deformable, state.unwetted);
        rigid.take_out(body.rigid);
        body.deforms_for = body.loudness = 0.0;
    }
    const BodySums<D> gone = rigid.sums().less(had);
    course.before = course.before + gone;
    course.given.parting_work -= gone.kinetic_energy + (deformable.kinetic_energy() - kinetic);
    change_breakable(struck, before);
}

/// A body that has come to rest within itself is rigid, again or, if it is a part, at last, with
/// the shape and the momenta that it has; what it still has of vibration counts as damped.
template <int D>
void Bodies<D>::make_rigid_again(double dt, Course& course) {
    Array<std::size_t> still;
    for (std::size_t n = 0; n < breakable_.size(); ++n) {
        BreakableBody<D>& body = breakable_[n];
        if (body.deforms(deformable) && becomes_still(body, dt)) still.push_back(n);
    }
    if (still.empty()) return;
    const Fragments<D> before = deformable.as_they_are();
    const BodySums<D> had = rigid.sums();
    deformable.show(contact_);
    const auto first = static_cast<std::int32_t>(rigid.size());
    for (const std::size_t n : still)
        make_rigid(n, first + static_cast<std::int32_t>(breakable_[n].deformable));
    course.before = course.before + rigid.sums().less(had);
    breakable_.index(rigid.size(), deformable);
    change_breakable(still, before);
}

/// `shown`: its number among the bodies that touch.
template <int D>
void Bodies<D>::make_rigid(std::size_t n, std::int32_t shown) {
    const BreakableBody<D>& body = breakable_[n];
    const auto& solids = deformable.solids();
    const RigidMotion<D> motion = rigid_motion<D>(solids, solids.points_of(body.deformable));
    if (!body.has_rigid()) add_rigid(n, motion, shown);
    const Mat<double, 3> turn = motion.orientation.matrix();
    const Vec<double, D> centre = motion.centre + rotated(turn, body.centre - motion.rest_centre);
    const Vec3 own = motion.angular_momentum + motion.mass * cross(in_space(motion.centre - centre),
                                                                   in_space(motion.velocity));
    rigid.put_back(body.rigid, centre, motion.velocity, motion.orientation.after(body.orientation),
                   own);
    rigid.state(body.rigid).unwetted = deformable.unwetted(body.deformable);
    deformable.make_rigid(body.deformable, motion, rigid.kinetic_energy_of(body.rigid));
    breakable_.weigh_cracks(n, deformable);
}

/// The shape of a part is the one that it has when it is rigid for the first time.
template <int D>
void Bodies<D>::add_rigid(std::size_t n, const RigidMotion<D>& motion, std::int32_t shown) {
    const std::size_t b = breakable_[n].deformable, k = rigid.size();
    const Mat<double, 3> turn = motion.orientation.matrix(), back = transposed(turn);
    const RigidBody<D> body{0,           deformable.material(b),      deformable.group(b), false,
                            motion.mass, back * motion.inertia * turn};
    RigidBodyState<D> state{};
    state.orientation = motion.orientation;
    rigid.add(body, state, deformable.shape_of(contact_, shown, b, motion));
    rigid_origins_.add(deformable_origins_[b]);
    breakable_.give_rigid(n, k, motion.rest_centre, deformable);
    const auto& solids = deformable.solids();
    auto at_rest = [&turn](const Vec<double, D>& v) { return rotated_back(turn, v); };
    for (const std::uint32_t p : solids.points_of(b))
        deformable.set_rigid_point(
            p, rigid_particles_.add(k, at_rest(solids.x[p] - motion.centre),
                                    at_rest(deformable.normal(p)), at_rest(deformable.area(p)),
                                    each_row(deformable.edge_normals(p), at_rest)));
}

/// Whether it has had time for waves to go to and fro, and has lately had but a small
/// part of the energy with which a crack begins, Eq. (141), and bears but a small load.
template <int D>
bool Bodies<D>::becomes_still(BreakableBody<D>& body, double dt) {
    constexpr double crossings = 20.0;  // of waves, before anything is judged
    constexpr double share = 0.2;       // of the tension that it bears
    const auto& solids = deformable.solids();
    const DeformableBody& material = solids.material(body.deformable);
    const Array<std::uint32_t> points = solids.points_of(body.deformable);
    const RigidMotion<D> motion = rigid_motion<D>(solids, points);
    double vibration = -0.5 * motion.mass * dot(motion.velocity, motion.velocity) -
                       0.5 * dot(motion.spin, motion.angular_momentum);
    double force = 0.0;
    for (const std::uint32_t p : points) {
        vibration += 0.5 * solids.mass(p) * dot(solids.v[p], solids.v[p]);
        force += 0.5 * norm(solids.load[p]);
    }
    body.deforms_for += dt;
    body.loudness = std::max(vibration, body.loudness * std::exp(-dt / body.lately(deformable)));
    const double stress = share * body.strength, volume = motion.mass / material.rho0,
                 enough = volume * stress * stress / (2.0 * material.young_modulus());
    if (!(body.deforms_for > crossings * body.crossing(deformable) && body.loudness <= enough))
        return false;
    const double most = share * body.bears;
    return !(pressed_tension<D>(force, body.diameter) > most || body.bent(solids, motion) > most);
}

/// Contacts of bodies that have changed begin with the overlaps that they have at rest, Eq. (115).
template <int D>
void Bodies<D>::change_breakable(const Array<std::size_t>& which, const Fragments<D>& before) {
    const std::size_t solids = contact_.solids.size();
    prepare_contacts();
    renumber_contacts(before, solids);
    std::set<std::int32_t> changed;
    for (const std::size_t n : which) {
        changed.insert(static_cast<std::int32_t>(breakable_[n].rigid));
        changed.insert(static_cast<std::int32_t>(rigid.size() + breakable_[n].deformable));
    }
    auto is_new = [&](const ContactPair& pair, bool) {
        const auto [a, b] = contact_.bodies(pair);
        return changed.contains(a) || changed.contains(b);
    };
    constexpr bool have_met = false;  // surfaces of deformable balls lie within rigid ones
    contacts_.accept_overlaps(contact_, is_new, have_met);
    rebinds_ = true;
}

}  // namespace doseki
