#pragma once
#include <algorithm>
#include <limits>
#include <span>

#include "base/array.hpp"
#include "bodies/contact/seams.hpp"
#include "bodies/contact/shown_points.hpp"
#include "bodies/rigid_body.hpp"
#include "bodies/rigid_spans.hpp"
#include "boundaries/moving_walls.hpp"
#include "model/body_step.hpp"

namespace doseki {

/// How a body is turned and turns.
struct BodyPose {
    Mat<double, 3> rotation;
    Vec3 spin;
};

/// Of bodies at the start of a step.
template <int D>
struct BodiesBefore {
    std::span<Vec<double, D>> velocity, impulse;
    std::span<Vec3> spin;
};

/// The motion of rigid bodies: their state, its steps under the forces of contacts and fluid, and
/// the points at which contacts find them. Loops over them run where the bodies are: they are in
/// steps/rigid_steps.cpp and steps/rigid_contacts.cpp.
template <int D>
class RigidBodies {
public:
    Array<Shape<D>> shapes;
    SharedSurface<D> ground;  // of a run on a terrain

    bool any_moves() const { return moving_ > 0; }
    std::size_t size() const { return bodies_.size(); }
    const RigidBody<D>& body(std::size_t k) const { return bodies_[k]; }
    const RigidBodyState<D>& state(std::size_t k) const { return states_[k]; }
    RigidBodyState<D>& state(std::size_t k) { return states_[k]; }
    const Shape<D>& shape(std::size_t k) const {
        return shapes[static_cast<std::size_t>(bodies_[k].shape)];
    }
    bool is_free(std::size_t k) const { return seen().is_free(k); }
    /// Mean over the last step.
    const Vec<double, D>& contact_force(std::size_t k) const { return mean_contact_force_[k]; }
    Vec3 spin(std::size_t k) const { return seen().spin(k); }
    /// As loops over them refer to them.
    RigidBodiesSeen<D> seen() const {
        return {bodies_, states_, inverse_inertia_, turns_alike_, shapes};
    }
    RigidBodiesMoved<D> moved() {
        return {seen(), states_, contact_force_, contact_torque_, ball_turn_};
    }

    void add(const RigidBody<D>& body, const RigidBodyState<D>& state, const Vec3& spin);
    /// Gives a ball with a shape of its own another radius.
    void resize_ball(std::size_t k, double radius) {
        shapes[static_cast<std::size_t>(bodies_[k].shape)].radius = radius;
    }
    /// Adds a body within a step, with a shape of its own and the angular momentum of its state.
    void add(RigidBody<D> body, const RigidBodyState<D>& state, const Shape<D>& own);

    /// Finds which surfaces fixed bodies make that never part; call once the bodies are in.
    void find_seams(const MotionsOfBodies<D>& motions, const Domain<D>& domain);
    /// Adds the bodies to those that may touch; the first that are added.
    void add_to(ContactBodies<D>& contact);
    /// Shows the contacts where the bodies are, and those of their contact points, which have no
    /// force then.
    void show(ContactBodies<D>& contact, const ShownPoints& points);
    /// Takes the forces on the points that were shown.
    void collect(ContactBodies<D>& contact, const ShownPoints& points);

    /// Half a step of the forces of the fluid.
    void kick(double half_dt);
    /// Begins a step of length dt after the first kick, whose force acts all through it instead.
    void begin_step(double dt);
    /// Positions and orientations; returns the largest distance that a point of a surface goes.
    double drift(double dt);
    /// The same of some bodies.
    double drift(double dt, std::span<const std::uint32_t> which);
    /// Velocities, by gravity, contacts and the fluid.
    void push(const Vec<double, D>& gravity, double dt);
    void push_by_contacts(double dt);
    /// How a body is turned within a step.
    Quaternion orientation(std::size_t k) const {
        return states_[k].orientation.turned(ball_turn_[k]);
    }
    void push_by_gravity(std::size_t k, const Vec<double, D>& gravity, double dt) {
        moved().push_by_gravity(k, gravity, dt);
    }
    void push_by_flow(std::size_t k, double dt) { moved().push_by_flow(k, dt); }
    /// Takes a body out, and puts it back in the middle of a step with this motion.
    void take_out(std::size_t k) { states_[k].removed = 1.0; }
    void put_back(std::size_t k, const Vec<double, D>& centre, const Vec<double, D>& velocity,
                  const Quaternion& orientation, const Vec3& angular_momentum);
    /// Averages accelerations over the time `memory`.
    void end_step(double dt, double memory);

    /// What fixed bodies did in a step.
    struct WallStep {
        double distance = 0.0;  // the largest
        bool any_removed = false;
    };
    /// Takes them from t to t + dt, within which no motion changes.
    WallStep follow_walls(const MovingWalls<D>& walls, double t, double dt);
    /// Largest speed of a point of a fixed body that moves at t.
    double speed_of_walls(const MovingWalls<D>& walls, double t) const;

    /// Removes the free bodies whose centre is in the region, and tells which.
    template <class Region>
    Array<std::uint8_t> remove_inside(const Region& region) {
        Array<std::uint8_t> leaves(size(), 0);
        for (std::size_t k = 0; k < size(); ++k)
            if (is_free(k) && region.contains(states_[k].centre))
                leaves[k] = 1, states_[k].removed = 1;
        return leaves;
    }

    double max_speed() const;
    /// The smallest length(k) of the bodies that may move; infinite without any.
    template <class Length>
    double smallest(const Length& length) const {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < size(); ++k)
            if (!bodies_[k].fixed) least = std::min(least, length(k));
        return least;
    }
    /// Mass that meets others [kg], 2-D: [kg/m]: infinite where it is fixed.
    double striking_mass(std::size_t k) const {
        return bodies_[k].fixed ? std::numeric_limits<double>::infinity() : bodies_[k].mass;
    }
    /// Radius of gyration [m]: how far the mass of a body reaches, in 2-D and of balls.
    double gyration(std::size_t k) const {
        return std::sqrt(bodies_[k].inertia(2, 2) / bodies_[k].mass);
    }
    BodySums<D> sums() const;
    double kinetic_energy() const { return sums().kinetic_energy; }
    double kinetic_energy_of(std::size_t k) const { return seen().kinetic_energy(k); }

    void serialise(Archive& archive) {
        RigidBodyColumns<D> columns;
        if (!archive.loads()) columns = RigidBodyColumns<D>(shapes, bodies_);
        columns.serialise(archive);
        archive("bodies", states_);
        if (archive.loads()) restore(columns);
    }

private:
    BodiesBefore<D> before() { return {velocity_before_, impulse_before_, spin_before_}; }
    /// Whether a body turns about all axes alike, as balls do.
    static bool turns_alike(const Mat<double, 3>& inertia);
    Mat<double, 3> inverse_of_inertia(std::size_t k) const;
    void restore(const RigidBodyColumns<D>& columns);

    Array<RigidBody<D>> bodies_;
    Array<RigidBodyState<D>> states_;
    Array<Mat<double, 3>> inverse_inertia_;
    Array<std::uint8_t> turns_alike_;
    Array<Vec<double, D>> contact_force_;
    Array<Vec3> contact_torque_;
    Array<Vec<double, D>> mean_contact_force_;
    Array<Vec<double, D>> velocity_before_, impulse_before_;  // at the start of a step
    Array<Vec3> spin_before_;
    Array<Vec3> ball_turn_;
    Array<BodyPose> poses_;  // of bodies that were shown
    Array<std::uint32_t> fixed_;
    Seams<D> seams_;
    std::size_t moving_ = 0;
};

template <int D>
void RigidBodies<D>::add(const RigidBody<D>& body, const RigidBodyState<D>& state,
                         const Vec3& spin) {
    bodies_.push_back(body), states_.push_back(state);
    turns_alike_.push_back(D == 2 || turns_alike(body.inertia));
    inverse_inertia_.push_back(turns_alike_.back() || body.fixed ? Mat<double, 3>{}
                                                                 : inverse(body.inertia, 0.0));
    contact_force_.push_back({}), contact_torque_.push_back({}), mean_contact_force_.push_back({});
    ball_turn_.push_back({});
    if (body.fixed) fixed_.push_back(static_cast<std::uint32_t>(size() - 1));
    const Mat<double, 3> R = state.orientation.matrix();
    states_.back().angular_momentum = rotated(R, body.inertia * rotated_back(R, spin));
    moving_ += !body.fixed;
}

template <int D>
void RigidBodies<D>::add(RigidBody<D> body, const RigidBodyState<D>& state, const Shape<D>& own) {
    body.shape = static_cast<std::int32_t>(shapes.size());
    shapes.push_back(own);
    add(body, state, Vec3{});
    states_.back().angular_momentum = state.angular_momentum;
    velocity_before_.push_back(state.velocity), impulse_before_.push_back({});
    spin_before_.push_back(spin(size() - 1));
}

/// Makes the bodies of an archive, in whose state they are already.
template <int D>
void RigidBodies<D>::restore(const RigidBodyColumns<D>& columns) {
    const Array<RigidBodyState<D>> states = std::move(states_);
    columns.expect_fit_of(states.size());
    shapes = columns.shapes(ground);
    bodies_.clear(), states_.clear(), moving_ = 0;
    inverse_inertia_.clear(), turns_alike_.clear(), ball_turn_.clear(), fixed_.clear();
    contact_force_.clear(), contact_torque_.clear(), mean_contact_force_.clear();
    for (std::size_t k = 0; k < states.size(); ++k) add(columns.rigid(k), states[k], Vec3{});
    states_ = states;
}

template <int D>
bool RigidBodies<D>::turns_alike(const Mat<double, 3>& I) {
    bool alike = I(0, 0) == I(1, 1) && I(1, 1) == I(2, 2);
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) alike = alike && (a == b || I(a, b) == 0.0);
    return alike;
}

template <int D>
Mat<double, 3> RigidBodies<D>::inverse_of_inertia(std::size_t k) const {
    if (!turns_alike_[k]) return inverse_inertia_[k];
    return (1.0 / bodies_[k].inertia(2, 2)) * identity<double, 3>();
}

template <int D>
void RigidBodies<D>::add_to(ContactBodies<D>& contact) {
    for (std::size_t k = 0; k < size(); ++k) {
        const RigidBody<D>& body = bodies_[k];
        const auto number = static_cast<std::int32_t>(k);
        const double diameter = 2.0 * shape(k).radius;
        ContactSide side{body.material, shape(k).radius, body.mass, diameter,
                         body.fixed,    false,           false};
        if (shape(k).is_ball()) {
            contact.points.add(number, side);
            continue;
        }
        side.radius = 0.0;
        const bool balls = shape(k).kind == ShapeKind::balls;
        if (balls) side.radius = 0.5 * shape(k).thickness;
        for (std::size_t n = 0; n < shape(k).samples.size(); ++n) {
            contact.points.add(number, side, shape(k).samples[n], shape(k).outward[n]);
            if (balls) continue;
            contact.points.solid.back() = static_cast<std::int32_t>(contact.solids.size());
            contact.points.corner.back() = shape(k).is_corner[n];
        }
        if (balls) continue;
        ContactSolid<D> solid;
        solid.body = number, solid.material = body.material, solid.fixed = body.fixed;
        solid.mass = body.mass, solid.diameter = diameter;
        solid.surface = shape(k).surface.get();
        if (!body.fixed) solid.inverse_inertia = inverse_of_inertia(k);
        const Mat<double, 3> turn = states_[k].orientation.matrix();
        if (body.fixed) solid.middle = rotated_back(turn, shape(k).middle(turn));
        contact.solids.push_back(solid);
    }
    seams_.show(contact);
}

template <int D>
void RigidBodies<D>::find_seams(const MotionsOfBodies<D>& motions, const Domain<D>& domain) {
    auto part_never = [&](std::size_t a, std::size_t b) {
        const WallMotion<D>*one = motions.of(bodies_[a].group),
              *other = motions.of(bodies_[b].group);
        return one && other ? one->is_that_of(*other) : one == other;
    };
    ContactBodies<D> contact;
    seams_ = {};
    add_to(contact), show(contact, ShownPoints::all_of(contact.points));
    Array<Standing<D>> standing(contact.solids.size());
    for (std::size_t s = 0; s < standing.size(); ++s) {
        const auto k = static_cast<std::size_t>(contact.solids[s].body);
        if (!bodies_[k].fixed) continue;
        standing[s].with = static_cast<std::int32_t>(*std::ranges::find_if(
            fixed_, [&](std::uint32_t first) { return part_never(first, k); }));
        if (shape(k).thickness == 0.0) standing[s].facets = &shape(k).facets;
    }
    seams_ = {contact, standing, domain};
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
double RigidBodies<D>::speed_of_walls(const MovingWalls<D>& walls, double t) const {
    double fastest = 0.0;
    for (const std::uint32_t k : fixed_)
        if (const WallMotion<D>* motion = walls.motions().of(bodies_[k].group);
            motion && motion->moves(t))
            fastest = std::max(fastest, norm(motion->velocity_at(states_[k].centre, t)) +
                                            shape(k).radius * norm(motion->spin_at(t)));
    return fastest;
}

template <int D>
auto RigidBodies<D>::follow_walls(const MovingWalls<D>& walls, double t, double dt) -> WallStep {
    WallStep step;
    for (const std::uint32_t k : fixed_) {
        const WallMotion<D>* motion = walls.motions().of(bodies_[k].group);
        if (!motion) continue;
        RigidBodyState<D>& state = states_[k];
        const Vec<double, D> before = state.centre;
        if (motion->moves(t)) state.centre = motion->moved(before, t, dt);
        const Vec<double, D> move = state.centre - before;
        state.velocity =
            motion->moves(t) ? motion->moving_velocity(state.centre, t + dt) : Vec<double, D>{};
        state.angular_momentum = motion->spin_at(t);
        const Vec3 turn = dt * motion->spin_at(t);
        state.orientation = state.orientation.turned(turn);
        step.distance = std::max(step.distance, norm(move) + shape(k).radius * norm(turn));
        if (motion->removed_at > 0.0 && motion->removed_at <= t && !state.is_removed())
            state.removed = 1.0, step.any_removed = true;
    }
    return step;
}

// Compiled once: bodies.cpp.
extern template class RigidBodies<2>;
extern template class RigidBodies<3>;

}  // namespace doseki
