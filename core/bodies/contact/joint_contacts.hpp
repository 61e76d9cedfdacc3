#pragma once
// Two bodies that touch at many points of their surfaces, Eqs. (157) and (158).

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "bodies/contact/contact_rows.hpp"

namespace doseki {

/// The rows of each two bodies, or of a body and fixed ones that hang together, that touch at
/// points of a surface.
struct JointContacts {
    static constexpr double exponent = 8.0;  // P of Eq. (157)

    Array<std::size_t> rows;   // of each two in turn, in rising order; on walls by their points
    Array<std::size_t> first;  // of each two, and the end of the last
    Array<std::size_t> order;  // room for the rows as they push together

    JointContacts() = default;
    /// Those among `all` that are joint.
    JointContacts(std::span<const std::size_t> all, std::span<const PairContact> contacts,
                  std::span<const ContactPair> pairs) {
        std::map<std::pair<std::int32_t, std::int32_t>, Array<std::size_t>> of_bodies;
        for (const std::size_t k : all)
            if (contacts[k].joint) of_bodies[contacts[k].between()].push_back(k);
        for (auto& [bodies, of_these] : of_bodies) {
            if (contacts[of_these[0]].wall >= 0)
                std::ranges::stable_sort(of_these, {}, [&](std::size_t k) { return pairs[k].a; });
            first.push_back(rows.size());
            rows.insert(rows.end(), of_these.begin(), of_these.end());
        }
        first.push_back(rows.size());
        order.resize(rows.size());
    }

    std::size_t size() const { return first.empty() ? 0 : first.size() - 1; }

    /// Of two bodies that may touch at so many points. Against turning they are stiffer than where
    /// they are pressed together.
    static Together together(double points) {
        constexpr double turned = 3.0;  // square of half a length over the radius of inertia
        const double flat = std::pow(points, 2.0 / exponent);
        return {turned * (exponent - 1.0) * flat, turned * std::sqrt(flat)};
    }
};

/// Where the contacts of two bodies press in the mean, each as much as its force, and their
/// springs.
template <int D>
struct MiddleOfContact {
    Vec<double, D> normal{}, arm_a{}, arm_b{};  // from a to b; arms from the centres
    double force = 0.0;
    double stiffness = 0.0, roots = 0.0;  // sums of stiffnesses and of their square roots

    /// A spring of which a share presses.
    DOSEKI_DEVICE_FN void add(const NormalSpring& spring, double share, const Vec<double, D>& n,
                              const Vec<double, D>& from_a, const Vec<double, D>& from_b) {
        const double more = share * spring.force;
        force += more, normal = normal + more * n;
        arm_a = arm_a + more * from_a, arm_b = arm_b + more * from_b;
        stiffness += share * spring.stiffness, roots += share * std::sqrt(spring.stiffness);
    }
    DOSEKI_DEVICE_FN void divide() {
        arm_a = (1.0 / force) * arm_a, arm_b = (1.0 / force) * arm_b;
        if (const double length = norm(normal); length > 0.0) normal = (1.0 / length) * normal;
    }
};

/// What the contacts of two bodies do together, one row after another, so that sums have one order.
template <int D>
struct PushTogether {
    ContactRows<D> rows;
    std::span<const std::size_t> of_bodies, first;  // see JointContacts
    std::span<std::size_t> order;
    double dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        const std::size_t count = first[n + 1] - first[n];
        const Which which = of_bodies.subspan(first[n], count);
        if (rows.contacts[which[0]].wall < 0)
            push(which);
        else
            push_on_wall(which, order.subspan(first[n], count));
    }

private:
    using Which = std::span<const std::size_t>;
    static constexpr double aslant = 0.7;  // cosine of 45 degrees

    /// Each surface takes what presses on it, in whichever of its bodies. Rows of one point follow
    /// each other.
    DOSEKI_DEVICE_FN void push_on_wall(Which which, std::span<std::size_t> together) const {
        for (std::size_t m = 0, end = 0; m < which.size(); m = end) {
            while (end < which.size() && rows.pairs[which[end]].a == rows.pairs[which[m]].a) ++end;
            pass_on(which.subspan(m, end - m));
        }
        for (std::size_t m = 0; m < which.size(); ++m) {
            if (!rows.pushes[which[m]].touches) continue;
            bool done = false;
            for (std::size_t l = 0; l < m && !done; ++l) done = is_with(which[l], which[m]);
            if (done) continue;
            std::size_t count = 0;
            for (const std::size_t k : which.subspan(m))
                if (is_with(which[m], k)) together[count++] = k;
            push(together.first(count));
        }
    }

    /// A point that leaves one body over a seam does to the next what it did there, and on the seam
    /// it touches one of them.
    DOSEKI_DEVICE_FN void pass_on(Which of_point) const {
        for (const std::size_t k : of_point)
            for (const std::size_t from : of_point)
                if (rows.pushes[k].touches && begins(k) && !rows.pushes[from].touches &&
                    !begins(from) && goes_on(from, k)) {
                    rows.springs[k] = rows.springs[from], rows.normals[k] = rows.normals[from];
                    rows.part(from);
                }
        for (const std::size_t k : of_point) {
            if (!rows.pushes[k].touches) rows.part(k);
            rows.contacts[k].surface = rows.pushes[k].touches ? surface_touched(k) : -1;
        }
        for (const std::size_t k : of_point)
            for (const std::size_t other : of_point)
                if (k < other && rows.contacts[k].surface >= 0 && is_with(k, other))
                    rows.part(begins(k) && !begins(other) ? k : other);
    }

    /// Whether a row is pushed as another one was: over a seam it is, in a corner not.
    DOSEKI_DEVICE_FN bool goes_on(std::size_t before, std::size_t now) const {
        return dot(rows.normals[before], rows.pushes[now].overlap.normal) > aslant;
    }
    DOSEKI_DEVICE_FN bool begins(std::size_t k) const {
        return dot(rows.normals[k], rows.normals[k]) == 0.0;
    }

    /// Whether two rows touch one surface, or two bodies beside any.
    DOSEKI_DEVICE_FN bool is_with(std::size_t one, std::size_t other) const {
        if (!rows.pushes[one].touches || !rows.pushes[other].touches) return false;
        const PairContact &a = rows.contacts[one], &b = rows.contacts[other];
        if (a.surface >= 0 || b.surface >= 0) return a.surface == b.surface;
        return std::min(a.body_a, a.body_b) == std::min(b.body_a, b.body_b) &&
               std::max(a.body_a, a.body_b) == std::max(b.body_a, b.body_b);
    }

    /// The one that faces what presses and is nearest to where it does; -1: none that goes on in
    /// another body.
    DOSEKI_DEVICE_FN std::int32_t surface_touched(std::size_t k) const {
        const bool first = rows.contacts[k].wall_first;
        const std::size_t point = rows.pairs[k].first();
        const ContactSolid<D>& solid =
            first ? *solid_of_point(point) : *rows.bodies.solid(rows.pairs[k]);
        const Overlap<D>& overlap = rows.pushes[k].overlap;
        const Vec<double, D> out =
            rotated_back(solid.rotation, (first ? 1.0 : -1.0) * overlap.normal);
        const Vec<double, D> place =
            rotated_back(solid.rotation,
                         first ? overlap.lever_a + rows.bodies.points.position[point] - solid.centre
                               : overlap.lever_b);
        double nearest = std::numeric_limits<double>::infinity();
        std::int32_t surface = -1;
        for (std::size_t f = solid.first_face; f < solid.end_face; ++f) {
            const WallFace<D>& face = rows.bodies.faces[f];
            const double off = std::abs(dot(face.normal, place) - face.height);
            if (dot(face.normal, out) > aslant && off < nearest)
                nearest = off, surface = face.surface;
        }
        return surface;
    }

    DOSEKI_DEVICE_FN void push(Which which) const {
        double deepest = 0.0;
        for (const std::size_t k : which)
            deepest = std::max(deepest, rows.springs[k][pressed_before]);
        for (const std::size_t k : which) begin(k, deepest);
        share_springs(which);
        share_dashpots(which);
        for (const std::size_t k : which)
            if (rows.pushes[k].touches) rows.push_there(k, dt);
    }

    /// A point that comes into a body from beside, over an edge of that, is deep at once, and so is
    /// one that another facet bears than before. Neither makes energy: the one presses as before,
    /// a corner that begins no more than others do, and a point of an edge not at all.
    DOSEKI_DEVICE_FN void begin(std::size_t k, double deepest) const {
        constexpr double turned = 0.9;  // cosine of more than a normal turns in a step
        const PairPush<D>& push = rows.pushes[k];
        const Vec<double, D>& before = rows.normals[k];
        const std::size_t point = rows.pairs[k].first();
        const bool anew = begins(k), ball = rows.bodies.points.radius[point] > 0.0;
        if (!push.touches || ball || (!anew && dot(before, push.overlap.normal) > turned)) return;
        double pressed = rows.springs[k][pressed_before];
        if (anew) {
            const Vec<double, D> speed = in_run<D>(rows.relative_motion(k).velocity);
            pressed = dt * std::max(0.0, dot(speed, push.overlap.normal));
            if (rows.bodies.points.corner[point]) pressed = std::max(pressed, deepest);
        }
        rows.springs[k][rest_overlap] = std::max(0.0, push.overlap.depth - pressed);
    }

    /// The overlap of a row that presses.
    DOSEKI_DEVICE_FN double pressed(std::size_t k) const {
        if (!rows.pushes[k].touches) return 0.0;
        return std::max(0.0, rows.pushes[k].overlap.depth - rows.springs[k][rest_overlap]);
    }

    /// Eq. (157).
    DOSEKI_DEVICE_FN void share_springs(Which which) const {
        double deepest = 0.0, sum = 0.0;
        for (const std::size_t k : which) deepest = std::max(deepest, pressed(k));
        if (deepest == 0.0) return;
        for (const std::size_t k : which) {
            const double part = pressed(k) / deepest, square = part * part;
            sum += square * square * square * square;
        }
        const double joint = deepest * std::sqrt(std::sqrt(std::sqrt(sum)));
        for (const std::size_t k : which) {
            const double part = pressed(k) / joint, square = part * part;
            rows.pushes[k].share *= rows.contacts[k].law.hertz
                                        ? square * square * part * std::sqrt(part)
                                        : square * square * square;
        }
    }

    /// Eq. (158).
    DOSEKI_DEVICE_FN void share_dashpots(Which which) const {
        MiddleOfContact<D> middle;
        for (const std::size_t k : which)
            if (rows.pushes[k].touches) add(k, rows.contacts[which[0]], middle);
        if (!(middle.force > 0.0)) return;
        middle.divide();
        const double braked =
            middle.stiffness / (middle.roots * middle.roots * mobility(which[0], middle));
        for (const std::size_t k : which) rows.pushes[k].braked = braked;
    }

    /// As `one` has its bodies; of one body and a wall that may be another fixed one.
    DOSEKI_DEVICE_FN void add(std::size_t k, const PairContact& one,
                              MiddleOfContact<D>& middle) const {
        const Overlap<D>& overlap = rows.pushes[k].overlap;
        const NormalSpring spring = rows.contacts[k].law.normal_spring(pressed(k));
        const double share = rows.pushes[k].share;
        const std::size_t point = rows.pairs[k].first();
        Vec<double, D> from_own = overlap.lever_a;
        if (const ContactSolid<D>* own = solid_of_point(point))
            from_own = from_own + rows.bodies.points.position[point] - own->centre;
        if (rows.contacts[k].body_a == one.body_a || rows.contacts[k].body_b == one.body_b)
            middle.add(spring, share, overlap.normal, from_own, overlap.lever_b);
        else
            middle.add(spring, share, -1.0 * overlap.normal, overlap.lever_b, from_own);
    }

    /// What one unit of impulse between the bodies makes of their speed of approach [1/kg]; k is a
    /// row whose point is of the first one.
    DOSEKI_DEVICE_FN double mobility(std::size_t k, const MiddleOfContact<D>& middle) const {
        const ContactPointSpans<D>& points = rows.bodies.points;
        const std::size_t point = rows.pairs[k].first();
        const double of_b = rows.bodies.solid(rows.pairs[k])->mobility(middle.arm_b, middle.normal);
        if (const ContactSolid<D>* own = solid_of_point(point))
            return of_b + own->mobility(middle.arm_a, middle.normal);
        return of_b + (points.fixed[point] ? 0.0 : 1.0 / points.mass[point]);
    }

    DOSEKI_DEVICE_FN const ContactSolid<D>* solid_of_point(std::size_t point) const {
        const std::int32_t solid = rows.bodies.points.solid[point];
        return solid < 0 ? nullptr : &rows.bodies.solids[static_cast<std::size_t>(solid)];
    }
};

}  // namespace doseki
