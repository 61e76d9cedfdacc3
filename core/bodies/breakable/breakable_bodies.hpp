#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "base/error.hpp"
#include "bodies/breakable/breakable_body.hpp"
#include "bodies/breakable/flow_on_body.hpp"
#include "bodies/breakable/held_bodies.hpp"
#include "bodies/breakable/partners.hpp"
#include "bodies/contacts.hpp"
#include "bodies/deformable/deformable_bodies.hpp"
#include "bodies/particles/rigid_particles.hpp"
#include "bodies/rigid_bodies.hpp"
#include "physics/fracture/impact.hpp"

namespace doseki {

/// All breakable bodies.
template <int D>
class BreakableBodies {
public:
    bool any() const { return !bodies_.empty(); }
    std::size_t size() const { return bodies_.size(); }
    BreakableBody<D>& operator[](std::size_t n) { return bodies_[n]; }
    const BreakableBody<D>& operator[](std::size_t n) const { return bodies_[n]; }

    void add(std::size_t rigid, std::size_t deformable, const RigidBodyState<D>& state) {
        bodies_.push_back({rigid, deformable, state.centre, state.orientation});
    }
    /// Of body n, which divides: its parts bear what it bore, and none has a rigid body.
    void divide(std::size_t n, std::span<const std::size_t> parts,
                const DeformableBodies<D>& deformable);
    /// Gives body n a rigid one, which has its `centre` where points are at rest.
    void give_rigid(std::size_t n, std::size_t rigid, const Vec<double, D>& centre,
                    const DeformableBodies<D>& deformable) {
        bodies_[n].rigid = rigid, bodies_[n].centre = centre, bodies_[n].orientation = {};
        measure(bodies_[n], deformable);
    }
    /// Call when bodies or the points of rigid ones have changed. A number of a rigid point is that
    /// of one deformable point for good, so that particles that are bound to an old one find it.
    void index(std::size_t rigid_bodies, const DeformableBodies<D>& deformable);
    /// Finds out what a body bears with the cracks that it has.
    void weigh_cracks(std::size_t n, const DeformableBodies<D>& deformable) {
        constexpr double least = 0.1;  // of its strength: a notch concentrates stress
        const double intact = deformable.solids().least_intactness(bodies_[n].deformable);
        bodies_[n].bears = std::max(least, intact) * bodies_[n].strength;
    }
    /// Call once all bodies are in and started, before any has a crack.
    void measure_strengths(const DeformableBodies<D>& deformable) {
        for (BreakableBody<D>& body : bodies_)
            body.strength = body.bears = deformable.solids().strength(body.deformable);
    }
    /// Call once all bodies are in, started or restored.
    void start(std::size_t rigid_bodies, const DeformableBodies<D>& deformable);

    /// Time between two looks at whether one that is deformable has come to rest [s], infinite
    /// where none is.
    double longest_look(const DeformableBodies<D>& deformable) const {
        double longest = std::numeric_limits<double>::infinity();
        for (const BreakableBody<D>& body : bodies_)
            if (body.deforms(deformable)) longest = std::min(longest, body.lately(deformable));
        return longest;
    }
    /// The one that a rigid body is of; none.
    const BreakableBody<D>* of_rigid(std::size_t k) const {
        const std::int32_t n = number_of_rigid(k);
        return n < 0 ? nullptr : &bodies_[static_cast<std::size_t>(n)];
    }
    /// Which of them a deformable body is; -1: none.
    std::int32_t of_deformable(std::size_t deformable) const {
        for (std::size_t n = 0; n < size(); ++n)
            if (bodies_[n].deformable == deformable) return static_cast<std::int32_t>(n);
        return -1;
    }
    /// The point of a deformable body that a point of a rigid one is; -1: none.
    std::int32_t deformable_point(std::size_t rigid_point) const {
        return rigid_point < deformable_point_.size() ? deformable_point_[rigid_point] : -1;
    }
    /// The points of deformable bodies, by the numbers that they have among those of rigid ones.
    const Array<std::int32_t>& deformable_points() const { return deformable_point_; }

    /// Takes over what the fluid does to those that are rigid.
    void feel_flow(const RigidParticles<D>& particles, const RigidBodies<D>& rigid,
                   const DeformableBodies<D>& deformable);

    /// Those that are rigid and in which the fluid and the contacts of a kind, as they were last
    /// applied, may cause more tension than they bear. Dust, is_dust(body), is as small as the
    /// points of a body: what it does beside its contact is that of its force.
    template <class IsDust>
    Array<std::size_t> struck(const Contacts<D>& contacts, const ContactBodies<D>& touching,
                              PairKind kind, const DeformableBodies<D>& deformable,
                              const RigidBodies<D>& rigid, const IsDust& is_dust) const;

    void serialise(Archive& archive);
    /// Throws std::invalid_argument unless restored ones are those of these bodies.
    void expect_bodies_of(std::size_t rigid_bodies, const DeformableBodies<D>& deformable,
                          std::size_t rigid_points) const {
        for (const BreakableBody<D>& body : bodies_)
            expect_fit((!body.has_rigid() || body.rigid < rigid_bodies) &&
                           body.deformable < deformable.bodies(),
                       "breakable_rigid");
        const Array<std::int32_t>& points = deformable.rigid_points();
        for (const std::int32_t point : points)
            expect_fit(point >= -1 && point < static_cast<std::int32_t>(rigid_points),
                       "deformable_rigid_point");
        for (const BreakableBody<D>& body : bodies_)
            if (body.has_rigid())
                for (const std::uint32_t p : deformable.solids().points_of(body.deformable))
                    expect_fit(points[p] >= 0, "deformable_rigid_point");
    }

private:
    void measure(BreakableBody<D>& body, const DeformableBodies<D>& deformable) const;
    std::int32_t number_of_rigid(std::size_t k) const {
        return k < of_rigid_.size() ? of_rigid_[k] : -1;
    }
    /// Whether body n may break, and is rigid now.
    bool waits(std::size_t n, const DeformableBodies<D>& deformable) const {
        return bodies_[n].has_rigid() && deformable.solids().is_rigid(bodies_[n].deformable);
    }
    /// Which of them the rigid body k is, if it waits; -1: none.
    std::int32_t waiting(std::int32_t k, const DeformableBodies<D>& deformable) const {
        const std::int32_t n = number_of_rigid(static_cast<std::size_t>(k));
        return n >= 0 && waits(static_cast<std::size_t>(n), deformable) ? n : -1;
    }
    /// The same, if it bends.
    std::int32_t bending(std::int32_t k, const DeformableBodies<D>& deformable) const {
        const std::int32_t n = waiting(k, deformable);
        return n >= 0 && bodies_[static_cast<std::size_t>(n)].sections.bends() ? n : -1;
    }
    bool any_bends() const {
        return std::ranges::any_of(bodies_, [](const auto& body) { return body.sections.bends(); });
    }
    /// Adds the tension of bending by the fluid and all contacts and of spin to that of others,
    /// where it may be more than bodies bear.
    void bend(const Contacts<D>& contacts, const ContactBodies<D>& touching,
              const DeformableBodies<D>& deformable, const RigidBodies<D>& rigid,
              Array<double>& tension) const;
    /// The same by what comes nearer to a body that others hold.
    void catch_blows(const Contacts<D>& contacts, const ContactBodies<D>& touching,
                     const DeformableBodies<D>& deformable, const RigidBodies<D>& rigid,
                     Array<double>& tension) const;

    Array<BreakableBody<D>> bodies_;
    Array<FlowOnBody> flow_;  // of each, as it was last felt
    Array<std::int32_t> of_rigid_, deformable_point_;
};

template <int D>
void BreakableBodies<D>::start(std::size_t rigid_bodies, const DeformableBodies<D>& deformable) {
    for (BreakableBody<D>& body : bodies_) measure(body, deformable);
    deformable_point_.clear();
    index(rigid_bodies, deformable);
}

template <int D>
void BreakableBodies<D>::measure(BreakableBody<D>& body,
                                 const DeformableBodies<D>& deformable) const {
    const DeformableBody& material = deformable.solids().material(body.deformable);
    body.impedance = material.rho0 * material.wave_speed();
    body.bar_impedance = std::sqrt(material.rho0 * material.young_modulus());
    const Array<std::uint32_t> points = deformable.solids().points_of(body.deformable);
    body.diameter = diameter_of<D>(material, points.size());
    body.middle = rigid_motion<D>(deformable.solids(), points).rest_centre;
    Array<double> mass;
    Array<Vec3> place;
    for (const std::uint32_t p : points) {
        mass.push_back(deformable.solids().mass(p));
        place.push_back(in_space(deformable.solids().rest_position(p) - body.middle));
    }
    body.sections = Sections({place, mass, material.spacing, D}, body.orientation.matrix());
}

template <int D>
void BreakableBodies<D>::feel_flow(const RigidParticles<D>& particles, const RigidBodies<D>& rigid,
                                   const DeformableBodies<D>& deformable) {
    flow_.assign(size(), {});
    if (!any()) return;
    Array<Mat<double, 3>> at_rest(size()), turned(size());
    for (std::size_t n = 0; n < size(); ++n)
        if (waits(n, deformable))
            at_rest[n] = bodies_[n].orientation.matrix(), turned[n] = bodies_[n].turned(rigid);
    particles.for_each_push(
        [&](std::size_t k, const RigidBodyPoint<D>& point, const Vec<double, D>& force) {
            const std::int32_t number = waiting(static_cast<std::int32_t>(k), deformable);
            if (number < 0) return;
            const auto n = static_cast<std::size_t>(number);
            const Vec3 from_middle = in_space(bodies_[n].centre - bodies_[n].middle);
            flow_[n].add({at_rest[n] * in_space(point.offset) + from_middle,
                          rotated_back(turned[n], in_space(force))},
                         at_rest[n] * in_space(point.area));
        });
    for (FlowOnBody& flow : flow_) flow.finish();
}

template <int D>
void BreakableBodies<D>::bend(const Contacts<D>& contacts, const ContactBodies<D>& touching,
                              const DeformableBodies<D>& deformable, const RigidBodies<D>& rigid,
                              Array<double>& tension) const {
    auto for_each_force = [&](auto&& f) {
        contacts.for_each_force(touching,
                                [&](std::int32_t k, std::int32_t, const Vec<double, D>& place,
                                    const Vec<double, D>& force, const Vec<double, D>&) {
                                    if (const std::int32_t n = bending(k, deformable); n >= 0)
                                        f(static_cast<std::size_t>(n), place, force);
                                });
    };
    Array<double> sum(size(), 0.0);
    for (std::size_t n = 0; n < flow_.size(); ++n) sum[n] = flow_[n].sum;
    if (any_bends())
        for_each_force([&](std::size_t n, const Vec<double, D>&, const Vec<double, D>& force) {
            sum[n] += norm(force);
        });
    Array<std::uint8_t> may_bend(size(), 0);
    for (std::size_t n = 0; n < size(); ++n)
        if (waits(n, deformable))
            may_bend[n] = bodies_[n].sections.most_tension(sum[n], rigid.spin(bodies_[n].rigid)) >=
                          bodies_[n].bears;
    if (std::ranges::find(may_bend, 1) == may_bend.end()) return;
    Array<Array<PlacedForce>> forces(size());
    for (std::size_t n = 0; n < flow_.size(); ++n)
        if (may_bend[n]) forces[n] = flow_[n].forces;
    for_each_force([&](std::size_t n, const Vec<double, D>& place, const Vec<double, D>& force) {
        if (!may_bend[n]) return;
        const BreakableBody<D>& body = bodies_[n];
        const Vec<double, D> r =
            nearest_image(contacts.domain(), place - rigid.state(body.rigid).centre);
        const Mat<double, 3> turn = body.turned(rigid);
        forces[n].push_back({rotated_back(turn, in_space(r)) + in_space(body.centre - body.middle),
                             rotated_back(turn, in_space(force))});
    });
    for (std::size_t n = 0; n < size(); ++n) {
        if (!may_bend[n]) continue;
        const Vec3 spin = rotated_back(bodies_[n].turned(rigid), rigid.spin(bodies_[n].rigid));
        tension[n] = std::max(tension[n], bodies_[n].sections.tension(forces[n], spin));
    }
}

template <int D>
void BreakableBodies<D>::catch_blows(const Contacts<D>& contacts, const ContactBodies<D>& touching,
                                     const DeformableBodies<D>& deformable,
                                     const RigidBodies<D>& rigid, Array<double>& tension) const {
    if (!any_bends()) return;
    const PartnersOfBodies<D> partners(rigid, deformable, contacts.domain());
    Array<Closing> pairs;
    Array<double> fastest(size(), 0.0);
    contacts.for_each_force(
        touching, [&](std::int32_t k, std::int32_t other, const Vec<double, D>& place,
                      const Vec<double, D>&, const Vec<double, D>& way) {
            const std::int32_t number = bending(k, deformable);
            if (number < 0) return;
            const auto n = static_cast<std::size_t>(number);
            const double speed =
                dot(partners.velocity(k, place) - partners.velocity(other, place), way);
            pairs.push_back({n, other, speed}), fastest[n] = std::max(fastest[n], speed);
        });
    // Hardly any comes nearer so fast that even the heaviest of all could break what it touches.
    constexpr double most_partners = 64.0;
    const double heaviest = most_partners * partners.heaviest();
    Array<Closing> fast;
    for (const Closing& pair : pairs) {
        const BreakableBody<D>& body = bodies_[pair.body];
        const double square = fastest[pair.body] * fastest[pair.body];
        if (body.caught(heaviest * square / rigid.body(body.rigid).mass) >= body.bears)
            fast.push_back(pair);
    }
    if (fast.empty()) return;
    auto mass_of = [&](std::int32_t k) { return partners.mass(k); };
    const Array<double> blows = blows_on_held(size(), std::move(fast), mass_of);
    for (std::size_t n = 0; n < size(); ++n)
        if (blows[n] > 0.0)
            tension[n] = std::max(tension[n],
                                  bodies_[n].caught(blows[n] / rigid.body(bodies_[n].rigid).mass));
}

template <int D>
void BreakableBodies<D>::divide(std::size_t n, std::span<const std::size_t> parts,
                                const DeformableBodies<D>& deformable) {
    bodies_[n].rigid = BreakableBody<D>::none;
    measure(bodies_[n], deformable);
    for (const std::size_t part : parts) {
        BreakableBody<D> body{BreakableBody<D>::none, part, {}, {}};
        body.strength = body.bears = bodies_[n].strength;
        measure(body, deformable);
        bodies_.push_back(body);
    }
}

template <int D>
void BreakableBodies<D>::index(std::size_t rigid_bodies, const DeformableBodies<D>& deformable) {
    of_rigid_.assign(rigid_bodies, -1);
    for (std::size_t n = 0; n < size(); ++n)
        if (bodies_[n].has_rigid()) of_rigid_[bodies_[n].rigid] = static_cast<std::int32_t>(n);
    const Array<std::int32_t>& points = deformable.rigid_points();
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (points[p] < 0) continue;
        const auto own = static_cast<std::size_t>(points[p]);
        if (own >= deformable_point_.size()) deformable_point_.resize(own + 1, -1);
        deformable_point_[own] = static_cast<std::int32_t>(p);
    }
}

template <int D>
template <class IsDust>
Array<std::size_t> BreakableBodies<D>::struck(const Contacts<D>& contacts,
                                              const ContactBodies<D>& touching, PairKind kind,
                                              const DeformableBodies<D>& deformable,
                                              const RigidBodies<D>& rigid,
                                              const IsDust& is_dust) const {
    auto impedance = [&](std::int32_t k) {
        const auto other = static_cast<std::size_t>(k);
        if (other >= rigid.size()) {
            const DeformableBody& body = deformable.solids().material(other - rigid.size());
            return body.rho0 * body.wave_speed();
        }
        const BreakableBody<D>* body = of_rigid(other);
        return body ? body->impedance : std::numeric_limits<double>::infinity();
    };
    auto mass = [&](std::int32_t k) {
        const auto other = static_cast<std::size_t>(k);
        return other < rigid.size() ? rigid.striking_mass(other)
                                    : std::numeric_limits<double>::infinity();
    };
    Array<double> force(size(), 0.0), tension(size(), 0.0);
    for (std::size_t n = 0; n < flow_.size(); ++n) {
        if (!waits(n, deformable)) continue;
        force[n] = flow_[n].squeeze;
        tension[n] = std::max(pressed_tension<D>(force[n], bodies_[n].diameter), flow_[n].pressure);
    }
    auto feel = [&](std::int32_t k, std::int32_t other, double push, double approach) {
        const std::int32_t number = waiting(k, deformable);
        if (number < 0) return;
        const auto n = static_cast<std::size_t>(number);
        const BreakableBody<D>& body = bodies_[n];
        force[n] += 0.5 * push;
        if (is_dust(other)) approach = 0.0;
        const double density = deformable.solids().material(body.deformable).rho0;
        tension[n] = std::max({tension[n], body.blown(approach, density, mass(other)),
                               expected_tension<D>({approach, body.impedance, impedance(other),
                                                    force[n], body.diameter})});
    };
    contacts.for_each_touch(kind,
                            [&](std::int32_t a, std::int32_t b, double push, double approach) {
                                feel(a, b, push, approach), feel(b, a, push, approach);
                            });
    bend(contacts, touching, deformable, rigid, tension);
    catch_blows(contacts, touching, deformable, rigid, tension);
    Array<std::size_t> found;
    for (std::size_t n = 0; n < size(); ++n)
        if (tension[n] >= bodies_[n].bears) found.push_back(n);
    return found;
}

template <int D>
void BreakableBodies<D>::serialise(Archive& archive) {
    Array<std::int32_t> rigid, deformable;
    Array<Vec<double, D>> centre;
    Array<Vec<double, 4>> orientation;
    Array<double> deforms_for, loudness, strength, bears;
    for (const BreakableBody<D>& body : bodies_) {
        const auto& [w, x, y, z] = body.orientation;
        rigid.push_back(static_cast<std::int32_t>(body.rigid)),
            deformable.push_back(static_cast<std::int32_t>(body.deformable));
        centre.push_back(body.centre), orientation.push_back(Vec<double, 4>{{w, x, y, z}});
        deforms_for.push_back(body.deforms_for), loudness.push_back(body.loudness);
        strength.push_back(body.strength), bears.push_back(body.bears);
    }
    archive("breakable_rigid", rigid), archive("breakable_deformable", deformable);
    archive("breakable_centre", centre), archive("breakable_orientation", orientation);
    archive("breakable_deforms_for", deforms_for), archive("breakable_loudness", loudness);
    archive("breakable_strength", strength), archive("breakable_bears", bears);
    if (!archive.loads()) return;
    const std::size_t n = rigid.size();
    expect_fit(deformable.size() == n && centre.size() == n && orientation.size() == n &&
                   deforms_for.size() == n && loudness.size() == n && strength.size() == n &&
                   bears.size() == n,
               "breakable_rigid");
    bodies_.clear();
    for (std::size_t k = 0; k < n; ++k) {
        const Vec<double, 4>& q = orientation[k];
        expect_fit(std::abs(dot(q, q) - 1.0) < 1e-6, "breakable_orientation");
        expect_fit(rigid[k] >= -1 && deformable[k] >= 0, "breakable_rigid");
        bodies_.push_back(
            {rigid[k] < 0 ? BreakableBody<D>::none : static_cast<std::size_t>(rigid[k]),
             static_cast<std::size_t>(deformable[k]),
             centre[k],
             {q[0], q[1], q[2], q[3]},
             deforms_for[k],
             loudness[k],
             strength[k],
             bears[k]});
    }
}

}  // namespace doseki
