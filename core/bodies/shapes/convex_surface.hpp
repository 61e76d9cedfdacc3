#pragma once
#include <algorithm>
#include <limits>

#include "base/array.hpp"
#include "bodies/shapes/facet.hpp"
#include "bodies/shapes/surface_points.hpp"

namespace doseki {

/// The outline of a convex polygon or polyhedron.
template <int D>
class ConvexSurface {
public:
    static constexpr std::size_t most_touched = 1;

    explicit ConvexSurface(Array<Facet<D>> facets) : facets_(std::move(facets)) {
        for (const Facet<D>& facet : facets_)
            for (const Vec<double, D>& corner : facet) radius_ = std::max(radius_, norm(corner));
    }

    DOSEKI_DEVICE_FN double radius() const { return radius_; }

    DOSEKI_DEVICE_FN SurfacePoints<D> touched_by(const Vec<double, D>& x, double radius) const {
        SurfacePoints<D> touched;
        if (const SurfacePoint<D> nearest = from(x); nearest.distance < radius)
            touched.add(nearest);
        return touched;
    }

    DOSEKI_DEVICE_FN bool is_touched_by(const Vec<double, D>& x, double radius) const {
        return !touched_by(x, radius).empty();
    }

    /// Exact outside and inside.
    DOSEKI_DEVICE_FN SurfacePoint<D> from(const Vec<double, D>& x) const {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        SurfacePoint<D> inside{-infinite, {}};
        for (const Facet<D>& facet : facets_) {
            const Vec<double, D> n = normal_of<D>(facet);
            const double d = dot(x - facet[0], n);
            if (d > inside.distance) inside = {d, n};
        }
        if (inside.distance <= 0.0) return inside;
        double nearest_square = infinite;
        Vec<double, D> nearest;
        for (const Facet<D>& facet : facets_) {
            const Vec<double, D> y = nearest_on_facet<D>(facet, x);
            if (const double square = dot(x - y, x - y); square < nearest_square)
                nearest_square = square, nearest = y;
        }
        const double d = std::sqrt(nearest_square);
        return d > 0.0 ? SurfacePoint<D>{d, (1.0 / d) * (x - nearest)} : inside;
    }

private:
    Array<Facet<D>> facets_;
    double radius_ = 0.0;
};

}  // namespace doseki
