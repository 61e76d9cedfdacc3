#pragma once
// The shape that a deformable body has when it becomes rigid, which bodies.cpp compiles.

#include <algorithm>

#include "bodies/deformable/surfaces.hpp"

namespace doseki {

template <int D>
Shape<D> DeformableSurfaces<D>::shape_of(const ContactBodies<D>& contact, std::int32_t shown,
                                         const TotalLagrangian<D>& solids, std::size_t body,
                                         const RigidMotion<D>& motion) const {
    const Mat<double, 3> turn = motion.orientation.matrix();
    const double spacing = solids.material(body).spacing;
    auto in_frame = [&](const Vec<double, D>& x) { return rotated_back(turn, x - motion.centre); };
    Shape<D> shape;
    if constexpr (D == 3) {
        shape.kind = ShapeKind::balls, shape.thickness = spacing;
        for (const SurfaceVertex<D>& vertex : vertices_)
            if (solids.body(vertex.point) == static_cast<std::int32_t>(body))
                shape.samples.push_back(in_frame(solids.x[vertex.point]));
    } else {
        shape.kind = ShapeKind::mesh;
        for (const Surface<D>& surface : contact.surfaces)
            if (surface.body == shown)
                for (std::size_t c = 0; c < surface.first.size(); ++c)
                    add_polygon(surface, c, 1e-3 * spacing, in_frame, shape);
    }
    for (const Vec<double, D>& sample : shape.samples)
        shape.radius = std::max(shape.radius, norm(sample) + 0.5 * shape.thickness);
    for (const Facet<D>& facet : shape.facets)
        for (const Vec<double, D>& corner : facet)
            shape.radius = std::max(shape.radius, norm(corner));
    shape.enclose({});
    return shape;
}

/// Adds a closed curve of a surface to a shape, without sides shorter than `least`.
template <int D>
template <class InFrame>
void DeformableSurfaces<D>::add_polygon(const Surface<D>& surface, std::size_t curve, double least,
                                        const InFrame& in_frame, Shape<D>& shape) {
    const std::size_t end =
        curve + 1 < surface.first.size() ? surface.first[curve + 1] : surface.size();
    Array<Vec<double, D>> corners;
    auto add = [&](std::uint32_t vertex, double t) {
        const Vec<double, D> corner =
            in_frame(surface.mean(surface.position, surface.at(vertex, t)));
        if (!corners.empty() && norm(corner - corners.back()) < least) return false;
        corners.push_back(corner);
        return true;
    };
    for (std::uint32_t v = surface.first[curve]; v < end; ++v) {
        if (add(v, 0.0)) shape.samples.push_back(corners.back());
        add(v, 0.5);
    }
    while (corners.size() > 1 && norm(corners.front() - corners.back()) < least)
        corners.resize(corners.size() - 1);
    for (std::size_t k = 0; k < corners.size(); ++k)
        shape.facets.push_back({corners[k], corners[(k + 1) % corners.size()]});
}

}  // namespace doseki
