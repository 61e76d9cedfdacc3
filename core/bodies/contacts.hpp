#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "bodies/contact_law.hpp"
#include "bodies/contact_search.hpp"
#include "bodies/overlap.hpp"

namespace doseki {

/// The contacts between different bodies: who may touch, the springs of those that do, and their
/// forces.
template <int D>
class Contacts {
public:
    Contacts(const Domain<D>& domain, const ContactOptions& options,
             std::vector<ContactProperties> materials)
        : domain_(domain), laws_(options, std::move(materials)) {}

    /// Pairs that may touch before anything has moved by half of `margin`; springs of pairs that
    /// are found again go on.
    void find(const ContactBodies<D>& bodies, double margin);

    /// Adds forces and torques of all pairs, whose springs stretch for dt.
    void apply(ContactBodies<D>& bodies, double dt);

    const Domain<D>& domain() const { return domain_; }
    /// Step that follows the stiffest pair found, infinite without any.
    double timestep() const { return timestep_; }
    /// Largest overlap there ever was, over the diameter.
    double max_overlap() const { return max_overlap_; }
    /// Bodies that touch, and by how much of their diameters.
    template <class F>
    void for_each_touching(F&& f) const {
        for (const Contact& contact : contacts_)
            if (contact.overlap > 0.0)
                f(contact.body_a, contact.body_b, contact.overlap / contact.law.diameter);
    }

    template <class Archive>
    void serialise(Archive& archive) {
        std::vector<std::int32_t> a, b;
        for (const ContactPair& pair : pairs_) a.push_back(pair.a), b.push_back(pair.b);
        archive("contact_a", a), archive("contact_b", b), archive("contact_springs", springs_);
        archive("worst_overlap", max_overlap_);
        pairs_.resize(a.size());
        for (std::size_t k = 0; k < a.size(); ++k) pairs_[k] = {a[k], b.at(k)};
    }
    /// Completes what serialise() loaded.
    void restore(const ContactBodies<D>& bodies);

private:
    /// A pair that may touch, and how it does.
    struct Contact {
        std::int32_t body_a, body_b;
        ContactLaw law;
        double overlap;
    };

    static std::uint64_t key(const ContactPair& pair) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(pair.a)) << 32 |
               static_cast<std::uint32_t>(pair.b);
    }
    Contact contact_of(const ContactBodies<D>& bodies, const ContactPair& pair) const;
    void push_apart(ContactBodies<D>& bodies, std::size_t k, const Overlap<D>& overlap, double dt);

    Domain<D> domain_;
    ContactLaws<D> laws_;
    std::vector<ContactPair> pairs_;
    std::vector<ContactSprings> springs_;
    std::vector<Contact> contacts_;
    double timestep_ = std::numeric_limits<double>::infinity();
    double max_overlap_ = 0.0;
};

template <int D>
void Contacts<D>::find(const ContactBodies<D>& bodies, double margin) {
    std::unordered_map<std::uint64_t, ContactSprings> stretched;
    for (std::size_t k = 0; k < pairs_.size(); ++k)
        if (contacts_[k].overlap > 0.0) stretched[key(pairs_[k])] = springs_[k];
    pairs_.clear();
    find_ball_pairs(bodies.points, domain_, margin, pairs_);
    find_convex_pairs(bodies, domain_, margin, pairs_);
    springs_.assign(pairs_.size(), {});
    for (std::size_t k = 0; k < pairs_.size(); ++k)
        if (const auto found = stretched.find(key(pairs_[k])); found != stretched.end())
            springs_[k] = found->second;
    restore(bodies);
}

template <int D>
void Contacts<D>::restore(const ContactBodies<D>& bodies) {
    contacts_.clear();
    timestep_ = std::numeric_limits<double>::infinity();
    for (const ContactPair& pair : pairs_) {
        contacts_.push_back(contact_of(bodies, pair));
        timestep_ = std::min(timestep_, contacts_.back().law.timestep(laws_.speed()));
    }
}

template <int D>
auto Contacts<D>::contact_of(const ContactBodies<D>& bodies, const ContactPair& pair) const
    -> Contact {
    const ContactPoints<D>& points = bodies.points;
    const ContactSide a = points.side(pair.first());
    if (pair.with_convex()) {
        const ConvexBody<D>& convex = bodies.convex[pair.convex()];
        return {points.body[pair.first()], convex.body, laws_.between(a, convex.side()), 0.0};
    }
    return {points.body[pair.first()], points.body[pair.second()],
            laws_.between(a, points.side(pair.second())), 0.0};
}

template <int D>
void Contacts<D>::apply(ContactBodies<D>& bodies, double dt) {
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const ContactPair& pair = pairs_[k];
        Contact& contact = contacts_[k];
        const auto overlap =
            pair.with_convex()
                ? overlap_of(bodies.points, pair.first(), bodies.convex[pair.convex()], domain_)
                : overlap_of(bodies.points, pair.first(), pair.second(), domain_);
        if (overlap) {
            contact.overlap = overlap->depth;
            max_overlap_ = std::max(max_overlap_, overlap->depth / contact.law.diameter);
            push_apart(bodies, k, *overlap, dt);
        } else if (contact.overlap > 0.0) {
            contact.overlap = 0.0, springs_[k] = {};
        }
    }
}

template <int D>
void Contacts<D>::push_apart(ContactBodies<D>& bodies, std::size_t k, const Overlap<D>& overlap,
                             double dt) {
    ContactPoints<D>& points = bodies.points;
    const ContactPair& pair = pairs_[k];
    const std::size_t a = pair.first();
    ConvexBody<D>* convex = pair.with_convex() ? &bodies.convex[pair.convex()] : nullptr;
    const std::size_t b = convex ? 0 : pair.second();
    const Vec3 spin_a = points.spin[a], spin_b = convex ? convex->spin : points.spin[b];
    const Vec<double, D> v_a = points.velocity[a] + turning_velocity(spin_a, overlap.lever_a);
    const Vec<double, D> v_b = (convex ? convex->velocity : points.velocity[b]) +
                               turning_velocity(spin_b, overlap.lever_b);
    const ContactAction on_a =
        contacts_[k].law.act(springs_[k], overlap.depth, in_space(overlap.normal),
                             {in_space(v_a - v_b), spin_a - spin_b}, dt);
    auto push = [&](auto& force, auto& torque, const Vec<double, D>& lever, double sign) {
        force = force + sign * in_run<D>(on_a.force);
        torque = torque + sign * (cross(in_space(lever), on_a.force) + on_a.moment);
    };
    push(points.force[a], points.torque[a], overlap.lever_a, 1.0);
    if (convex)
        push(convex->force, convex->torque, overlap.lever_b, -1.0);
    else
        push(points.force[b], points.torque[b], overlap.lever_b, -1.0);
}

// Compiled once: bodies_2.cpp, bodies_3.cpp.
extern template class Contacts<2>;
extern template class Contacts<3>;

}  // namespace doseki
