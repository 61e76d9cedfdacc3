#pragma once
#include <memory>

#include "base/array.hpp"
#include "bodies/contact_surface.hpp"
#include "bodies/shapes/convex_surface.hpp"

namespace doseki {

/// The outline of a rigid body in its own frame, whose origin is the centre of mass: a ball (in 2-D
/// a disc), or what the facets of a surface enclose.
template <int D>
struct Shape {
    double radius = 0.0;  // of the ball, or of the ball around everything [m]
    Array<Facet<D>> facets;
    Array<Vec<double, D>> samples;  // points of the surface that may touch another shape
    std::shared_ptr<const ContactSurface<D>> surface;  // that others touch; none of a ball

    bool is_ball() const { return surface == nullptr; }

    /// Makes the surface of the facets.
    void enclose() {
        if (facets.empty()) return;
        surface = std::make_shared<const ConvexSurface<D>>(facets);
    }
};

}  // namespace doseki
