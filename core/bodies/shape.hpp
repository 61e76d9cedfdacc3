#pragma once
#include <algorithm>
#include <array>
#include <limits>

#include "base/array.hpp"
#include "bodies/rotation.hpp"

namespace doseki {

/// Signed distance and normal of a surface, as seen from a point.
template <int D>
struct SurfacePoint {
    double distance;        // of the point, negative inside [m]
    Vec<double, D> normal;  // out of the shape
};

/// The outline of a rigid body in its own frame, whose origin is the centre of mass: a ball (in 2-D
/// a disc), or a convex polygon or polyhedron given by its facets.
template <int D>
struct Shape {
    using Facet =
        std::array<Vec<double, D>, D>;  // corners of a segment or triangle, outside to the right

    double radius = 0.0;  // of the ball, or of the ball around everything [m]
    Array<Facet> facets;
    Array<Vec<double, D>> samples;  // points of the surface that may touch another shape

    bool is_ball() const { return facets.empty(); }

    /// Exact outside and inside of a convex shape.
    SurfacePoint<D> surface_from(const Vec<double, D>& x) const {
        if (is_ball()) {
            const double r = norm(x);
            return {r - radius, r > 0.0 ? (1.0 / r) * x : up()};
        }
        SurfacePoint<D> inside{-std::numeric_limits<double>::infinity(), {}};
        for (const Facet& facet : facets) {
            const Vec<double, D> n = normal_of(facet);
            const double d = dot(x - facet[0], n);
            if (d > inside.distance) inside = {d, n};
        }
        if (inside.distance <= 0.0) return inside;
        double nearest_square = std::numeric_limits<double>::infinity();
        Vec<double, D> nearest;
        for (const Facet& facet : facets) {
            const Vec<double, D> y = nearest_point(facet, x);
            if (const double square = dot(x - y, x - y); square < nearest_square)
                nearest_square = square, nearest = y;
        }
        const double d = std::sqrt(nearest_square);
        return d > 0.0 ? SurfacePoint<D>{d, (1.0 / d) * (x - nearest)} : inside;
    }

    static Vec<double, D> normal_of(const Facet& facet) {
        const Vec<double, D> u = facet[1] - facet[0];
        Vec<double, D> n;
        if constexpr (D == 2)
            n[0] = u[1], n[1] = -u[0];
        else
            n = cross(u, facet[2] - facet[0]);
        return (1.0 / norm(n)) * n;
    }

private:
    static Vec<double, D> up() {
        Vec<double, D> v{};
        v[D - 1] = 1.0;
        return v;
    }

    static Vec<double, D> on_segment(const Vec<double, D>& a, const Vec<double, D>& b,
                                     const Vec<double, D>& x) {
        const Vec<double, D> u = b - a;
        return a + std::clamp(dot(x - a, u) / dot(u, u), 0.0, 1.0) * u;
    }

    static Vec<double, D> nearest_point(const Facet& facet, const Vec<double, D>& x) {
        if constexpr (D == 2)
            return on_segment(facet[0], facet[1], x);
        else {
            const Vec3 n = normal_of(facet), foot = x - dot(x - facet[0], n) * n;
            bool within = true;
            for (int k = 0; k < 3; ++k)
                within &= dot(cross(facet[(k + 1) % 3] - facet[k], foot - facet[k]), n) >= 0.0;
            if (within) return foot;
            Vec3 nearest = on_segment(facet[0], facet[1], x);
            for (int k = 1; k < 3; ++k) {
                const Vec3 y = on_segment(facet[k], facet[(k + 1) % 3], x);
                if (dot(x - y, x - y) < dot(x - nearest, x - nearest)) nearest = y;
            }
            return nearest;
        }
    }
};

}  // namespace doseki
