#pragma once
#include <algorithm>
#include <vector>

#include "bodies/contacts.hpp"
#include "elastic/deformable_bodies.hpp"
#include "exchange.hpp"
#include "particles.hpp"
#include "walls.hpp"

namespace doseki {

/// A rigid body, as given at the start.
template <int D>
struct RigidBody {
    std::int32_t shape = 0, material = 0, body = 0;  // body: the named one that it belongs to
    bool fixed = false;                              // moves only as its wall does
    double mass = 0.0;                               // [kg], 2-D: [kg/m]
    Mat<double, 3> inertia{};  // about the centre, in its own frame; 2-D: zz alone
};

/// What changes of a rigid body; numbers only, so that it can be archived as they are.
template <int D>
struct BodyState {
    Vec<double, D> centre, velocity;
    Quaternion orientation;
    Vec3 angular_momentum;
    Vec<double, D> acceleration;  // mean of late
    Vec3 spin_rate;
    Vec<double, D> flow_force;  // of the fluid
    Vec3 flow_torque;
    double removed;  // 1: gone
};

/// A point of the surface or inside of a rigid body, in its frame; numbers only, as BodyState.
template <int D>
struct BodyPoint {
    double body;
    Vec<double, D> offset, normal;

    std::int32_t index() const { return static_cast<std::int32_t>(body); }
};

/// Shapes and rigid bodies as one vector for each member, as archives keep them.
template <int D>
struct BodyColumns {
    std::vector<double> radius, mass;
    std::vector<Vec<double, D>> corners, samples;  // of all shapes in turn
    std::vector<std::int32_t> facet_count, sample_count, shape, material, body;
    std::vector<std::uint8_t> fixed;
    std::vector<Mat<double, 3>> inertia;

    BodyColumns() = default;
    BodyColumns(const std::vector<Shape<D>>& shapes, const std::vector<RigidBody<D>>& bodies) {
        for (const Shape<D>& each : shapes) {
            radius.push_back(each.radius);
            for (const auto& facet : each.facets)
                corners.insert(corners.end(), facet.begin(), facet.end());
            samples.insert(samples.end(), each.samples.begin(), each.samples.end());
            facet_count.push_back(static_cast<std::int32_t>(each.facets.size()));
            sample_count.push_back(static_cast<std::int32_t>(each.samples.size()));
        }
        for (const RigidBody<D>& each : bodies) {
            shape.push_back(each.shape), material.push_back(each.material),
                body.push_back(each.body);
            fixed.push_back(each.fixed), mass.push_back(each.mass), inertia.push_back(each.inertia);
        }
    }

    template <class Archive>
    void serialise(Archive& archive) {
        archive("shape_radius", radius), archive("shape_corners", corners),
            archive("shape_samples", samples);
        archive("shape_facets", facet_count), archive("shape_sample_count", sample_count);
        archive("body_shape", shape), archive("body_material", material),
            archive("body_named", body);
        archive("body_fixed", fixed), archive("body_mass", mass), archive("body_inertia", inertia);
    }

    std::vector<Shape<D>> shapes() const {
        std::vector<Shape<D>> result(radius.size());
        auto corner = corners.begin(), sample = samples.begin();
        for (std::size_t k = 0; k < result.size(); ++k) {
            result[k].radius = radius[k];
            for (int f = 0; f < facet_count.at(k); ++f, corner += D) {
                result[k].facets.emplace_back();
                std::copy_n(corner, D, result[k].facets.back().begin());
            }
            result[k].samples.assign(sample, sample + sample_count.at(k));
            sample += sample_count[k];
        }
        return result;
    }

    RigidBody<D> rigid(std::size_t k) const {
        return {shape.at(k),      material.at(k), body.at(k),
                fixed.at(k) != 0, mass.at(k),     inertia.at(k)};
    }
};

/// Bodies that move on their own: rigid and deformable ones, and the contacts among them and with
/// walls. They are kicked by the fluid together with it; gravity and contacts, which are stiffer,
/// act in steps of their own within the drift.
template <int D>
class Bodies {
public:
    /// `memory`: time over which accelerations are averaged, as the fluid sees them [s].
    Bodies(const Domain<D>& domain, const Vec<double, D>& gravity, const ContactOptions& options,
           std::vector<Surface> surfaces, double memory)
        : gravity_(gravity), memory_(memory), contacts_(domain, options, std::move(surfaces)) {}

    std::vector<Shape<D>> shapes;
    DeformableBodies<D> deformable;

    bool empty() const { return bodies_.empty() && deformable.empty(); }
    bool any_moves() const { return moving_ > 0 || !deformable.empty(); }
    /// Of the rigid ones.
    std::size_t size() const { return bodies_.size(); }
    const RigidBody<D>& body(std::size_t k) const { return bodies_[k]; }
    const BodyState<D>& state(std::size_t k) const { return states_[k]; }
    /// Of the last contact step.
    const Vec<double, D>& contact_force(std::size_t k) const { return contact_force_[k]; }
    const Contacts<D>& contacts() const { return contacts_; }
    Vec3 spin(std::size_t k) const { return spin_of(k, states_[k].angular_momentum); }

    void add(const RigidBody<D>& body, const BodyState<D>& state, const Vec3& spin);

    /// Makes particle p, where it is now and with the normal that it has, a point of rigid body k.
    void bind(Particles<D>& particles, std::size_t p, std::size_t k) {
        const Mat<double, 3> R = states_[k].orientation.matrix();
        particles.flow.point[p] = static_cast<std::int32_t>(points_.size());
        points_.push_back(
            {static_cast<double>(k),
             rotated_back(R, contacts_.nearest_image(particles.position[p] - states_[k].centre)),
             rotated_back(R, particles.flow.normal[p])});
    }
    /// Index of the rigid body of a particle; -1: none.
    std::int32_t body_of(const Particles<D>& particles, std::size_t p) const {
        return is_rigid_point(particles, p)
                   ? points_[static_cast<std::size_t>(particles.flow.point[p])].index()
                   : -1;
    }

    /// Call once after everything is in.
    void start(Particles<D>& particles) {
        deformable.start(particles, gravity_, contactors_, static_cast<std::int32_t>(size()));
        set_margin();
        pose(), find_contacts();
        set_elastic_step();
    }

    /// Largest step that motion without a fluid may have.
    double timestep() const {
        return any_moves() ? longest_leap * std::min(contacts_.timestep(), elastic_step_)
                           : std::numeric_limits<double>::infinity();
    }

    /// Takes over what the fluid does to the points of bodies. All ranks have all bodies: each
    /// point is a particle of one of them, so that the sums are those of one rank, to the bit.
    void gather(const Particles<D>& particles, const Ranks& ranks);
    void kick(double half_dt);
    /// From t to t + dt, through as many contact steps as it takes.
    void advance(const Walls<D>& walls, double t, double dt);
    /// Puts particles where their bodies are (eq. 53); returns the largest distance that one went.
    double place(Particles<D>& particles) const;
    /// Gives particles the velocity that they have when the fluid will have acted for `ahead` more.
    void set_velocities(Particles<D>& particles, double ahead) const;

    /// Marks in `removed` the particles of bodies whose centre is in the box; returns their mass.
    template <class Box>
    double drain(const Particles<D>& particles, const Box& box, std::vector<std::uint8_t>& removed);

    double kinetic_energy() const;

    template <class Archive>
    void serialise(Archive& archive) {
        BodyColumns<D> columns;
        if constexpr (!Archive::loading) columns = BodyColumns<D>(shapes, bodies_);
        columns.serialise(archive);
        archive("bodies", states_), archive("body_points", points_);
        if constexpr (Archive::loading) restore(columns);
        archive("bodies_moved", moved_);
        deformable.elastic.gravity = gravity_;
        deformable.serialise(archive);
        contacts_.serialise(archive);
        if constexpr (Archive::loading) {
            deformable.restore(contactors_, static_cast<std::int32_t>(size()));
            set_margin();
            pose(), contacts_.restore(contactors_, solids_);
            set_elastic_step();
        }
    }

private:
    /// Steps of contact in one step of the run, where no fluid asks for shorter ones.
    static constexpr double longest_leap = 50.0;

    Vec3 spin_of(std::size_t k, const Vec3& angular_momentum) const;
    void restore(const BodyColumns<D>& columns);
    const Shape<D>& shape_of(std::size_t k) const {
        return shapes[static_cast<std::size_t>(bodies_[k].shape)];
    }
    std::vector<Mat<double, 3>> rotations() const {
        std::vector<Mat<double, 3>> R;
        for (const BodyState<D>& state : states_) R.push_back(state.orientation.matrix());
        return R;
    }
    /// When the fluid will have acted for `ahead` more.
    std::vector<Vec3> spins(double ahead) const {
        std::vector<Vec3> w;
        for (std::size_t k = 0; k < size(); ++k)
            w.push_back(spin_of(k, states_[k].angular_momentum + ahead * states_[k].flow_torque));
        return w;
    }
    bool at_work(std::size_t k) const { return !bodies_[k].fixed && states_[k].removed == 0.0; }
    static bool is_rigid_point(const Particles<D>& particles, std::size_t p) {
        return particles.has_flow && particles.is_bound(p) &&
               !DeformableBodies<D>::is_mark(particles.flow.point[p]);
    }
    void set_margin() {
        if (!deformable.empty())
            margin_ = margin_ > 0.0 ? std::min(margin_, deformable.margin()) : deformable.margin();
    }
    void set_elastic_step() {
        elastic_step_ = deformable.empty() ? std::numeric_limits<double>::infinity()
                                           : deformable.elastic.timestep();
    }
    /// Also short against the margin of the pairs.
    double longest_part() const {
        double fastest = deformable.fastest();
        for (std::size_t k = 0; k < size(); ++k)
            if (at_work(k))
                fastest = std::max(fastest,
                                   norm(states_[k].velocity) + shape_of(k).radius * norm(spin(k)));
        return std::min(
            {contacts_.timestep(), elastic_step_, 0.25 * margin_ / std::max(fastest, 1e-300)});
    }
    void drift(double dt);
    void move_walls(const Walls<D>& walls, double t, double dt);
    void pose();
    void find_contacts();
    void collect_forces();

    Vec<double, D> gravity_;
    double memory_;
    Contacts<D> contacts_;
    std::vector<RigidBody<D>> bodies_;
    std::vector<BodyState<D>> states_;
    std::vector<BodyPoint<D>> points_;
    std::vector<Vec<double, D>> contact_force_;
    std::vector<Vec3> contact_torque_;
    // Views of the bodies for the contacts: contactors in the order of bodies, with the sample of
    // each.
    Contactors<D> contactors_;
    std::vector<Vec<double, D>> sample_;
    std::vector<Solid<D>> solids_;
    std::size_t moving_ = 0;
    double moved_ = 0.0, margin_ = 0.0;
    double elastic_step_ = std::numeric_limits<double>::infinity();  // of deformable bodies [s]
};

template <int D>
void Bodies<D>::add(const RigidBody<D>& body, const BodyState<D>& state, const Vec3& spin) {
    const auto k = static_cast<std::int32_t>(bodies_.size());
    const Shape<D>& shape = shapes.at(static_cast<std::size_t>(body.shape));
    bodies_.push_back(body), states_.push_back(state);
    contact_force_.push_back({}), contact_torque_.push_back({});
    const Mat<double, 3> R = state.orientation.matrix();
    Vec3 local = rotated_back(R, spin), momentum;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) momentum[a] += body.inertia(a, b) * local[b];
    states_.back().angular_momentum = rotated(R, momentum);
    moving_ += !body.fixed;
    const double diameter = 2.0 * shape.radius;
    if (shape.is_ball()) {
        contactors_.add(k, body.material, shape.radius, body.mass, diameter, body.fixed);
        sample_.push_back({});
    } else {
        for (const Vec<double, D>& x : shape.samples) {
            contactors_.add(k, body.material, 0.0, body.mass, diameter, body.fixed);
            sample_.push_back(x);
        }
        Solid<D> solid;
        solid.body = k, solid.material = body.material, solid.fixed = body.fixed,
        solid.mass = body.mass, solid.size = diameter;
        solids_.push_back(solid);
    }
    if (!body.fixed)
        margin_ = margin_ > 0.0 ? std::min(margin_, 0.3 * shape.radius) : 0.3 * shape.radius;
}

/// Makes the bodies of an archive, in whose state they are already.
template <int D>
void Bodies<D>::restore(const BodyColumns<D>& columns) {
    const std::vector<BodyState<D>> states = std::move(states_);
    shapes = columns.shapes();
    bodies_.clear(), states_.clear(), contact_force_.clear(), contact_torque_.clear();
    contactors_ = {}, sample_.clear(), solids_.clear(), moving_ = 0, margin_ = 0.0;
    for (std::size_t k = 0; k < states.size(); ++k) add(columns.rigid(k), states[k], {});
    states_ = states;
}

/// omega = R I^-1 R^T L (eq. 51).
template <int D>
Vec3 Bodies<D>::spin_of(std::size_t k, const Vec3& L) const {
    if (bodies_[k].fixed) return L;
    const Mat<double, 3>& I = bodies_[k].inertia;
    Vec3 spin{};
    if constexpr (D == 2)
        spin[2] = L[2] / I(2, 2);
    else {
        const Mat<double, 3> R = states_[k].orientation.matrix();
        const Vec3 l = rotated_back(R, L);
        // The columns' cross products over the determinant invert a symmetric matrix.
        std::array<Vec3, 3> row;
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) row[a][b] = I(a, b);
        const double determinant = dot(row[0], cross(row[1], row[2]));
        const Vec3 w =
            (1.0 / determinant) * (l[0] * cross(row[1], row[2]) + l[1] * cross(row[2], row[0]) +
                                   l[2] * cross(row[0], row[1]));
        spin = rotated(R, w);
    }
    return spin;
}

template <int D>
void Bodies<D>::gather(const Particles<D>& particles, const Ranks& ranks) {
    if (!any_moves()) return;
    std::vector<Vec<double, D>> force(points_.size());
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (is_rigid_point(particles, p))
            force[static_cast<std::size_t>(particles.flow.point[p])] = particles.flow.wall_force[p];
    ranks.sum(numbers_of(force));
    deformable.gather(particles, ranks);
    for (BodyState<D>& state : states_) state.flow_force = {}, state.flow_torque = {};
    const auto R = rotations();
    for (std::size_t q = 0; q < points_.size(); ++q) {
        const auto k = static_cast<std::size_t>(points_[q].index());
        states_[k].flow_force = states_[k].flow_force + force[q];
        states_[k].flow_torque =
            states_[k].flow_torque +
            cross(in_space(rotated(R[k], points_[q].offset)), in_space(force[q]));
    }
}

template <int D>
void Bodies<D>::kick(double half_dt) {
    if (!deformable.empty()) deformable.kick(half_dt);
    for (std::size_t k = 0; k < size(); ++k) {
        if (!at_work(k)) continue;
        states_[k].velocity =
            states_[k].velocity + (half_dt / bodies_[k].mass) * states_[k].flow_force;
        states_[k].angular_momentum =
            states_[k].angular_momentum + half_dt * states_[k].flow_torque;
    }
}

/// Position Verlet in the steps of eq. (52): contacts see the velocities of the middle of a step.
template <int D>
void Bodies<D>::advance(const Walls<D>& walls, double t, double dt) {
    if (!any_moves() || dt <= 0.0) return;
    std::vector<Vec<double, D>> before(size());
    const auto spin_before = spins(0.0);
    for (std::size_t k = 0; k < size(); ++k) before[k] = states_[k].velocity;
    deformable.begin_step();
    set_elastic_step();
    for (double left = dt; left > 0.0;) {
        const double parts = std::max(1.0, std::ceil(left / longest_part())), part = left / parts;
        drift(0.5 * part);
        move_walls(walls, t + dt - left, part);
        pose();
        if (2.0 * moved_ >= margin_) find_contacts();
        contacts_.apply(contactors_, solids_, part);
        collect_forces();
        if (!deformable.empty()) deformable.elastic.push(part);
        for (std::size_t k = 0; k < size(); ++k) {
            if (!at_work(k)) continue;
            BodyState<D>& state = states_[k];
            state.velocity =
                state.velocity + part * (gravity_ + (1.0 / bodies_[k].mass) * contact_force_[k]);
            state.angular_momentum = state.angular_momentum + part * contact_torque_[k];
        }
        drift(0.5 * part);
        left = parts > 1.0 ? left - part : 0.0;
    }
    deformable.end_step(dt, memory_);
    for (std::size_t k = 0; k < size(); ++k) {
        if (!at_work(k)) continue;
        BodyState<D>& state = states_[k];
        const Vec<double, D> mean =
            (1.0 / dt) * (state.velocity - before[k]) + (1.0 / bodies_[k].mass) * state.flow_force;
        const double share = std::min(1.0, dt / memory_);
        state.acceleration = state.acceleration + share * (mean - state.acceleration);
        state.spin_rate =
            state.spin_rate + share * ((1.0 / dt) * (spin(k) - spin_before[k]) - state.spin_rate);
    }
}

template <int D>
void Bodies<D>::drift(double dt) {
    double farthest = deformable.elastic.drift(dt);
    for (std::size_t k = 0; k < size(); ++k) {
        if (!at_work(k)) continue;
        BodyState<D>& state = states_[k];
        const Vec3 turn = dt * spin(k);
        state.centre = state.centre + dt * state.velocity;
        state.orientation = state.orientation.turned(turn);
        const Shape<D>& shape = shape_of(k);
        const double reach = shape.is_ball() ? 0.0 : shape.radius;
        farthest = std::max(farthest, dt * norm(state.velocity) + reach * norm(turn));
    }
    moved_ += farthest;
}

template <int D>
void Bodies<D>::move_walls(const Walls<D>& walls, double t, double dt) {
    double farthest = 0.0;
    for (std::size_t k = 0; k < size(); ++k) {
        if (!bodies_[k].fixed) continue;
        const WallMotion<D>* motion = walls.motion_of(bodies_[k].body);
        if (!motion) continue;
        BodyState<D>& state = states_[k];
        state.velocity = motion->velocity_at(state.centre, t);
        state.angular_momentum = motion->spin_at(t);  // whose inertia is infinite: kept as a spin
        const Vec<double, D> step =
            motion->moves(t) ? motion->moved(state.centre, t, dt) - state.centre : Vec<double, D>{};
        state.centre = state.centre + step;
        const Vec3 turn = dt * motion->spin_at(t);
        state.orientation = state.orientation.turned(turn);
        farthest = std::max(farthest, norm(step) + shape_of(k).radius * norm(turn));
        if (motion->removed_at > 0.0 && motion->removed_at <= t && state.removed == 0.0)
            state.removed = 1.0, moved_ = margin_;
    }
    moved_ += farthest;
}

/// Shows the contacts where the bodies are.
template <int D>
void Bodies<D>::pose() {
    std::size_t c = 0, s = 0;
    for (std::size_t k = 0; k < size(); ++k) {
        const BodyState<D>& state = states_[k];
        const Shape<D>& shape = shape_of(k);
        const bool ball = shape.is_ball();
        const Vec3 w = spin(k);
        const Mat<double, 3> R = ball ? Mat<double, 3>{} : state.orientation.matrix();
        const Vec<double, D>& centre = state.centre;
        const bool gone = state.removed != 0.0;
        if (!ball) {
            Solid<D>& solid = solids_[s++];
            solid.shape = &shape, solid.centre = centre, solid.velocity = state.velocity,
            solid.rotation = R, solid.spin = w;
            solid.force = {}, solid.torque = {}, solid.gone = gone;
        }
        for (; c < contactors_.size_of_all() && contactors_.body[c] == static_cast<std::int32_t>(k);
             ++c) {
            const Vec<double, D> lever = ball ? Vec<double, D>{} : rotated(R, sample_[c]);
            contactors_.position[c] = centre + lever;
            contactors_.velocity[c] = state.velocity + turning_velocity(w, lever);
            contactors_.spin[c] = w;
            contactors_.force[c] = {}, contactors_.torque[c] = {}, contactors_.gone[c] = gone;
        }
    }
    deformable.pose(contactors_);
}

template <int D>
void Bodies<D>::find_contacts() {
    moved_ = 0.0;
    contacts_.find(contactors_, solids_, margin_);
}

template <int D>
void Bodies<D>::collect_forces() {
    std::fill(contact_force_.begin(), contact_force_.end(), Vec<double, D>{});
    std::fill(contact_torque_.begin(), contact_torque_.end(), Vec3{});
    for (std::size_t c = 0; c < contactors_.size_of_all(); ++c) {
        const auto k = static_cast<std::size_t>(contactors_.body[c]);
        if (k >= size()) break;  // deformable ones come last
        const Vec3 lever = in_space(contactors_.position[c] - states_[k].centre);
        contact_force_[k] = contact_force_[k] + contactors_.force[c];
        contact_torque_[k] = contact_torque_[k] + contactors_.torque[c] +
                             cross(lever, in_space(contactors_.force[c]));
    }
    for (const Solid<D>& solid : solids_) {
        const auto k = static_cast<std::size_t>(solid.body);
        contact_force_[k] = contact_force_[k] + solid.force;
        contact_torque_[k] = contact_torque_[k] + solid.torque;
    }
    deformable.collect(contactors_);
}

template <int D>
double Bodies<D>::place(Particles<D>& particles) const {
    if (!any_moves()) return 0.0;
    const auto R = rotations();
    const auto w = spins(0.0);
    const double bent = deformable.place(
        particles, [this](const Vec<double, D>& r) { return contacts_.nearest_image(r); });
    double farthest = bent * bent;
    const std::size_t n = particles.size();
#pragma omp parallel for schedule(static) reduction(max : farthest) if (n > light_loop)
    for (std::size_t p = 0; p < n; ++p) {
        if (!is_rigid_point(particles, p)) continue;
        const BodyPoint<D>& point = points_[static_cast<std::size_t>(particles.flow.point[p])];
        const auto k = static_cast<std::size_t>(point.index());
        const BodyState<D>& state = states_[k];
        const Vec<double, D> lever = rotated(R[k], point.offset);
        const Vec<double, D> step =
            contacts_.nearest_image(state.centre + lever - particles.position[p]);
        farthest = std::max(farthest, dot(step, step));
        particles.position[p] = particles.position[p] + step;
        particles.flow.normal[p] = rotated(R[k], point.normal);
        particles.acceleration[p] = state.acceleration + turning_velocity(state.spin_rate, lever) +
                                    turning_velocity(w[k], turning_velocity(w[k], lever));
    }
    return std::sqrt(farthest);
}

template <int D>
void Bodies<D>::set_velocities(Particles<D>& particles, double ahead) const {
    if (!any_moves()) return;
    deformable.set_velocities(particles, ahead);
    const auto R = rotations();
    const auto w = spins(ahead);
    const std::size_t n = particles.size();
#pragma omp parallel for schedule(static) if (n > light_loop)
    for (std::size_t p = 0; p < n; ++p) {
        if (!is_rigid_point(particles, p)) continue;
        const BodyPoint<D>& point = points_[static_cast<std::size_t>(particles.flow.point[p])];
        const auto k = static_cast<std::size_t>(point.index());
        particles.velocity[p] = states_[k].velocity +
                                (ahead / bodies_[k].mass) * states_[k].flow_force +
                                turning_velocity(w[k], rotated(R[k], point.offset));
    }
}

template <int D>
template <class Box>
double Bodies<D>::drain(const Particles<D>& particles, const Box& box,
                        std::vector<std::uint8_t>& removed) {
    if (!any_moves()) return 0.0;
    std::vector<std::uint8_t> leaves(size(), 0);
    double mass = 0.0;
    for (std::size_t k = 0; k < size(); ++k)
        if (at_work(k) && box.contains(states_[k].centre))
            leaves[k] = 1, states_[k].removed = 1.0, moved_ = margin_;
    for (std::size_t p = 0; p < particles.size(); ++p) {
        const std::int32_t k = body_of(particles, p);
        if (k >= 0 && leaves[static_cast<std::size_t>(k)])
            removed[p] = 1, mass += particles.mass[p];
    }
    return mass;
}

template <int D>
double Bodies<D>::kinetic_energy() const {
    double energy = deformable.elastic.kinetic_energy();
    for (std::size_t k = 0; k < size(); ++k)
        if (at_work(k))
            energy += 0.5 * bodies_[k].mass * dot(states_[k].velocity, states_[k].velocity) +
                      0.5 * dot(spin(k), states_[k].angular_momentum);
    return energy;
}

}  // namespace doseki
