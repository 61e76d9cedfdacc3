#pragma once
#include <algorithm>
#include <array>

#include "base/array.hpp"
#include "base/box.hpp"
#include "bodies/rotation.hpp"

namespace doseki {

/// Corners of a segment (2-D) or triangle (3-D) of a surface, whose outside is to the right of a
/// segment and where a triangle is seen anticlockwise.
template <int D>
using Facet = std::array<Vec<double, D>, D>;

template <int D>
DOSEKI_DEVICE_FN Vec<double, D> normal_of(const Facet<D>& facet) {
    const Vec<double, D> u = facet[1] - facet[0];
    Vec<double, D> n;
    if constexpr (D == 2)
        n[0] = u[1], n[1] = -u[0];
    else
        n = cross(u, facet[2] - facet[0]);
    return (1.0 / norm(n)) * n;
}

template <int D>
DOSEKI_DEVICE_FN Vec<double, D> nearest_on_segment(const Vec<double, D>& a, const Vec<double, D>& b,
                                                   const Vec<double, D>& x) {
    const Vec<double, D> u = b - a;
    return a + std::clamp(dot(x - a, u) / dot(u, u), 0.0, 1.0) * u;
}

/// The point of a facet that is nearest to x.
template <int D>
DOSEKI_DEVICE_FN Vec<double, D> nearest_on_facet(const Facet<D>& facet, const Vec<double, D>& x) {
    if constexpr (D == 2)
        return nearest_on_segment(facet[0], facet[1], x);
    else {
        const Vec3 n = normal_of<D>(facet), foot = x - dot(x - facet[0], n) * n;
        bool within = true;
        for (std::size_t k = 0; k < 3; ++k)
            within &= dot(cross(facet[(k + 1) % 3] - facet[k], foot - facet[k]), n) >= 0.0;
        if (within) return foot;
        Vec3 nearest = nearest_on_segment(facet[0], facet[1], x);
        for (std::size_t k = 1; k < 3; ++k) {
            const Vec3 y = nearest_on_segment(facet[k], facet[(k + 1) % 3], x);
            if (dot(x - y, x - y) < dot(x - nearest, x - nearest)) nearest = y;
        }
        return nearest;
    }
}

template <int D>
Array<Box<D>> boxes_of(const Array<Facet<D>>& facets) {
    Array<Box<D>> boxes;
    for (const Facet<D>& facet : facets) {
        boxes.push_back(Box<D>::nowhere());
        for (const Vec<double, D>& corner : facet) boxes.back().add(corner);
    }
    return boxes;
}

}  // namespace doseki
