#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "bodies/shape.hpp"
#include "neighbours.hpp"
#include "physics/contact.hpp"

namespace doseki {

/// How stiff contacts are, and what they are checked against.
struct ContactOptions {
    bool hertz = false;     // in 3-D; discs touch along a line, whose spring is linear
    bool softened = true;   // as stiff as `overlap` at `speed` asks, no stiffer
    double overlap = 0.01;  // of the smaller diameter
    double speed = 1.0;     // largest speed at which bodies meet [m/s]
    double steps = 20.0;    // of a contact's time
};

/// What a material brings into a contact.
struct Surface {
    double restitution = 0.5, friction = 0.5, rolling_friction = 0.0;
    double young_modulus = 0.0, poisson_ratio = 0.0;  // [Pa]

    /// (1 - nu^2)/E; none of what has no modulus.
    double compliance() const {
        return young_modulus > 0.0 ? (1.0 - poisson_ratio * poisson_ratio) / young_modulus : 0.0;
    }
};

/// E* of two materials that touch.
inline double contact_modulus(const Surface& a, const Surface& b) {
    return 1.0 / (a.compliance() + b.compliance());
}

/// Balls that touch: whole bodies, samples of the surface of a convex one (radius 0), surface
/// points of a deformable one. Bodies are numbered over all kinds.
template <int D>
struct Contactors {
    std::vector<Vec<double, D>> position, velocity;  // of the centre
    std::vector<Vec3> spin;
    std::vector<double> radius, mass, size;  // size: diameter that overlaps are compared with
    std::vector<std::int32_t> body, material;
    std::vector<std::uint8_t> fixed, gone;
    std::vector<std::uint8_t> deformable;  // a point of a body that gives way itself
    // What the contacts do to them; torque about their own centre.
    std::vector<Vec<double, D>> force;
    std::vector<Vec3> torque;

    std::size_t size_of_all() const { return radius.size(); }
    void add(std::int32_t of_body, std::int32_t of_material, double r, double m, double diameter,
             bool is_fixed, bool is_deformable = false) {
        position.push_back({}), velocity.push_back({}), spin.push_back({}), force.push_back({}),
            torque.push_back({});
        radius.push_back(r), mass.push_back(m), size.push_back(diameter);
        body.push_back(of_body), material.push_back(of_material), fixed.push_back(is_fixed),
            gone.push_back(0), deformable.push_back(is_deformable);
    }
};

/// A convex body that contactors of others may touch.
template <int D>
struct Solid {
    const Shape<D>* shape = nullptr;
    std::int32_t body = 0, material = 0;
    bool fixed = false, gone = false;
    double mass = 0.0, size = 0.0;
    Vec<double, D> centre{}, velocity{};
    Mat<double, 3> rotation{};
    Vec3 spin{};
    Vec<double, D> force{};  // on it
    Vec3 torque{};           // about its centre
};

/// The contacts between different bodies: who may touch, the springs of those that do, and their
/// forces. Two contactors, or a contactor and a solid, make one pair.
template <int D>
class Contacts {
public:
    Contacts(const Domain<D>& domain, const ContactOptions& options, std::vector<Surface> surfaces)
        : domain_(domain), options_(options), surfaces_(std::move(surfaces)) {
        for (const Surface& a : surfaces_)
            for (const Surface& b : surfaces_)
                damping_.push_back(damping_ratio(0.5 * (a.restitution + b.restitution), hertz()));
    }

    /// Pairs that may touch before anything has moved by half of `margin`; springs of pairs that
    /// are found again go on.
    void find(const Contactors<D>& contactors, const std::vector<Solid<D>>& solids, double margin);

    /// Adds forces and torques of all pairs, whose springs stretch for dt.
    void apply(Contactors<D>& contactors, std::vector<Solid<D>>& solids, double dt);

    /// The shortest vector to any periodic image.
    Vec<double, D> nearest_image(Vec<double, D> r) const {
        for (int c = 0; c < D; ++c)
            if (domain_.periodic[c])
                r[c] -= domain_.length(c) * std::round(r[c] / domain_.length(c));
        return r;
    }
    /// Step that follows the stiffest pair found, infinite without any.
    double timestep() const { return timestep_; }
    /// Largest overlap there ever was, over the diameter.
    double worst_overlap() const { return worst_overlap_; }
    /// Bodies that touch, and by how much of their diameters.
    template <class F>
    void for_each_touching(F&& f) const {
        for (const Pairing& pair : pairs_)
            if (pair.overlap > 0.0) f(pair.body_a, pair.body_b, pair.overlap / pair.size);
    }

    template <class Archive>
    void serialise(Archive& archive) {
        archive("contact_a", a_), archive("contact_b", b_), archive("contact_springs", springs_);
        archive("worst_overlap", worst_overlap_);
    }
    /// Completes what serialise() loaded.
    void restore(const Contactors<D>& contactors, const std::vector<Solid<D>>& solids) {
        pairs_.clear();
        for (std::size_t k = 0; k < a_.size(); ++k)
            pairs_.push_back(pairing(contactors, solids, a_[k], b_[k]));
        set_timestep();
    }

private:
    using Springs = Vec<double, 6>;  // of friction and of rolling; zero while apart

    /// The law of one pair.
    struct Pairing {
        std::int32_t body_a, body_b;
        double stiffness, mass, radius,
            size;  // k or E*, m*, R* (0: does not roll), smaller diameter
        double zeta, friction, rolling;
        double tangential;  // stiffness of friction over the normal one
        bool deformable = false;
        double overlap = 0.0;

        double curvature() const { return radius > 0.0 ? radius : 0.5 * size; }
    };

    struct Action {
        Vec3 force, moment;
    };

    /// A touching pair: n from a to b, and the levers to the point of contact.
    struct Touch {
        double overlap;
        Vec<double, D> normal, lever_a, lever_b;
    };

    /// b < 0 is solid -1 - b.
    Pairing pairing(const Contactors<D>& contactors, const std::vector<Solid<D>>& solids,
                    std::int32_t a, std::int32_t b) const;
    double stiffness_of(const Pairing& pair, const Surface& a, const Surface& b) const;
    Action action(const Pairing& pair, Springs& springs, double overlap, const Vec3& n,
                  const Vec3& speed, const Vec3& spin, double dt) const;
    void set_timestep();
    void find_balls(const Contactors<D>& contactors, double margin);
    void find_solids(const Contactors<D>& contactors, const std::vector<Solid<D>>& solids,
                     double margin);
    bool touches(const Contactors<D>& contactors, std::size_t a, std::size_t b, Touch& touch) const;
    bool touches(const Contactors<D>& contactors, std::size_t a, const Solid<D>& solid,
                 Touch& touch) const;
    /// A spring along the surface turns with it.
    static Vec3 turned_with(const Vec3& n, const Springs& springs, int first) {
        Vec3 stretch;
        for (int c = 0; c < 3; ++c) stretch[c] = springs[first + c];
        const double before = norm(stretch);
        stretch = stretch - dot(stretch, n) * n;
        const double after = norm(stretch);
        return after > 0.0 ? (before / after) * stretch : stretch;
    }
    bool hertz() const { return D == 3 && options_.hertz; }
    bool hertz(const Pairing& pair) const { return hertz() && !pair.deformable; }

    /// The spring between points of deformable bodies only keeps them apart: it is this many times
    /// as stiff as what they belong to, does not damp, and its step is this part of its time.
    static constexpr double firmness = 2.0, steps_of_firmness = 5.0;

    Domain<D> domain_;
    ContactOptions options_;
    std::vector<Surface> surfaces_;
    std::vector<double> damping_;  // by pair of materials
    std::vector<std::int32_t> a_, b_;
    std::vector<Springs> springs_;
    std::vector<Pairing> pairs_;
    double timestep_ = std::numeric_limits<double>::infinity();
    double worst_overlap_ = 0.0;
};

template <int D>
void Contacts<D>::find(const Contactors<D>& contactors, const std::vector<Solid<D>>& solids,
                       double margin) {
    auto key = [](std::int32_t a, std::int32_t b) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32 |
               static_cast<std::uint32_t>(b);
    };
    std::unordered_map<std::uint64_t, Springs> stretched;
    for (std::size_t k = 0; k < a_.size(); ++k)
        if (pairs_[k].overlap > 0.0) stretched[key(a_[k], b_[k])] = springs_[k];
    a_.clear(), b_.clear();
    find_balls(contactors, margin);
    find_solids(contactors, solids, margin);
    springs_.assign(a_.size(), {});
    for (std::size_t k = 0; k < a_.size(); ++k)
        if (const auto found = stretched.find(key(a_[k], b_[k])); found != stretched.end())
            springs_[k] = found->second;
    restore(contactors, solids);
}

template <int D>
void Contacts<D>::find_balls(const Contactors<D>& contactors, double margin) {
    std::vector<std::int32_t> balls;
    for (std::size_t c = 0; c < contactors.size_of_all(); ++c)
        if (contactors.radius[c] > 0.0 && !contactors.gone[c])
            balls.push_back(static_cast<std::int32_t>(c));
    if (balls.size() < 2) return;
    std::vector<Vec<double, D>> position;
    std::vector<double> support;
    std::vector<std::uint8_t> fixed;
    for (const std::int32_t c : balls) {
        Vec<double, D> x = contactors.position[c];
        for (int axis = 0; axis < D; ++axis)
            if (domain_.periodic[axis])
                x[axis] -= domain_.length(axis) *
                           std::floor((x[axis] - domain_.low[axis]) / domain_.length(axis));
        position.push_back(x), support.push_back(2.0 * contactors.radius[c]),
            fixed.push_back(contactors.fixed[c]);
    }
    Neighbours<D> neighbours(domain_);
    const auto order = neighbours.sort(position, support, fixed);
    auto sorted = [&order](const auto& values) {
        auto result = values;
        for (std::size_t k = 0; k < order.size(); ++k) result[k] = values[order[k]];
        return result;
    };
    position = sorted(position), support = sorted(support), balls = sorted(balls);
    neighbours.template build<1>(position, support, margin);
    for (std::uint32_t i = 0; i < neighbours.moving(); ++i) {
        auto pair_with = [&](std::uint32_t entry) {
            const std::uint32_t j = entry & ListEntry::index_mask;
            const std::int32_t a = balls[i], b = balls[j];
            if (contactors.body[a] == contactors.body[b] || (j < neighbours.moving() && j <= i))
                return;
            const Vec<double, D> r = nearest_image(position[j] - position[i]);
            const double reach = contactors.radius[a] + contactors.radius[b] + margin;
            if (dot(r, r) < reach * reach)
                a_.push_back(std::min(a, b)), b_.push_back(std::max(a, b));
        };
        neighbours.clusters()[i].for_each_moving(pair_with);
        neighbours.clusters()[i].for_each_fixed(pair_with);
    }
}

template <int D>
void Contacts<D>::find_solids(const Contactors<D>& contactors, const std::vector<Solid<D>>& solids,
                              double margin) {
    for (std::size_t s = 0; s < solids.size(); ++s) {
        const Solid<D>& solid = solids[s];
        if (solid.gone) continue;
        for (std::size_t c = 0; c < contactors.size_of_all(); ++c) {
            if (contactors.gone[c] || contactors.body[c] == solid.body ||
                (contactors.fixed[c] && solid.fixed))
                continue;
            const Vec<double, D> r = nearest_image(contactors.position[c] - solid.centre);
            const double reach = contactors.radius[c] + margin,
                         around = solid.shape->radius + reach;
            if (dot(r, r) > around * around) continue;
            if (solid.shape->surface_from(rotated_back(solid.rotation, r)).distance < reach)
                a_.push_back(static_cast<std::int32_t>(c)),
                    b_.push_back(-1 - static_cast<std::int32_t>(s));
        }
    }
}

template <int D>
auto Contacts<D>::pairing(const Contactors<D>& contactors, const std::vector<Solid<D>>& solids,
                          std::int32_t a, std::int32_t b) const -> Pairing {
    const Solid<D>* solid = b < 0 ? &solids[static_cast<std::size_t>(-1 - b)] : nullptr;
    const std::int32_t first = contactors.material[a],
                       second = solid ? solid->material : contactors.material[b];
    const bool free_a = !contactors.fixed[a],
               free_b = !(solid ? solid->fixed : contactors.fixed[b]);
    const double mass_a = contactors.mass[a], mass_b = solid ? solid->mass : contactors.mass[b];
    const double radius_a = contactors.radius[a], radius_b = solid ? 0.0 : contactors.radius[b];
    Pairing pair{};
    pair.body_a = contactors.body[a], pair.body_b = solid ? solid->body : contactors.body[b];
    pair.mass = free_a && free_b ? mass_a * mass_b / (mass_a + mass_b) : free_a ? mass_a : mass_b;
    pair.size = std::min(free_a ? contactors.size[a] : std::numeric_limits<double>::infinity(),
                         !free_b ? std::numeric_limits<double>::infinity()
                         : solid ? solid->size
                                 : contactors.size[b]);
    pair.radius = solid ? radius_a : radius_a * radius_b / (radius_a + radius_b);
    const Surface &u = surfaces_[static_cast<std::size_t>(first)],
                  &v = surfaces_[static_cast<std::size_t>(second)];
    pair.zeta = damping_[static_cast<std::size_t>(first) * surfaces_.size() +
                         static_cast<std::size_t>(second)];
    pair.friction = 0.5 * (u.friction + v.friction);
    pair.rolling = 0.5 * (u.rolling_friction + v.rolling_friction);
    pair.deformable = contactors.deformable[a] || (!solid && contactors.deformable[b]);
    if (pair.deformable) {
        const double spacing = 2.0 * (solid ? radius_a : std::min(radius_a, radius_b));
        pair.stiffness = firmness * contact_modulus(u, v) * (D == 3 ? spacing : 1.0);
        pair.zeta = pair.rolling = 0.0;
    } else
        pair.stiffness = stiffness_of(pair, u, v);
    // Linear: equal times of both springs for balls. Hertz: Mindlin's 4 G*/E*.
    const double nu = 0.5 * (u.poisson_ratio + v.poisson_ratio);
    pair.tangential = hertz() ? 2.0 * (1.0 - nu) / (2.0 - nu) : 2.0 / 7.0;
    return pair;
}

/// E* of a Hertz contact, k of a linear one (eq. 47, or that of the material).
template <int D>
double Contacts<D>::stiffness_of(const Pairing& pair, const Surface& a, const Surface& b) const {
    const double radius = pair.curvature();
    const double v = options_.speed, overlap = options_.overlap * pair.size;
    const double soft_k = pair.mass * v * v / (overlap * overlap);
    const double soft_E =
        15.0 / 16.0 * pair.mass * v * v / (std::sqrt(radius) * std::pow(overlap, 2.5));
    if (options_.softened) return hertz() ? soft_E : soft_k;
    const double E = contact_modulus(a, b);
    if (hertz()) return E;
    if constexpr (D == 2) return 0.25 * std::numbers::pi * E;  // of a line contact, per length
    const double same = hertz_encounter(E, radius, pair.mass, v).overlap;
    return pair.mass * v * v / (same * same);
}

template <int D>
void Contacts<D>::set_timestep() {
    timestep_ = std::numeric_limits<double>::infinity();
    for (const Pairing& pair : pairs_) {
        const Encounter meeting =
            hertz(pair)
                ? hertz_encounter(pair.stiffness, pair.curvature(), pair.mass, options_.speed)
                : linear_encounter(pair.stiffness, pair.mass, options_.speed);
        timestep_ = std::min(timestep_,
                             meeting.time / (pair.deformable ? steps_of_firmness : options_.steps));
    }
}

template <int D>
bool Contacts<D>::touches(const Contactors<D>& contactors, std::size_t a, std::size_t b,
                          Touch& touch) const {
    const Vec<double, D> r = nearest_image(contactors.position[b] - contactors.position[a]);
    const double reach = contactors.radius[a] + contactors.radius[b], square = dot(r, r);
    if (square >= reach * reach || square == 0.0) return false;
    const double distance = std::sqrt(square);
    touch.overlap = reach - distance, touch.normal = (1.0 / distance) * r;
    touch.lever_a = (contactors.radius[a] - 0.5 * touch.overlap) * touch.normal;
    touch.lever_b = touch.lever_a - r;
    return true;
}

template <int D>
bool Contacts<D>::touches(const Contactors<D>& contactors, std::size_t a, const Solid<D>& solid,
                          Touch& touch) const {
    const Vec<double, D> r = nearest_image(contactors.position[a] - solid.centre);
    const double around = solid.shape->radius + contactors.radius[a];
    if (dot(r, r) >= around * around) return false;
    const SurfacePoint<D> surface = solid.shape->surface_from(rotated_back(solid.rotation, r));
    if (surface.distance >= contactors.radius[a]) return false;
    touch.overlap = contactors.radius[a] - surface.distance;
    touch.normal = -1.0 * rotated(solid.rotation, surface.normal);
    touch.lever_a = (contactors.radius[a] - 0.5 * touch.overlap) * touch.normal;
    touch.lever_b = r + touch.lever_a;
    return true;
}

/// The force and moment on the first of two bodies that touch; n points away from it, and `speed`
/// and `spin` are its own against the other's.
template <int D>
auto Contacts<D>::action(const Pairing& pair, Springs& springs, double overlap, const Vec3& n,
                         const Vec3& speed, const Vec3& spin, double dt) const -> Action {
    const double approach = dot(speed, n);
    const NormalSpring spring = hertz(pair)
                                    ? hertz_spring(pair.stiffness, pair.curvature(), overlap)
                                    : linear_spring(pair.stiffness, overlap);
    const double damping = contact_damping(hertz(pair), pair.zeta, spring.stiffness, pair.mass);
    const double normal = normal_force(spring, damping, approach);
    const double along = pair.tangential * spring.stiffness, dashpot = pair.tangential * damping;
    Vec3 slid = turned_with(n, springs, 0), rolled = turned_with(n, springs, 3);
    Action result{
        sliding_spring(slid, speed - approach * n, dt, along, dashpot, pair.friction * normal) -
            normal * n,
        {}};
    if (pair.radius > 0.0 && pair.rolling > 0.0)
        result.moment =
            pair.radius * cross(n, sliding_spring(rolled, pair.radius * cross(spin, n), dt, along,
                                                  dashpot, pair.rolling * normal));
    for (int c = 0; c < 3; ++c) springs[c] = slid[c], springs[3 + c] = rolled[c];
    return result;
}

template <int D>
void Contacts<D>::apply(Contactors<D>& contactors, std::vector<Solid<D>>& solids, double dt) {
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        Pairing& pair = pairs_[k];
        const auto a = static_cast<std::size_t>(a_[k]), b = static_cast<std::size_t>(b_[k]);
        Solid<D>* solid = b_[k] < 0 ? &solids[static_cast<std::size_t>(-1 - b_[k])] : nullptr;
        Touch touch;
        if (!(solid ? touches(contactors, a, *solid, touch) : touches(contactors, a, b, touch))) {
            if (pair.overlap > 0.0) pair.overlap = 0.0, springs_[k] = {};
            continue;
        }
        pair.overlap = touch.overlap;
        worst_overlap_ = std::max(worst_overlap_, touch.overlap / pair.size);
        const Vec3 spin_a = contactors.spin[a], spin_b = solid ? solid->spin : contactors.spin[b];
        const Vec<double, D> v_a = contactors.velocity[a] + turning_velocity(spin_a, touch.lever_a);
        const Vec<double, D> v_b = (solid ? solid->velocity : contactors.velocity[b]) +
                                   turning_velocity(spin_b, touch.lever_b);
        const Action on_a = action(pair, springs_[k], touch.overlap, in_space(touch.normal),
                                   in_space(v_a - v_b), spin_a - spin_b, dt);
        auto push = [&](auto& force, auto& torque, const Vec<double, D>& lever, double sign) {
            force = force + sign * in_run<D>(on_a.force);
            torque = torque + sign * (cross(in_space(lever), on_a.force) + on_a.moment);
        };
        push(contactors.force[a], contactors.torque[a], touch.lever_a, 1.0);
        if (solid)
            push(solid->force, solid->torque, touch.lever_b, -1.0);
        else
            push(contactors.force[b], contactors.torque[b], touch.lever_b, -1.0);
    }
}

}  // namespace doseki
