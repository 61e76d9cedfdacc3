#pragma once
#include <cstdint>

#include "base/array.hpp"
#include "bodies/shapes/contact_surface.hpp"

namespace doseki {

enum class ShapeKind : std::uint8_t { ball, convex, mesh, ground, balls };

inline bool has_facets(ShapeKind kind) {
    return kind == ShapeKind::convex || kind == ShapeKind::mesh;
}

/// The outline of a rigid body in its own frame, whose origin is the centre of mass: a ball (in 2-D
/// a disc), what facets enclose, convex or not, a sheet of facets, the ground of a terrain, or
/// balls around points of a surface.
template <int D>
struct Shape {
    ShapeKind kind = ShapeKind::ball;
    double radius = 0.0;     // of the ball, or of the ball around everything [m]
    double thickness = 0.0;  // of a sheet; diameter of each of many balls [m]
    Array<Facet<D>> facets;
    // Points of the surface that may touch another shape; the middles of many balls.
    Array<Vec<double, D>> samples;
    SharedSurface<D> surface;  // that others touch; none of a ball

    DOSEKI_DEVICE_FN bool is_ball() const { return kind == ShapeKind::ball; }

    /// Makes the surface; call once everything else is there. `ground` is that of the run.
    void enclose(const SharedSurface<D>& ground) {
        if (kind == ShapeKind::ground)
            surface = ground;
        else if (kind == ShapeKind::convex)
            surface = SharedSurface<D>::make(ConvexSurface<D>(facets));
        else if (kind == ShapeKind::mesh)
            surface = SharedSurface<D>::make(MeshSurface<D>(facets, thickness));
    }
};

}  // namespace doseki
