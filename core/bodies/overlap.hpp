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

/// What a contact point touches: another one, a convex body or a surface.
template <int D>
class SecondSide {
public:
    SecondSide(ContactBodies<D>& bodies, const ContactPair& pair, const Overlap<D>& overlap)
        : points_(bodies.points),
          point_(pair.with_shape() ? 0 : pair.second()),
          surface_(bodies.surface(pair)),
          convex_(pair.with_shape() && !surface_ ? &bodies.convex[pair.shape()] : nullptr),
          at_(overlap.at) {}

    /// Where the lever of the contact begins.
    Vec<double, D> velocity() const {
        if (surface_) return surface_->mean(surface_->velocity, at_);
        return convex_ ? convex_->velocity : points_.velocity[point_];
    }
    Vec3 spin() const {
        if (surface_) return surface_->spin[at_.nearest()];
        return convex_ ? convex_->spin : points_.spin[point_];
    }
    void push(const Vec<double, D>& force, const Vec3& torque) const {
        if (surface_)
            surface_->push(at_, force, torque);
        else if (convex_)
            convex_->force = convex_->force + force, convex_->torque = convex_->torque + torque;
        else
            points_.force[point_] = points_.force[point_] + force,
            points_.torque[point_] = points_.torque[point_] + torque;
    }

private:
    ContactPoints<D>& points_;
    std::size_t point_;
    Surface<D>* surface_;
    ConvexBody<D>* convex_;
    const SurfaceWeights& at_;
};

}  // namespace doseki
