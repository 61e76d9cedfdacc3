#pragma once
#include <array>
#include <cmath>
#include <optional>

#include "bodies/contact_points.hpp"
#include "bodies/touched_places.hpp"
#include "model/domain.hpp"

namespace doseki {

/// How far two bodies overlap: normal from the first to the second, and levers from their centres
/// to the point of contact.
template <int D>
struct Overlap {
    double depth;
    Vec<double, D> normal, lever_a, lever_b;
    typename Surface<D>::Place at{};  // where the second one's surface is touched
};

/// Those of one pair, few.
template <int D>
class Overlaps {
public:
    Overlaps() = default;
    DOSEKI_DEVICE_FN Overlaps(const std::optional<Overlap<D>>& overlap) {
        if (overlap) add(*overlap);
    }
    /// Unless there are as many as there may be.
    DOSEKI_DEVICE_FN void add(const Overlap<D>& overlap) {
        if (count_ < overlaps_.size()) overlaps_[count_++] = overlap;
    }
    DOSEKI_DEVICE_FN std::size_t size() const { return count_; }
    DOSEKI_DEVICE_FN const Overlap<D>& operator[](std::size_t k) const { return overlaps_[k]; }
    DOSEKI_DEVICE_FN const Overlap<D>* begin() const { return overlaps_.data(); }
    DOSEKI_DEVICE_FN const Overlap<D>* end() const { return overlaps_.data() + count_; }

private:
    std::array<Overlap<D>, SurfacePoints<D>::most> overlaps_;
    std::size_t count_ = 0;
};

/// How many images may be nearer at once than `distance`, which is less than any period: two along
/// each axis of whose period it is more than half.
template <int D>
std::size_t images_within(const Domain<D>& domain, double distance) {
    std::size_t images = 1;
    for (int c = 0; c < D; ++c)
        if (domain.periodic[c] && 2.0 * distance > domain.length(c)) images *= 2;
    return images;
}

/// Calls f with the vectors to the images that are nearer than `distance`, the nearest first.
template <int D, class F>
DOSEKI_DEVICE_FN void for_each_image_within(const Domain<D>& domain, const Vec<double, D>& r,
                                            double distance, F&& f) {
    const Vec<double, D> nearest = nearest_image(domain, r);
    for (int image = 0; image < 1 << D; ++image) {
        Vec<double, D> other = nearest;
        bool is_there = true;
        for (int c = 0; c < D; ++c) {
            if (!(image >> c & 1)) continue;
            is_there = is_there && domain.periodic[c];
            other[c] -= std::copysign(domain.length(c), nearest[c]);
        }
        if (is_there && dot(other, other) < distance * distance) f(other);
    }
}

/// Of two balls, r from the first to the second.
template <int D>
DOSEKI_DEVICE_FN std::optional<Overlap<D>> overlap_of(const ContactPointSpans<D>& points,
                                                      std::size_t a, std::size_t b,
                                                      const Vec<double, D>& r) {
    const double reach = points.radius[a] + points.radius[b], square = dot(r, r);
    if (square >= reach * reach || square == 0.0) return {};
    const double distance = std::sqrt(square);
    Overlap<D> overlap{reach - distance, (1.0 / distance) * r, {}, {}};
    overlap.lever_a = (points.radius[a] - 0.5 * overlap.depth) * overlap.normal;
    overlap.lever_b = overlap.lever_a - r;
    return overlap;
}

/// With each image that it touches.
template <int D>
DOSEKI_DEVICE_FN Overlaps<D> overlaps_of(const ContactPointSpans<D>& points, std::size_t a,
                                         std::size_t b, const Domain<D>& domain) {
    Overlaps<D> overlaps;
    for_each_image_within(domain, points.position[b] - points.position[a],
                          points.radius[a] + points.radius[b], [&](const Vec<double, D>& r) {
                              if (const auto overlap = overlap_of(points, a, b, r))
                                  overlaps.add(*overlap);
                          });
    return overlaps;
}

/// At each place of the solid that the point touches, the nearest first.
template <int D>
DOSEKI_DEVICE_FN Overlaps<D> overlaps_of(const ContactBodySpans<D>& bodies, std::size_t a,
                                         const ContactSolid<D>& solid, const Domain<D>& domain) {
    const ContactPointSpans<D>& points = bodies.points;
    const Vec<double, D> r = solid.place_of(points.position[a], domain);
    const double radius = points.radius[a], around = solid.surface->radius() + radius;
    Overlaps<D> overlaps;
    if (dot(r, r) >= around * around) return overlaps;
    for (const SurfacePoint<D>& place : touched_places(bodies, a, solid, r, domain)) {
        Overlap<D> overlap{
            radius - place.distance, -1.0 * rotated(solid.rotation, place.normal), {}, {}};
        overlap.lever_a = (radius - 0.5 * overlap.depth) * overlap.normal;
        overlap.lever_b = r + overlap.lever_a;
        overlaps.add(overlap);
    }
    return overlaps;
}

/// Near a vertex of the surface.
template <int D>
DOSEKI_DEVICE_FN std::optional<Overlap<D>> overlap_of(const ContactPointSpans<D>& points,
                                                      std::size_t a, const Surface<D>& surface,
                                                      std::uint32_t vertex,
                                                      const Domain<D>& domain) {
    const auto foot = surface.foot(points.position[a], vertex, domain);
    if (!foot || foot->depth <= 0.0) return {};
    Overlap<D> overlap{foot->depth, -1.0 * foot->normal, {}, {}, foot->at};
    // Halfway between the surfaces; in space the mean of the vertices lies beside the second one.
    overlap.lever_a = D == 2 ? 0.5 * foot->apart : 0.5 * foot->depth * foot->normal;
    overlap.lever_b = overlap.lever_a - foot->apart;
    return overlap;
}

/// How what a contact point touches moves where the lever of the contact begins.
template <int D>
struct MotionAt {
    Vec<double, D> velocity;
    Vec3 spin;
};

/// Of the second side of a pair: another point, a solid or a surface.
template <int D>
DOSEKI_DEVICE_FN MotionAt<D> motion_of_second(const ContactBodySpans<D>& bodies,
                                              const ContactPair& pair, const Overlap<D>& overlap) {
    if (const Surface<D>* surface = bodies.surface(pair))
        return {surface->mean(surface->velocity, overlap.at), surface->spin_at(overlap.at)};
    if (pair.with_shape()) {
        const ContactSolid<D>& solid = bodies.solids[pair.shape()];
        return {solid.velocity, solid.spin};
    }
    return {bodies.points.velocity[pair.second()], bodies.points.spin[pair.second()]};
}

}  // namespace doseki
