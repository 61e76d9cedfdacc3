#pragma once
#include <cstddef>
#include <utility>
#include <variant>

#include "base/memory.hpp"
#include "base/named.hpp"
#include "bodies/shapes/convex_surface.hpp"
#include "bodies/shapes/ground_surface.hpp"
#include "bodies/shapes/mesh_surface.hpp"
#include "bodies/shapes/surface_points.hpp"

namespace doseki {

/// A surface that contact points of bodies may touch, in its own frame: the outline of a convex
/// body, a mesh of triangles, the ground. All that contacts ask of it is here. Answers depend on
/// the arguments alone, whatever thread asks; one of a device may, which could call no virtual
/// function.
template <int D>
class ContactSurface {
public:
    template <class Kind>
    explicit ContactSurface(Kind surface) : surface_(std::move(surface)) {}

    /// Of a ball about the origin that holds the surface [m]; infinite where none does.
    DOSEKI_DEVICE_FN double radius() const {
        return with_value(surface_, [](const auto& surface) { return surface.radius(); });
    }

    /// How many places a ball may touch at once: 1 of what is convex or smooth, at most
    /// SurfacePoints::most of what has hollows.
    DOSEKI_DEVICE_FN std::size_t most_touched() const {
        return with_value(surface_, [](const auto& surface) { return surface.most_touched; });
    }

    /// The places that a ball of this radius about x touches: those where the distance of x is
    /// below it. In a hollow each of its sides is one, and no two of them lie on one convex part. A
    /// point (radius 0) touches where it is inside, one place at most. `outward`: normal of the
    /// surface that such a point is a sample of; zero: unknown.
    DOSEKI_DEVICE_FN SurfacePoints<D> touched_by(const Vec<double, D>& x, double radius,
                                                 const Vec<double, D>& outward = {}) const {
        return with_value(
            surface_, [&](const auto& surface) { return surface.touched_by(x, radius, outward); });
    }

    /// Whether there is any such place.
    DOSEKI_DEVICE_FN bool is_touched_by(const Vec<double, D>& x, double radius) const {
        return with_value(surface_,
                          [&](const auto& surface) { return surface.is_touched_by(x, radius); });
    }

    bool is_convex() const { return std::holds_alternative<ConvexSurface<D>>(surface_); }

    /// Whether x is inside of what is convex.
    DOSEKI_DEVICE_FN bool holds(const Vec<double, D>& x) const {
        const auto* convex = std::get_if<ConvexSurface<D>>(&surface_);
        return convex && convex->holds(x);
    }

private:
    std::variant<ConvexSurface<D>, MeshSurface<D>, GroundSurface<D>> surface_;
};

template <int D>
using SharedSurface = Shared<const ContactSurface<D>>;

}  // namespace doseki
