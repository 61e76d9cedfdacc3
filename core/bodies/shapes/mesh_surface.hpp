#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "base/array.hpp"
#include "bodies/contact_surface.hpp"
#include "bodies/shapes/box_tree.hpp"
#include "bodies/shapes/mesh_corners.hpp"

namespace doseki {

/// A mesh of facets, convex or not: the outside of what it encloses or, with a thickness, all that
/// is nearer to it than half of that, on both of its sides.
template <int D>
class MeshSurface final : public ContactSurface<D> {
public:
    /// Corners that facets share must be the same numbers.
    MeshSurface(const Array<Facet<D>>& facets, double thickness)
        : mesh_(facets), tree_(boxes(facets)), half_(0.5 * thickness) {
        for (const Facet<D>& facet : facets)
            for (const Vec<double, D>& corner : facet)
                radius_ = std::max(radius_, norm(corner) + half_);
    }

    double radius() const override { return radius_; }
    std::size_t most_touched() const override { return SurfacePoints<D>::most; }

    SurfacePoints<D> touched_by(const Vec<double, D>& x, double radius) const override {
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

    bool is_touched_by(const Vec<double, D>& x, double radius) const override {
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
    };

    static Array<Box<D>> boxes(const Array<Facet<D>>& facets) {
        Array<Box<D>> result;
        for (const Facet<D>& facet : facets) {
            result.push_back(Box<D>::nowhere());
            for (const Vec<double, D>& corner : facet) result.back().add(corner);
        }
        return result;
    }

    /// Of a sheet only if it is within reach; what a mesh encloses may lie as deep as it will.
    Foot nearest_foot(const Vec<double, D>& x, double radius) const {
        Foot nearest{std::numeric_limits<double>::infinity(), none, {}};
        if (half_ > 0.0) nearest.square = (radius + half_) * (radius + half_);
        if (!tree_.is_near(x, radius + half_)) return nearest;
        tree_.visit_near(x, nearest.square, [&](std::uint32_t k) {
            const Foot foot = foot_on(k, x);
            if (foot.square < nearest.square ||
                (foot.square == nearest.square && k < nearest.facet))
                nearest = foot;
        });
        return nearest;
    }

    Foot foot_on(std::uint32_t facet, const Vec<double, D>& x) const {
        const FacetPoint<D> at = mesh_.nearest(facet, x);
        const Vec<double, D> r = x - at.position;
        return {dot(r, r), facet, at};
    }

    SurfacePoint<D> place_of(const Foot& foot, const Vec<double, D>& x) const {
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
    void add_places(const Vec<double, D>& x, double radius, SurfacePoints<D>& touched) const {
        Array<Foot> feet;
        double square = (radius + half_) * (radius + half_);
        tree_.visit_near(x, square, [&](std::uint32_t k) {
            if (const Foot foot = foot_on(k, x); foot.square < square) feet.push_back(foot);
        });
        std::sort(feet.begin(), feet.end(), [](const Foot& a, const Foot& b) {
            return a.square < b.square || (a.square == b.square && a.facet < b.facet);
        });
        std::array<Vec<double, D>, SurfacePoints<D>::most> taken;
        for (const Foot& foot : feet) {
            if (touched.size() == touched.most) return;
            bool hidden = false;
            for (std::size_t k = 0; k < touched.size(); ++k) {
                const Vec<double, D> apart = foot.at.position - taken[k];
                hidden |= dot(apart, touched[k].normal) <= flat * norm(apart);
            }
            const SurfacePoint<D> place = place_of(foot, x);
            if (hidden || place.distance < 0.0) continue;
            taken[touched.size()] = foot.at.position;
            touched.add(place);
        }
    }

    MeshCorners<D> mesh_;
    BoxTree<D> tree_;
    double half_;  // of the thickness of a sheet
    double radius_ = 0.0;
};

}  // namespace doseki
