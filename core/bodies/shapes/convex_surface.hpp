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

    DOSEKI_DEVICE_FN SurfacePoints<D> touched_by(const Vec<double, D>& x, double radius,
                                                 const Vec<double, D>& outward = {}) const {
        SurfacePoints<D> touched;
        if (const SurfacePoint<D> place = from(x, outward); place.distance < radius)
            touched.add(place);
        return touched;
    }

    DOSEKI_DEVICE_FN bool is_touched_by(const Vec<double, D>& x, double radius) const {
        return !touched_by(x, radius).empty();
    }

    DOSEKI_DEVICE_FN bool holds(const Vec<double, D>& x) const {
        for (const Facet<D>& facet : facets_)
            if (!(dot(x - facet[0], normal_of<D>(facet)) < 0.0)) return false;
        return true;
    }

    /// Exact outside and inside. A sample inside has come in through the facet by which the way
    /// back into its own body leaves first. That is not the nearest facet wherever a sample is
    /// nearer to an edge than it is deep: those of a plane bed would hold back a block that slides
    /// over them. What lies over an edge but for rounding is inside as well: blocks that stand on
    /// one another have their corners there.
    DOSEKI_DEVICE_FN SurfacePoint<D> from(const Vec<double, D>& x,
                                          const Vec<double, D>& outward = {}) const {
        constexpr double infinite = std::numeric_limits<double>::infinity(), along = 1e-6,
                         rounding = 1e-9;
        SurfacePoint<D> inside{-infinite, {}}, entered{infinite, {}};
        double way = infinite;
        for (const Facet<D>& facet : facets_) {
            const Vec<double, D> n = normal_of<D>(facet);
            const double d = dot(x - facet[0], n), against = -dot(n, outward);
            if (d > inside.distance) inside = {d, n};
            if (against > along && -d < way * against) entered = {d, n}, way = -d / against;
        }
        if (inside.distance <= rounding * radius_ && entered.distance <= 0.0) return entered;
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
