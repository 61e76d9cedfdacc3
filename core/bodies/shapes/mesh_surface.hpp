#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "base/array.hpp"
#include "bodies/shapes/box_tree.hpp"
#include "bodies/shapes/facet.hpp"
#include "bodies/shapes/mesh_corners.hpp"
#include "bodies/shapes/surface_points.hpp"

namespace doseki {

/// A mesh of facets, convex or not: the outside of what it encloses or, with a thickness, all that
/// is nearer to it than half of that, on both of its sides.
template <int D>
class MeshSurface {
public:
    static constexpr std::size_t most_touched = SurfacePoints<D>::most;

    /// Corners that facets share must be the same numbers.
    MeshSurface(const Array<Facet<D>>& facets, double thickness)
        : mesh_(facets), tree_(boxes_of<D>(facets)), half_(0.5 * thickness) {
        for (const Facet<D>& facet : facets)
            for (const Vec<double, D>& corner : facet)
                radius_ = std::max(radius_, norm(corner) + half_);
    }

    DOSEKI_DEVICE_FN double radius() const { return radius_; }

    DOSEKI_DEVICE_FN SurfacePoints<D> touched_by(const Vec<double, D>& x, double radius,
                                                 const Vec<double, D>& = {}) const {
        SurfacePoints<D> touched;
        const Foot nearest = nearest_foot(x, radius);
        if (nearest.facet == none) return touched;
        const SurfacePoint<D> place = place_of(nearest, x);
        if (!(place.distance < radius)) return touched;
        if (radius == 0.0 || place.distance <= 0.0)
            touched.add(place);
        else
            add_places(x, radius, touched);
        return touched;
    }

    DOSEKI_DEVICE_FN bool is_touched_by(const Vec<double, D>& x, double radius) const {
        const Foot nearest = nearest_foot(x, radius);
        return nearest.facet != none && place_of(nearest, x).distance < radius;
    }

    /// Signed distance and normal wherever x is.
    SurfacePoint<D> from(const Vec<double, D>& x) const {
        return place_of(nearest_foot(x, std::numeric_limits<double>::infinity()), x);
    }

    /// The same as particles of a wall have it: along an edge the normal is the mean of those of
    /// the faces, where a face that is farther by `width` counts no more; zero where they cancel.
    SurfacePoint<D> from_wall(const Vec<double, D>& x, double width) const {
        const Foot nearest = nearest_foot(x, std::numeric_limits<double>::infinity());
        SurfacePoint<D> place = place_of(nearest, x);
        const double distance = std::sqrt(nearest.square);
        double square = (distance + width) * (distance + width), weights = 0.0;
        Vec<double, D> sum{};
        tree_.visit_near(x, square, [&](std::uint32_t k) {
            const Foot foot = foot_on(k, x);
            if (foot.at.feature != Feature::face || !(foot.square < square)) return;
            const double weight = 1.0 - (std::sqrt(foot.square) - distance) / width;
            sum = sum + weight * place_of(foot, x).normal, weights += weight;
        });
        const double length = norm(sum);
        if (nearest.at.feature == Feature::face)
            place.normal = length > cancel * weights ? (1.0 / length) * sum : Vec<double, D>{};
        return place;
    }

private:
    static constexpr std::uint32_t none = 0xffffffff;
    /// Sine of the angle between faces below which a hollow is none: files hold single precision.
    static constexpr double flat = 0.01;
    /// A mean of normals that is shorter has no direction.
    static constexpr double cancel = 1e-6;

    /// The point of one facet that is nearest.
    struct Foot {
        double square;  // of its distance
        std::uint32_t facet;
        FacetPoint<D> at;

        DOSEKI_DEVICE_FN bool comes_before(const Foot& other) const {
            return square < other.square || (square == other.square && facet < other.facet);
        }
    };

    /// Of a sheet only if it is within reach; what a mesh encloses may lie as deep as it will.
    DOSEKI_DEVICE_FN Foot nearest_foot(const Vec<double, D>& x, double radius) const {
        Foot nearest{std::numeric_limits<double>::infinity(), none, {}};
        if (half_ > 0.0) nearest.square = (radius + half_) * (radius + half_);
        if (!tree_.is_near(x, radius + half_)) return nearest;
        tree_.visit_near(x, nearest.square, [&](std::uint32_t k) {
            const Foot foot = foot_on(k, x);
            if (foot.comes_before(nearest)) nearest = foot;
        });
        return nearest;
    }

    DOSEKI_DEVICE_FN Foot foot_on(std::uint32_t facet, const Vec<double, D>& x) const {
        const FacetPoint<D> at = mesh_.nearest(facet, x);
        const Vec<double, D> r = x - at.position;
        return {dot(r, r), facet, at};
    }

    DOSEKI_DEVICE_FN SurfacePoint<D> place_of(const Foot& foot, const Vec<double, D>& x) const {
        const Vec<double, D> out = mesh_.normal(foot.facet, foot.at.feature);
        const Vec<double, D> r = x - foot.at.position;
        const double distance = std::sqrt(foot.square), side = dot(r, out) >= 0.0 ? 1.0 : -1.0;
        // Within a facet the normal is its own: what is left of r may be rounding.
        const bool is_within = foot.at.feature == Feature::face || !(distance > 0.0);
        if (half_ > 0.0) return {distance - half_, is_within ? side * out : (1.0 / distance) * r};
        return {side * distance, is_within ? out : (side / distance) * r};
    }

    /// The feet nearer than the radius, but for those that lie on or below the plane in which the
    /// ball touches a nearer one: these belong to the same convex part.
    DOSEKI_DEVICE_FN void add_places(const Vec<double, D>& x, double radius,
                                     SurfacePoints<D>& touched) const {
        const double square = (radius + half_) * (radius + half_);
        std::array<Vec<double, D>, SurfacePoints<D>::most> taken;
        auto counts = [&](const Foot& foot) {
            for (std::size_t k = 0; k < touched.size(); ++k) {
                const Vec<double, D> apart = foot.at.position - taken[k];
                if (dot(apart, touched[k].normal) <= flat * norm(apart)) return false;
            }
            return !(place_of(foot, x).distance < 0.0);
        };
        for (Foot last{-1.0, 0, {}}; touched.size() < touched.most;) {
            last = next_foot(x, square, last, counts);
            if (last.facet == none) return;
            taken[touched.size()] = last.at.position;
            touched.add(place_of(last, x));
        }
    }

    /// Of the feet after `last` that count the first, the nearest first; looked for anew for each
    /// of the few places, since a device has no room for a list of all feet.
    template <class Counts>
    DOSEKI_DEVICE_FN Foot next_foot(const Vec<double, D>& x, double square, const Foot& last,
                                    const Counts& counts) const {
        constexpr double rounding = 1.0 + 1e-9;  // boxes of feet that are as near are looked into
        Foot next{square, none, {}};
        double within = square;
        tree_.visit_near(x, within, [&](std::uint32_t k) {
            const Foot foot = foot_on(k, x);
            if (!(foot.square < square) || !last.comes_before(foot) || !foot.comes_before(next) ||
                !counts(foot))
                return;
            next = foot, within = std::min(square, rounding * foot.square);
        });
        return next;
    }

    MeshCorners<D> mesh_;
    BoxTree<D> tree_;
    double half_;  // of the thickness of a sheet
    double radius_ = 0.0;
};

}  // namespace doseki
