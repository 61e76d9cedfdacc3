#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "bodies/shapes/box_tree.hpp"
#include "bodies/surface/surface.hpp"
#include "physics/surface/fit.hpp"

namespace doseki {

/// Where a surface in space is touched: the vertices around one have these weights.
struct PlaceInSpace {
    std::uint32_t vertex = 0;
    Vec<double, 3> at{}, normal{};
    LinearWeights weights;
};

/// The surface of a deformable body in space: vertices that its points carry along, each with a
/// normal and the area for which it stands. Between them it is smooth, Eqs. (165) to (167), but
/// for edges, where normals jump. Vertices without an area are contact points alone.
template <>
struct Surface<3> {
    using Place = PlaceInSpace;

    std::int32_t body = 0, material = 0;
    double mass = 0.0, spacing = 0.0;  // of its points
    Array<double> share;               // area of each vertex, over the square of the spacing
    Array<Vec<double, 3>> position, velocity, normal;
    Array<Vec3> spin;
    // What the contacts do to them; torque about where they act.
    Array<Vec<double, 3>> force;
    Array<Vec3> torque;

    DOSEKI_DEVICE_FN std::size_t size() const { return share.size(); }
    void add(double share_there) {
        share.push_back(share_there), position.push_back({}), velocity.push_back({});
        normal.push_back({}), spin.push_back({}), force.push_back({}), torque.push_back({});
    }
    /// Finds the vertices around each, by their places and normals at rest.
    void connect(const Array<Vec<double, 3>>& rest, const Array<Vec<double, 3>>& outward);

    /// Vertices around one, itself among them, that a place near it may need.
    std::span<const std::uint32_t> around(std::size_t vertex) const {
        const std::uint32_t begin = first_near_[vertex];
        return std::span(near_).subspan(begin, first_near_[vertex + 1] - begin);
    }

    /// As that which a contact point of another body touches; each presses with half of the spring.
    ContactSide side() const { return {material, 0.0, mass, spacing, false, true, true, 0.5}; }

    template <class Field>
    DOSEKI_DEVICE_FN auto mean(const Field& field, const SurfaceWeights& at) const {
        return field[at.vertex[0]];
    }
    template <class Field>
    DOSEKI_DEVICE_FN auto mean(const Field& field, const Place& place) const {
        auto sum = 0.0 * field[place.vertex];
        for_each_weight(place, [&](std::uint32_t v, double w) { sum = sum + w * field[v]; });
        return sum;
    }
    void push(const SurfaceWeights& at, const Vec<double, 3>& by, const Vec3& moment) {
        force[at.vertex[0]] = force[at.vertex[0]] + by;
        torque[at.vertex[0]] = torque[at.vertex[0]] + moment;
    }
    void push(const Place& place, const Vec<double, 3>& by, const Vec3& moment) {
        for_each_weight(place, [&](std::uint32_t v, double w) {
            force[v] = force[v] + w * by, torque[v] = torque[v] + w * moment;
        });
    }
    DOSEKI_DEVICE_FN Vec3 spin_at(const Place& place) const { return mean(spin, place); }

    /// Of those that face what looks outwards at x; size() where none near does.
    std::uint32_t nearest_vertex(const Vec<double, 3>& x, const Vec<double, 3>& outward,
                                 const Domain<3>& domain) const;

    /// Where the surface comes nearest to a point.
    struct Foot {
        Place at;
        Vec<double, 3> apart;   // from the point to the mean of the vertices there
        Vec<double, 3> normal;  // outwards
        double depth;           // of the point below the surface
    };
    /// Near a vertex; none beyond the rim of the smooth part that it is on.
    DOSEKI_DEVICE_FN std::optional<Foot> foot(const Vec<double, 3>& x, std::uint32_t vertex,
                                              const Domain<3>& domain) const;

private:
    static constexpr double reach = 1.25;  // of weights, in spacings

    /// Calls f(vertex, weight, where it is in the plane).
    template <class F>
    DOSEKI_DEVICE_FN void for_each_around(const Vec<double, 3>& at, std::uint32_t vertex,
                                          const Vec<double, 3>& n, F&& f) const {
        const double scale = 1.0 / (reach * spacing);
        for (std::uint32_t k = first_near_[vertex]; k < first_near_[vertex + 1]; ++k) {
            const std::uint32_t v = near_[k];
            const Vec<double, 3> r = scale * (position[v] - at), t = r - dot(n, r) * n;
            if (const double theta = weight_on_surface(share[v], dot(t, t)); theta > 0.0)
                f(v, theta, t);
        }
    }
    template <class F>
    DOSEKI_DEVICE_FN void for_each_weight(const Place& place, F&& f) const {
        for_each_around(place.at, place.vertex, place.normal,
                        [&](std::uint32_t v, double theta, const Vec<double, 3>& t) {
                            f(v, place.weights.at(theta, t));
                        });
    }

    Array<std::uint32_t> near_, first_near_;
};

inline void Surface<3>::connect(const Array<Vec<double, 3>>& rest,
                                const Array<Vec<double, 3>>& outward) {
    constexpr double slack = 1.0;   // spacings that a place may be off a vertex
    constexpr double edge = 0.766;  // cosine of the angle between normals on either side
    Array<Box<3>> places;
    for (const auto& place : rest) places.push_back({place, place});
    const BoxTree<3> tree(places);
    near_.clear(), first_near_.assign(1, 0);
    for (std::uint32_t v = 0; v < size(); ++v) {
        double square = (reach + slack) * (reach + slack) * spacing * spacing;
        const double within = square;
        const std::size_t begin = near_.size();
        tree.visit_near(rest[v], square, [&](std::uint32_t w) {
            const Vec<double, 3> r = rest[w] - rest[v];
            if (share[w] > 0.0 && dot(r, r) < within && dot(outward[v], outward[w]) > edge)
                near_.push_back(w);
        });
        std::sort(near_.begin() + static_cast<std::ptrdiff_t>(begin), near_.end());
        first_near_.push_back(static_cast<std::uint32_t>(near_.size()));
    }
}

inline std::uint32_t Surface<3>::nearest_vertex(const Vec<double, 3>& x,
                                                const Vec<double, 3>& outward,
                                                const Domain<3>& domain) const {
    constexpr double farthest = 1.5;  // spacings: else the back of a body would face what is above
    constexpr double faces = -0.3;    // cosine of the angle between their normals
    auto nearest = static_cast<std::uint32_t>(size());
    double least = farthest * farthest * spacing * spacing;
    for (std::uint32_t v = 0; v < size(); ++v) {
        if (!(share[v] > 0.0) || dot(normal[v], outward) > faces) continue;
        const Vec<double, 3> r = nearest_image(domain, position[v] - x);
        if (dot(r, r) < least) least = dot(r, r), nearest = v;
    }
    return nearest;
}

DOSEKI_DEVICE_FN inline auto Surface<3>::foot(const Vec<double, 3>& x, std::uint32_t vertex,
                                              const Domain<3>& domain) const
    -> std::optional<Foot> {
    constexpr int planes = 2;        // whose normals come nearer to that of the surface
    constexpr double beyond = 0.25;  // of the reach, see SurfaceMoments::middle()
    if (vertex >= size()) return {};
    const Vec<double, 3> near = position[vertex], at = near - nearest_image(domain, near - x);
    Foot foot{};
    Vec<double, 3> n = normal[vertex];
    for (int k = 0; k < planes; ++k) {
        SurfaceMoments moments;
        for_each_around(at, vertex, n, [&](std::uint32_t, double theta, const Vec<double, 3>& t) {
            moments.add(theta, t);
        });
        if (!(moments.weight > 0.0) || norm(moments.middle()) > beyond) return {};
        foot.at = {vertex, at, n, moments.weights(n)};
        SurfaceMeans means;
        for_each_weight(
            foot.at, [&](std::uint32_t v, double w) { means.add(w, position[v] - at, normal[v]); });
        n = (1.0 / norm(means.normal)) * means.normal;
        foot.apart = means.place;
        foot.depth = means.depth_below(n);
    }
    foot.normal = n;
    return foot;
}

}  // namespace doseki
