#pragma once
#include <algorithm>
#include <cstdint>

#include "bodies/contact_points.hpp"
#include "bodies/rotation.hpp"
#include "model/domain.hpp"

namespace doseki {

/// The largest radius, up to its own, with which a ball among the contact points touches nothing,
/// Eq. (123). Balls of bodies from `first_dust` on share the room between them.
template <int D>
double room_for_dust(const ContactBodies<D>& bodies, std::int32_t body, std::int32_t first_dust,
                     const Domain<D>& domain) {
    constexpr double least = 0.1;  // of its own radius: smaller ones would be resolved by no step
    const ContactPoints<D>& points = bodies.points;
    const auto own = static_cast<std::size_t>(
        std::lower_bound(points.body.begin(), points.body.end(), body) - points.body.begin());
    const Vec<double, D>& centre = points.position[own];
    const double largest = points.radius[own];
    double room = largest;
    for (std::size_t c = 0; c < points.size(); ++c) {
        if (points.body[c] == body || points.removed[c]) continue;
        const double distance = norm(nearest_image(domain, points.position[c] - centre));
        const bool dust = points.body[c] >= first_dust && !points.deformable[c];
        room = std::min(room, dust ? 0.5 * distance : distance - points.radius[c]);
    }
    for (const ContactSolid<D>& solid : bodies.solids) {
        if (solid.removed) continue;
        const Vec<double, D> r = solid.place_of(centre, domain);
        const double around = solid.surface->radius() + largest;
        if (dot(r, r) >= around * around) continue;
        for (const auto& place :
             solid.surface->touched_by(rotated_back(solid.rotation, r), largest))
            room = std::min(room, place.distance);
    }
    return std::max(room, least * largest);
}

}  // namespace doseki
