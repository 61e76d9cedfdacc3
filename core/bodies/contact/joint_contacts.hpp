#pragma once
// Two bodies that touch at many points of their surfaces, Eqs. (157) and (158).

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "bodies/contact/contact_rows.hpp"

namespace doseki {

/// The rows of each two bodies that touch at points of a surface.
struct JointContacts {
    static constexpr double exponent = 8.0;  // P of Eq. (157)

    Array<std::size_t> rows;   // of each two bodies in turn, in rising order
    Array<std::size_t> first;  // of each two, and the end of the last

    JointContacts() = default;
    /// Those among `all` that are joint.
    JointContacts(std::span<const std::size_t> all, std::span<const PairContact> contacts) {
        std::map<std::pair<std::int32_t, std::int32_t>, Array<std::size_t>> of_bodies;
        for (const std::size_t k : all)
            if (contacts[k].joint)
                of_bodies[std::minmax(contacts[k].body_a, contacts[k].body_b)].push_back(k);
        for (const auto& [bodies, of_these] : of_bodies) {
            first.push_back(rows.size());
            rows.insert(rows.end(), of_these.begin(), of_these.end());
        }
        first.push_back(rows.size());
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
    double dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        const Which which = of_bodies.subspan(first[n], first[n + 1] - first[n]);
        double deepest = 0.0;
        for (const std::size_t k : which)
            deepest = std::max(deepest, rows.springs[k][pressed_before]);
        for (const std::size_t k : which) begin(k, deepest);
        share_springs(which);
        share_dashpots(which);
        for (const std::size_t k : which)
            if (rows.pushes[k].touches) rows.push_there(k, dt);
    }

private:
    using Which = std::span<const std::size_t>;

    /// A point that comes into a body from beside, over an edge of that, is deep at once, and so is
    /// one that another facet bears than before. Neither makes energy: the one presses as before,
    /// a corner that begins no more than others do, and a point of an edge not at all.
    DOSEKI_DEVICE_FN void begin(std::size_t k, double deepest) const {
        constexpr double turned = 0.9;  // cosine of more than a normal turns in a step
        const PairPush<D>& push = rows.pushes[k];
        const Vec<double, D>& before = rows.normals[k];
        const std::size_t point = rows.pairs[k].first();
        const bool begins = dot(before, before) == 0.0,
                   ball = rows.bodies.points.radius[point] > 0.0;
        if (!push.touches || ball || (!begins && dot(before, push.overlap.normal) > turned)) return;
        double pressed = rows.springs[k][pressed_before];
        if (begins) {
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
            if (rows.pushes[k].touches) add(k, rows.contacts[which[0]].body_a, middle);
        if (!(middle.force > 0.0)) return;
        middle.divide();
        const double braked =
            middle.stiffness / (middle.roots * middle.roots * mobility(which[0], middle));
        for (const std::size_t k : which) rows.pushes[k].braked = braked;
    }

    DOSEKI_DEVICE_FN void add(std::size_t k, std::int32_t body_a,
                              MiddleOfContact<D>& middle) const {
        const Overlap<D>& overlap = rows.pushes[k].overlap;
        const NormalSpring spring = rows.contacts[k].law.normal_spring(pressed(k));
        const double share = rows.pushes[k].share;
        const std::size_t point = rows.pairs[k].first();
        Vec<double, D> from_own = overlap.lever_a;
        if (const ContactSolid<D>* own = solid_of_point(point))
            from_own = from_own + rows.bodies.points.position[point] - own->centre;
        if (rows.contacts[k].body_a == body_a)
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
