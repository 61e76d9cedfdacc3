#pragma once
// Where a contact point touches a solid beside which others may stand.

#include "bodies/contact_points.hpp"
#include "model/domain.hpp"

namespace doseki {

/// Whether x lies in a fixed convex solid other than two bodies; of a fixed one they are one.
template <int D>
DOSEKI_DEVICE_FN bool is_covered(const ContactBodySpans<D>& bodies, const Vec<double, D>& x,
                                 std::int32_t one, std::int32_t other, const Domain<D>& domain) {
    for (const ContactSolid<D>& solid : bodies.solids) {
        if (!solid.fixed || solid.removed || solid.body == one || solid.body == other) continue;
        const Vec<double, D> r = solid.place_of(x, domain);
        const double radius = solid.surface->radius();
        if (dot(r, r) < radius * radius && solid.surface->holds(rotated_back(solid.rotation, r)))
            return true;
    }
    return false;
}

/// The places of a solid that point a touches, r from its centre. A sample at an edge goes in by no
/// side that another solid covers: a block would stop at the seam of two beds, where it is nearer
/// to the side of the second one than to its top.
template <int D>
DOSEKI_DEVICE_FN SurfacePoints<D> touched_places(const ContactBodySpans<D>& bodies, std::size_t a,
                                                 const ContactSolid<D>& solid,
                                                 const Vec<double, D>& r, const Domain<D>& domain) {
    // Of the radius of the solid; what lies deeper has not come in by its next side either.
    constexpr double against = 0.999, beyond = 1e-6, deepest = 0.05;
    const ContactPointSpans<D>& points = bodies.points;
    const Vec<double, D> x = rotated_back(solid.rotation, r);
    Vec<double, D> outward = points.outward[a];
    for (bool again = false;; again = true) {
        const SurfacePoints<D> places =
            solid.surface->touched_by(x, points.radius[a], rotated_back(solid.rotation, outward));
        const bool fixed = solid.fixed || points.fixed[a];
        if (again && !places.empty() && places[0].distance < -deepest * solid.surface->radius())
            return {};
        if (again || !fixed || places.empty() || dot(outward, outward) == 0.0) return places;
        const Vec<double, D> n = rotated(solid.rotation, places[0].normal);
        if (-dot(n, outward) > against) return places;
        const double step = beyond * solid.surface->radius();
        const Vec<double, D> out =
            solid.fixed ? (step - places[0].distance) * n : -step * (n + outward);
        // The next image of a wall may cover its end; itself it does not reach as far as that.
        const std::int32_t other = solid.fixed ? points.body[a] : solid.body;
        if (!is_covered(bodies, points.position[a] + out, other, points.body[a], domain))
            return places;
        outward = outward - dot(n, outward) * n;
        if (const double size = norm(outward); size > 0.0) outward = (1.0 / size) * outward;
    }
}

}  // namespace doseki
