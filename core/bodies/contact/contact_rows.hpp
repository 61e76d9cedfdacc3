#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "bodies/contact_points.hpp"
#include "bodies/overlap.hpp"
#include "bodies/places.hpp"

// Large enough to be called, which would put registers into memory.
#if defined(__CUDACC__)
#define DOSEKI_WHOLE_DEVICE_FN __host__ __device__ __forceinline__
#else
#define DOSEKI_WHOLE_DEVICE_FN
#endif

namespace doseki {

/// A pair that may touch, and how it does.
struct PairContact {
    std::int32_t body_a, body_b;
    ContactLaw law;
    double overlap;
    std::uint32_t vertex = 0;  // of the second one's surface, near the first one's point
    double gap = 0.0;          // at least, when pairs were found [m]
    bool joint = false;        // pushes with others of its two bodies, Eq. (157)
    // Of fixed bodies that hang together, where one of them is the first or the second; -1: no.
    std::int32_t wall = -1;
    bool wall_first = false;
    std::int32_t surface = -1;  // that is touched now, see WallFace

    /// What may push together: two bodies, or one and what hangs together.
    std::pair<std::int32_t, std::int32_t> between() const {
        if (wall < 0) return std::minmax(body_a, body_b);
        return {-1 - wall, wall_first ? body_b : body_a};
    }

    /// How far its sides may come together while points go some way. Vertices of deformable
    /// bodies lie half a spacing beyond them.
    DOSEKI_DEVICE_FN double approach(double moved) const { return (law.rigid ? 2.0 : 4.0) * moved; }
};

/// What a pair does to its bodies; the second one gets the opposite force.
template <int D>
struct PairPush {
    bool touches = false;
    Overlap<D> overlap;
    Vec<double, D> force;
    Vec3 torque_a, torque_b;  // on each body about its own centre or point
    double approach = 0.0;    // speed, where the contact begins
    double share = 1.0;       // of the springs
    double braked = 0.0;      // mass that the dashpot brakes
};

/// The rows of Contacts, one for each place at which a pair may touch, with the bodies: what a
/// thread needs that finds what one pair does.
template <int D>
struct ContactRows {
    std::span<const ContactPair> pairs;
    std::span<ContactSprings> springs;
    std::span<Vec<double, D>> normals;
    std::span<PairContact> contacts;
    std::span<PairPush<D>> pushes;
    ContactBodySpans<D> bodies;
    Domain<D> domain;

    /// Length of the run of one pair that begins with row k; 0 where it began before.
    DOSEKI_DEVICE_FN std::size_t run_from(std::size_t k) const {
        if (k > 0 && pairs[k - 1].is(pairs[k])) return 0;
        std::size_t end = k + 1;
        while (end < pairs.size() && pairs[end].is(pairs[k])) ++end;
        return end - k;
    }

    DOSEKI_DEVICE_FN Overlaps<D> overlaps(std::size_t k) const;
    /// 0 where it is not known.
    DOSEKI_WHOLE_DEVICE_FN double gap(std::size_t k, double margin) const;
    /// Finds what a pair does whose run of rows begins with k, its springs stretching for dt; of a
    /// joint one, where it touches.
    DOSEKI_WHOLE_DEVICE_FN void push(std::size_t k, double dt) const;
    /// Of the two sides of a pair whose overlap is known.
    DOSEKI_DEVICE_FN RelativeMotion relative_motion(std::size_t k) const;
    /// The same of one place whose overlap, share and braked mass are known.
    DOSEKI_DEVICE_FN void push_there(std::size_t k, double dt) const;
    /// The pair of row k does not touch there.
    DOSEKI_DEVICE_FN void part(std::size_t k) const {
        pushes[k].touches = false, contacts[k].overlap = 0.0;
        springs[k] = {}, normals[k] = {};
    }

private:
    /// What two balls do, of which one image is near at most.
    DOSEKI_DEVICE_FN void push_balls(std::size_t k, double dt) const {
        const std::size_t a = pairs[k].first(), b = pairs[k].second();
        const auto& x = bodies.points.position;
        const auto overlap = overlap_of(bodies.points, a, b, nearest_image(domain, x[b] - x[a]));
        if (!overlap) return part(k);
        touch(k, *overlap, 1.0), push_there(k, dt);
    }
    DOSEKI_DEVICE_FN void touch(std::size_t k, const Overlap<D>& overlap, double share) const {
        pushes[k] = {};
        pushes[k].touches = true, pushes[k].overlap = overlap;
        pushes[k].share = share, pushes[k].braked = contacts[k].law.mass;
    }
};

template <int D>
DOSEKI_DEVICE_FN Overlaps<D> ContactRows<D>::overlaps(std::size_t k) const {
    const ContactPair& pair = pairs[k];
    if (const Surface<D>* surface = bodies.surface(pair))
        return overlap_of(bodies.points, pair.first(), *surface, contacts[k].vertex, domain);
    if (!pair.with_shape()) return overlaps_of(bodies.points, pair.first(), pair.second(), domain);
    return overlaps_of(bodies, pair.first(), bodies.solids[pair.shape()], domain);
}

template <int D>
DOSEKI_WHOLE_DEVICE_FN double ContactRows<D>::gap(std::size_t k, double margin) const {
    const ContactPair& pair = pairs[k];
    const Vec<double, D>& x = bodies.points.position[pair.first()];
    const double radius = bodies.points.radius[pair.first()];
    if (const Surface<D>* surface = bodies.surface(pair)) {
        const auto foot = surface->foot(x, contacts[k].vertex, domain);
        return foot ? std::max(0.0, -foot->depth) : 0.0;
    }
    if (!pair.with_shape()) {
        const Vec<double, D> r = nearest_image(domain, bodies.points.position[pair.second()] - x);
        return std::max(0.0, norm(r) - radius - bodies.points.radius[pair.second()]);
    }
    const ContactSolid<D>& solid = bodies.solids[pair.shape()];
    const Vec<double, D> r = solid.place_of(x, domain);
    const auto places = solid.surface->touched_by(rotated_back(solid.rotation, r), radius + margin);
    return places.empty() ? margin : std::max(0.0, places[0].distance - radius);
}

template <int D>
DOSEKI_WHOLE_DEVICE_FN void ContactRows<D>::push(std::size_t k, double dt) const {
    const std::size_t rows = run_from(k);
    if (rows == 0) return;
    if (rows == 1 && !pairs[k].with_shape()) return push_balls(k, dt);
    const Overlaps<D> found = overlaps(k);
    const auto share = shares_of(found);
    const auto row = rows_of(found, std::span<const Vec<double, D>>(normals.data() + k, rows));
    for (std::size_t n = k; n < k + rows; ++n) pushes[n] = {}, contacts[n].overlap = 0.0;
    for (std::size_t place = 0; place < std::min(found.size(), rows); ++place) {
        const std::size_t n = k + row[place];
        touch(n, found[place], share[place]);
        if (!contacts[n].joint) push_there(n, dt);
    }
    for (std::size_t n = k; n < k + rows; ++n)
        if (!pushes[n].touches && contacts[n].wall < 0) part(n);  // others see PushTogether
}

template <int D>
DOSEKI_DEVICE_FN RelativeMotion ContactRows<D>::relative_motion(std::size_t k) const {
    const Overlap<D>& overlap = pushes[k].overlap;
    const ContactPointSpans<D>& points = bodies.points;
    const MotionAt<D> b = motion_of_second(bodies, pairs[k], overlap);
    const std::size_t a = pairs[k].first();
    const Vec<double, D> v_a =
                             points.velocity[a] + turning_velocity(points.spin[a], overlap.lever_a),
                         v_b = b.velocity + turning_velocity(b.spin, overlap.lever_b);
    return {in_space(v_a - v_b), points.spin[a] - b.spin};
}

template <int D>
DOSEKI_DEVICE_FN void ContactRows<D>::push_there(std::size_t k, double dt) const {
    PairContact& contact = contacts[k];
    PairPush<D>& push = pushes[k];
    const Overlap<D>& overlap = push.overlap;
    const bool begins = dot(normals[k], normals[k]) == 0.0;
    normals[k] = overlap.normal;
    const RelativeMotion motion = relative_motion(k);
    ContactAction on_a = contact.law.act(springs[k], overlap.depth, in_space(overlap.normal),
                                         motion, push.braked, dt);
    contact.overlap = overlap.depth - springs[k][rest_overlap];
    on_a.force = push.share * on_a.force, on_a.moment = push.share * on_a.moment;
    auto torque = [&](const Vec<double, D>& lever) {
        return cross(in_space(lever), on_a.force) + on_a.moment;
    };
    push.force = in_run<D>(on_a.force);
    push.torque_a = torque(overlap.lever_a), push.torque_b = -1.0 * torque(overlap.lever_b);
    push.approach = begins ? std::max(0.0, dot(in_run<D>(motion.velocity), overlap.normal)) : 0.0;
}

}  // namespace doseki
