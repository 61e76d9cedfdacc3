#pragma once
#include <cmath>
#include <optional>

#include "bodies/contact_points.hpp"
#include "model/domain.hpp"

namespace doseki {

/// How far two bodies overlap: normal from the first to the second, and levers from their centres
/// to the point of contact.
template <int D>
struct Overlap {
    double depth;
    Vec<double, D> normal, lever_a, lever_b;
    SurfaceWeights at{};  // where the second one's surface is touched
};

template <int D>
std::optional<Overlap<D>> overlap_of(const ContactPoints<D>& points, std::size_t a, std::size_t b,
                                     const Domain<D>& domain) {
    const Vec<double, D> r = nearest_image(domain, points.position[b] - points.position[a]);
    const double reach = points.radius[a] + points.radius[b], square = dot(r, r);
    if (square >= reach * reach || square == 0.0) return {};
    const double distance = std::sqrt(square);
    Overlap<D> overlap{reach - distance, (1.0 / distance) * r, {}, {}};
    overlap.lever_a = (points.radius[a] - 0.5 * overlap.depth) * overlap.normal;
    overlap.lever_b = overlap.lever_a - r;
    return overlap;
}

template <int D>
std::optional<Overlap<D>> overlap_of(const ContactPoints<D>& points, std::size_t a,
                                     const ConvexBody<D>& convex, const Domain<D>& domain) {
    const Vec<double, D> r = nearest_image(domain, points.position[a] - convex.centre);
    const double around = convex.shape->radius + points.radius[a];
    if (dot(r, r) >= around * around) return {};
    const SurfacePoint<D> surface = convex.shape->surface_from(rotated_back(convex.rotation, r));
    if (surface.distance >= points.radius[a]) return {};
    Overlap<D> overlap{points.radius[a] - surface.distance,
                       -1.0 * rotated(convex.rotation, surface.normal),
                       {},
                       {}};
    overlap.lever_a = (points.radius[a] - 0.5 * overlap.depth) * overlap.normal;
    overlap.lever_b = r + overlap.lever_a;
    return overlap;
}

/// Near a vertex of the surface.
template <int D>
std::optional<Overlap<D>> overlap_of(const ContactPoints<D>& points, std::size_t a,
                                     const Surface<D>& surface, std::uint32_t vertex,
                                     const Domain<D>& domain) {
    const auto foot = surface.foot(points.position[a], vertex, domain);
    if (!foot || foot->depth <= 0.0) return {};
    Overlap<D> overlap{foot->depth, -1.0 * foot->normal, {}, {}, foot->at};
    overlap.lever_a = 0.5 * foot->apart;
    overlap.lever_b = -0.5 * foot->apart;
    return overlap;
}

/// How what a contact point touches moves where the lever of the contact begins.
template <int D>
struct MotionAt {
    Vec<double, D> velocity;
    Vec3 spin;
};

/// Of the second side of a pair: another point, a convex body or a surface.
template <int D>
MotionAt<D> motion_of_second(const ContactBodies<D>& bodies, const ContactPair& pair,
                             const Overlap<D>& overlap) {
    if (const Surface<D>* surface = bodies.surface(pair))
        return {surface->mean(surface->velocity, overlap.at), surface->spin[overlap.at.nearest()]};
    if (pair.with_shape()) {
        const ConvexBody<D>& convex = bodies.convex[pair.shape()];
        return {convex.velocity, convex.spin};
    }
    return {bodies.points.velocity[pair.second()], bodies.points.spin[pair.second()]};
}

/// Gives force and torque to the second side of a pair.
template <int D>
void push_second(ContactBodies<D>& bodies, const ContactPair& pair, const Overlap<D>& overlap,
                 const Vec<double, D>& force, const Vec3& torque) {
    auto add_to = [&](Vec<double, D>& forces, Vec3& torques) {
        forces = forces + force, torques = torques + torque;
    };
    if (Surface<D>* surface = bodies.surface(pair))
        surface->push(overlap.at, force, torque);
    else if (pair.with_shape())
        add_to(bodies.convex[pair.shape()].force, bodies.convex[pair.shape()].torque);
    else
        add_to(bodies.points.force[pair.second()], bodies.points.torque[pair.second()]);
}

}  // namespace doseki
