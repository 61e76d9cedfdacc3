#pragma once
#include <cmath>
#include <optional>

#include "bodies/contact_points.hpp"
#include "bodies/nearest_image.hpp"

namespace doseki {

/// How far two bodies overlap: normal from the first to the second, and levers from their centres
/// to the point of contact.
template <int D>
struct Overlap {
    double depth;
    Vec<double, D> normal, lever_a, lever_b;
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

}  // namespace doseki
