#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "base/array.hpp"
#include "bodies/contact_law.hpp"
#include "model/domain.hpp"

namespace doseki {

/// A place on a surface as the mean of vertices with weights, which add up to 1.
struct SurfaceWeights {
    std::array<std::uint32_t, 4> vertex;
    std::array<double, 4> weight;

    /// That with the greatest weight.
    DOSEKI_DEVICE_FN std::uint32_t nearest() const {
        const auto greatest = std::max_element(weight.begin(), weight.end());
        return vertex[static_cast<std::size_t>(greatest - weight.begin())];
    }
};

/// The surface of a deformable body: vertices that its points carry along. In 2-D they control
/// closed curves, anticlockwise, and clockwise around holes: uniform cubic B-splines that are twice
/// continuously differentiable but for the creases, vertices in which smooth parts of them end. For
/// 3-D see surface/in_space.hpp.
template <int D>
struct Surface {
    using Place = SurfaceWeights;

    std::int32_t body = 0, material = 0;
    double mass = 0.0, spacing = 0.0;  // of its points
    Array<std::uint32_t> first;        // vertex of each curve
    Array<std::uint32_t> curve;        // of each vertex
    Array<std::uint8_t> crease;
    Array<Vec<double, D>> position, velocity;
    Array<Vec3> spin;
    // What the contacts do to them; torque about where they act.
    Array<Vec<double, D>> force;
    Array<Vec3> torque;

    DOSEKI_DEVICE_FN std::size_t size() const { return crease.size(); }
    /// Vertices added from now on are of another curve.
    void begin_curve() { first.push_back(static_cast<std::uint32_t>(size())); }
    void add(bool is_crease) {
        curve.push_back(static_cast<std::uint32_t>(first.size() - 1));
        crease.push_back(is_crease);
        position.push_back({}), velocity.push_back({}), spin.push_back({});
        force.push_back({}), torque.push_back({});
    }

    /// As that which a contact point of another body touches; each presses with half of the spring.
    ContactSide side() const { return {material, 0.0, mass, spacing, false, true, true, 0.5}; }

    /// Along its curve.
    DOSEKI_DEVICE_FN std::uint32_t after(std::uint32_t vertex, int steps) const {
        const std::size_t next = curve[vertex] + std::size_t{1};
        const std::int64_t begin = first[curve[vertex]],
                           end = next < first.size() ? first[next]
                                                     : static_cast<std::int64_t>(size()),
                           n = end - begin, along = vertex - begin + steps;
        return static_cast<std::uint32_t>(begin + (along % n + n) % n);
    }
    /// Weights at t in [0, 1] of the part of the curve from a vertex to the next, and their
    /// `derivative` by t, once or twice. Beyond a crease the curve goes straight on.
    DOSEKI_DEVICE_FN SurfaceWeights at(std::uint32_t first, double t, int derivative = 0) const {
        const double s = 1.0 - t;
        std::array<double, 4> w;
        if (derivative == 0)
            w = {s * s * s / 6.0, (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0,
                 (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0, t * t * t / 6.0};
        else if (derivative == 1)
            w = {-0.5 * s * s, -2.0 * t + 1.5 * t * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t};
        else
            w = {s, 3.0 * t - 2.0, 3.0 * s - 2.0, t};
        if (crease[first]) w[1] += 2.0 * w[0], w[2] -= w[0], w[0] = 0.0;
        const std::uint32_t second = after(first, 1);
        if (crease[second]) w[2] += 2.0 * w[3], w[1] -= w[3], w[3] = 0.0;
        return {{after(first, -1), first, second, after(second, 1)}, w};
    }

    template <class Field>
    DOSEKI_DEVICE_FN auto mean(const Field& field, const SurfaceWeights& at) const {
        auto sum = at.weight[0] * field[at.vertex[0]];
        for (std::size_t k = 1; k < 4; ++k) sum = sum + at.weight[k] * field[at.vertex[k]];
        return sum;
    }
    void push(const SurfaceWeights& at, const Vec<double, D>& by, const Vec3& moment) {
        for (std::size_t k = 0; k < 4; ++k)
            force[at.vertex[k]] = force[at.vertex[k]] + at.weight[k] * by;
        torque[at.nearest()] = torque[at.nearest()] + moment;
    }

    DOSEKI_DEVICE_FN Vec3 spin_at(const SurfaceWeights& at) const { return spin[at.nearest()]; }
    std::uint32_t nearest_vertex(const Vec<double, D>& x, const Vec<double, D>& /*outward*/,
                                 const Domain<D>& domain) const {
        std::uint32_t nearest = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::uint32_t v = 0; v < size(); ++v) {
            const Vec<double, D> r = nearest_image(domain, position[v] - x);
            if (dot(r, r) < least) least = dot(r, r), nearest = v;
        }
        return nearest;
    }

    /// Where the curve comes nearest to a point.
    struct Foot {
        SurfaceWeights at;
        Vec<double, D> apart;   // from the point to the curve
        Vec<double, D> normal;  // outwards
        double depth;           // of the point below the curve
    };
    /// Near a vertex; none where it is a crease, beyond both parts that meet there.
    DOSEKI_DEVICE_FN std::optional<Foot> foot(const Vec<double, D>& x, std::uint32_t vertex,
                                              const Domain<D>& domain) const;

private:
    static constexpr int newton_steps = 4;
    static constexpr int window = 2;  // parts of the curve on either side that are looked at
};

template <int D>
DOSEKI_DEVICE_FN auto Surface<D>::foot(const Vec<double, D>& x, std::uint32_t vertex,
                                       const Domain<D>& domain) const -> std::optional<Foot> {
    static_assert(D == 2, "in 3-D a surface is no curve");
    auto sum = [this](const SurfaceWeights& w) { return mean(position, w); };
    const Vec<double, D> near = position[vertex],
                         here = near - nearest_image(domain, near - x);  // the image of x
    std::optional<Foot> best;
    double least = std::numeric_limits<double>::infinity();
    for (int step = -window; step < window; ++step) {
        const std::uint32_t first = after(vertex, step);
        double t = 0.5;
        for (int n = 0; n < newton_steps; ++n) {
            const Vec<double, D> c = sum(at(first, t)) - here, u = sum(at(first, t, 1)),
                                 bend = sum(at(first, t, 2));
            const double slope = dot(u, u) + dot(c, bend);
            if (!(slope > 0.0)) break;
            t = std::clamp(t - dot(c, u) / slope, 0.0, 1.0);
        }
        const SurfaceWeights w = at(first, t);
        const Vec<double, D> c = sum(w) - here, u = sum(at(first, t, 1));
        if (!(dot(c, c) < least)) continue;
        least = dot(c, c), best.reset();
        if ((t == 0.0 && crease[first]) || (t == 1.0 && crease[after(first, 1)])) continue;
        Vec<double, D> n;
        n[0] = u[1], n[1] = -u[0];
        n = (1.0 / std::sqrt(dot(n, n))) * n;
        best = Foot{w, c, n, dot(c, n)};
    }
    return best;
}

}  // namespace doseki
