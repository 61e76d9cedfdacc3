#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "base/array.hpp"
#include "base/error.hpp"
#include "bodies/contact/contact_rows.hpp"
#include "bodies/contact/joint_contacts.hpp"
#include "bodies/contact/pushes_on_solids.hpp"
#include "bodies/contact/shown_points.hpp"
#include "bodies/contact_search.hpp"
#include "model/archive.hpp"

namespace doseki {

/// Pairs by the steps that they need: slow are those of bodies that were rigid when the run began,
/// fast are those with one that is deformable or a part of a broken one.
enum class PairKind { all, slow, fast };

/// The contacts between different bodies: who may touch, the springs of those that do, and their
/// forces.
template <int D>
class Contacts {
public:
    Contacts(const Domain<D>& domain, const ContactOptions& options,
             Array<ContactProperties> materials)
        : domain_(domain), laws_(options, std::move(materials)) {}

    /// Pairs that may touch before anything has moved by half of `margin`; springs of pairs that
    /// are found again go on.
    void find(ContactBodies<D>& bodies, double margin);

    /// Gives contact points and shapes other numbers, before bodies are looked for that touch; what
    /// has -1 touches anew.
    void renumber(const Array<std::int32_t>& point, const Array<std::int32_t>& shape);

    /// Lets the overlaps that pairs have now press no more than before, Eq. (115), those for which
    /// is_new(pair, touches): whether it has pushed before. Unless they have met, their contacts
    /// begin at the speed that they have next.
    template <class NewPair>
    void accept_overlaps(ContactBodies<D>& bodies, const NewPair& is_new, bool have_met = true);

    /// From the next find() on, pairs of one kind can be looked at alone, and no longer all. Slow
    /// are those of bodies with numbers below this one.
    void tell_kinds_apart(std::size_t slow_bodies) { slow_bodies_ = slow_bodies, apart_ = true; }
    /// Adds forces and torques of all pairs of a kind, whose springs stretch for dt. Nothing has
    /// gone farther than `moved` since find().
    void apply(ContactBodies<D>& bodies, PairKind kind, double moved, double dt);
    /// Gives springs back what they were before the last apply() of a kind, of pairs told apart.
    void revert(PairKind kind);

    /// Whether there are pairs of a kind that may touch.
    bool any(PairKind kind) const { return !of(kind).rows.empty(); }
    /// The contact points of these pairs.
    const ShownPoints& points(PairKind kind) const { return of(kind).points; }
    /// Among them all those of deformable bodies.
    std::span<const std::int32_t> points_of_deformable() const {
        return points(apart_ ? PairKind::fast : PairKind::all).points;
    }
    const Domain<D>& domain() const { return domain_; }
    /// Step that follows the stiffest pair of a kind, infinite without any.
    double timestep(PairKind kind) const { return of(kind).timestep; }
    /// Calls f(body, other) for the bodies of each pair of a kind that may touch.
    template <class F>
    void for_each_pair_of(PairKind kind, F&& f) const {
        for (const std::size_t k : of(kind).rows) f(contacts_[k].body_a, contacts_[k].body_b);
    }
    /// Calls f(body, other, force, approach) for the pairs that touched when a kind was last
    /// applied: the size of the force, and see for_each_push.
    template <class F>
    void for_each_touch(PairKind kind, F&& f) const {
        for (const std::size_t k : of(kind).rows)
            if (pushes_[k].touches)
                f(contacts_[k].body_a, contacts_[k].body_b, norm(pushes_[k].force),
                  pushes_[k].approach);
    }
    /// Until a kind is applied again no pair of it has touched.
    void forget_forces() { pushes_.assign(pairs_.size(), {}); }
    /// Calls f(body, other, place, force, way) for each body of each pair that touched when its
    /// kind was last applied: the force on it there, by the image that is near the first of the
    /// pair, and the direction to the other.
    template <class F>
    void for_each_force(const ContactBodies<D>& bodies, F&& f) const {
        for (std::size_t k = 0; k < pairs_.size(); ++k) {
            const PairPush<D>& push = pushes_[k];
            if (!push.touches) continue;
            const Vec<double, D> place =
                bodies.points.position[pairs_[k].first()] + push.overlap.lever_a;
            const auto [a, b] = std::pair(contacts_[k].body_a, contacts_[k].body_b);
            f(a, b, place, push.force, push.overlap.normal);
            f(b, a, place, -1.0 * push.force, -1.0 * push.overlap.normal);
        }
    }
    /// Largest overlap of rigid bodies that there ever was, over the diameter, but for dust.
    double max_overlap() const { return max_overlap_; }
    /// Energy in the springs of all pairs when they were last applied [J], 2-D: [J/m].
    double stored_energy() const;
    /// Bodies that touch, and by how much of their diameters.
    template <class F>
    void for_each_touching(F&& f) const {
        for (const PairContact& contact : contacts_)
            if (contact.overlap > 0.0)
                f(contact.body_a, contact.body_b, contact.overlap / contact.law.diameter);
    }

    /// Calls f(body, other, place, force, moment, approach) for each body of each pair that touched
    /// when a kind was last applied: the force on it there, the moment beside that of the force,
    /// and the speed of approach where the contact began.
    template <class F>
    void for_each_push(const ContactBodies<D>& bodies, PairKind kind, F&& f) const;

    void serialise(Archive& archive) {
        Array<std::int32_t> a, b;
        for (const ContactPair& pair : pairs_) a.push_back(pair.a), b.push_back(pair.b);
        vertices_.clear();
        for (const PairContact& contact : contacts_) vertices_.push_back(contact.vertex);
        archive("contact_a", a), archive("contact_b", b), archive("contact_springs", springs_);
        archive("contact_vertex", vertices_);
        archive("contact_normals", normals_), archive("worst_overlap", max_overlap_);
        expect_fit(b.size() == a.size() && springs_.size() == a.size(), "contact_springs");
        expect_fit(normals_.size() == a.size(), "contact_normals");
        expect_fit(vertices_.size() == a.size(), "contact_vertex");
        if (!archive.loads()) return vertices_.clear();
        pairs_.resize(a.size());
        for (std::size_t k = 0; k < a.size(); ++k) pairs_[k] = {a[k], b[k]};
    }
    /// Completes what serialise() loaded.
    void restore(const ContactBodies<D>& bodies);

private:
    /// Pairs that are applied together.
    struct Selection {
        Array<std::size_t> rows;
        ShownPoints points;
        Array<std::size_t> first_push;  // of each of `points` in pushes_on, and their end
        Array<std::size_t> pushes_on;   // row of the pair, doubled, plus one for its second side
        JointContacts joint;
        PushesOnSolids on_solids;
        Array<std::size_t> on_surfaces;  // rows of pairs with surfaces of deformable bodies
        double timestep = std::numeric_limits<double>::infinity();
        Array<std::size_t> kept;  // rows with springs before they were applied, and these
        Array<ContactSprings> springs;
        Array<Vec<double, D>> normals;
    };
    const Selection& of(PairKind kind) const { return selections_[static_cast<std::size_t>(kind)]; }
    Selection& of(PairKind kind) { return selections_[static_cast<std::size_t>(kind)]; }
    PairKind kind_of(std::size_t k) const;
    void select(const ContactBodies<D>& bodies, PairKind kind);
    void keep(Selection& selection) const;

    static std::uint64_t key(const ContactPair& pair) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(pair.a)) << 32 |
               static_cast<std::uint32_t>(pair.b);
    }
    void expect_pairs_of(const ContactBodies<D>& bodies) const;
    PairContact contact_of(const ContactBodies<D>& bodies, const ContactPair& pair) const;
    /// As many rows of the pair as it may have places.
    void add_rows(const ContactBodies<D>& bodies);
    std::size_t most_touched(const ContactBodies<D>& bodies, const ContactPair& pair) const;
    void turn_round(std::size_t k);
    /// Lists for each point, in rising order, the pairs that push it.
    void list_pushes(Selection& selection) const;
    void find_gaps(ContactBodies<D>& bodies, double margin);
    ContactRows<D> rows(ContactBodies<D>& bodies) {
        return {pairs_, springs_, normals_, contacts_, pushes_, bodies.spans(), domain_};
    }

    Domain<D> domain_;
    ContactLaws<D> laws_;
    // One row for each place at which a pair may touch: several in a row for a ball and a surface
    // with hollows, and for balls of which two images are near.
    Array<ContactPair> pairs_;
    Array<ContactSprings> springs_;
    Array<Vec<double, D>> normals_;        // of what touches; zero: nothing
    std::array<Selection, 3> selections_;  // by PairKind
    bool apart_ = false;                   // whether these are of kinds, or of all pairs
    std::size_t slow_bodies_ = 0;
    Array<PairContact> contacts_;
    Array<std::uint32_t> vertices_;  // of contacts_, as they were saved
    Array<PairPush<D>> pushes_;
    double max_overlap_ = 0.0;
};

// Compiled once: bodies.cpp.
extern template class Contacts<2>;
extern template class Contacts<3>;

template <int D>
void Contacts<D>::renumber(const Array<std::int32_t>& point, const Array<std::int32_t>& shape) {
    pushes_.resize(pairs_.size()), contacts_.resize(pairs_.size());
    std::size_t kept = 0;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const std::int32_t a = point[pairs_[k].first()], b = pairs_[k].with_shape()
                                                                 ? shape[pairs_[k].shape()]
                                                                 : point[pairs_[k].second()];
        if (a < 0 || b < 0) continue;
        pairs_[kept] = {a, pairs_[k].with_shape() ? -1 - b : b};
        springs_[kept] = springs_[k], normals_[kept] = normals_[k];
        pushes_[kept] = pushes_[k], contacts_[kept] = contacts_[k];
        if (!pairs_[kept].with_shape() && a > b) turn_round(kept);
        ++kept;
    }
    pairs_.resize(kept), springs_.resize(kept), normals_.resize(kept);
    pushes_.resize(kept), contacts_.resize(kept);
}

/// Of two points the one with the lower number comes first. The stretch of rolling is that of the
/// other's as well, since spin and normal both change their signs.
template <int D>
void Contacts<D>::turn_round(std::size_t k) {
    std::swap(pairs_[k].a, pairs_[k].b);
    std::swap(contacts_[k].body_a, contacts_[k].body_b);
    normals_[k] = -1.0 * normals_[k];
    for (int c = 0; c < 3; ++c) springs_[k][c] = -springs_[k][c];
    PairPush<D>& push = pushes_[k];
    push.force = -1.0 * push.force;
    std::swap(push.torque_a, push.torque_b);
    push.overlap.normal = -1.0 * push.overlap.normal;
    std::swap(push.overlap.lever_a, push.overlap.lever_b);
}

template <int D>
template <class F>
void Contacts<D>::for_each_push(const ContactBodies<D>& bodies, PairKind kind, F&& f) const {
    for (const std::size_t k : of(kind).rows) {
        const PairPush<D>& push = pushes_[k];
        if (!push.touches || bodies.surface(pairs_[k])) continue;  // surfaces are of no fixed body
        const ContactPair& pair = pairs_[k];
        const Vec<double, D>& second = pair.with_shape() ? bodies.solids[pair.shape()].centre
                                                         : bodies.points.position[pair.second()];
        const Vec3 moment =
            push.torque_a - cross(in_space(push.overlap.lever_a), in_space(push.force));
        f(contacts_[k].body_a, contacts_[k].body_b,
          bodies.points.position[pair.first()] + push.overlap.lever_a, push.force, moment,
          push.approach);
        f(contacts_[k].body_b, contacts_[k].body_a, second + push.overlap.lever_b,
          -1.0 * push.force, -1.0 * moment, push.approach);
    }
}

}  // namespace doseki
