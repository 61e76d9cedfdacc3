#pragma once
#include <algorithm>
#include <cstdint>

#include "base/array.hpp"
#include "bodies/shapes/box_tree.hpp"
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
    Array<Vec<double, D>> outward;  // unit normals of the surface there, zero where it has none
    Array<std::uint8_t> is_corner;  // of samples
    SharedSurface<D> surface;       // that others touch; none of a ball

    DOSEKI_DEVICE_FN bool is_ball() const { return kind == ShapeKind::ball; }

    /// Of the box around its facets along the axes as they are turned so; the origin without any.
    Vec<double, D> middle(const Mat<double, 3>& rotation) const {
        if (facets.empty()) return {};
        Box<D> box = Box<D>::nowhere();
        for (const Facet<D>& facet : facets)
            for (const Vec<double, D>& corner : facet) box.add(rotated(rotation, corner));
        return box.middle();
    }

    /// Makes the surface; call once everything else is there. `ground` is that of the run.
    void enclose(const SharedSurface<D>& ground) {
        if (kind == ShapeKind::ground)
            surface = ground;
        else if (kind == ShapeKind::convex)
            surface = SharedSurface<D>::make(ConvexSurface<D>(facets));
        else if (kind == ShapeKind::mesh)
            surface = SharedSurface<D>::make(MeshSurface<D>(facets, thickness));
        set_outward();
    }

private:
    /// At edges and corners the mean of the faces that meet there. A sheet has no outside.
    void set_outward() {
        outward.assign(samples.size(), {}), is_corner.assign(samples.size(), 0);
        if (thickness > 0.0) return;
        const BoxTree<D> tree(boxes_of<D>(facets));
        const double near = 1e-6 * radius;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            Array<Vec<double, D>> normals;
            double square = near * near;
            tree.visit_near(samples[k], square, [&](std::uint32_t f) {
                const Vec<double, D> apart =
                                         samples[k] - nearest_on_facet<D>(facets[f], samples[k]),
                                     n = normal_of<D>(facets[f]);
                const bool counted = std::any_of(normals.begin(), normals.end(),
                                                 [&](const auto& m) { return dot(m, n) > 0.999; });
                if (dot(apart, apart) < square && !counted) normals.push_back(n);
                for (const Vec<double, D>& corner : facets[f])
                    if (norm(samples[k] - corner) < near) is_corner[k] = 1;
            });
            Vec<double, D> sum{};
            for (const Vec<double, D>& n : normals) sum = sum + n;
            if (const double length = norm(sum); length > 0.1) outward[k] = (1.0 / length) * sum;
        }
    }
};

}  // namespace doseki
