#pragma once
// Which bodies may touch.

#include <algorithm>
#include <cstdint>

#include "base/array.hpp"
#include "bodies/contact_points.hpp"
#include "model/domain.hpp"
#include "pairs/neighbour_lists.hpp"

namespace doseki {

/// The balls among the contact points, sorted in space.
template <int D>
struct SortedBalls {
    Array<std::int32_t> point;
    Array<Vec<double, D>> position;  // inside the periodic domain
    Array<double> support;
};

template <int D>
SortedBalls<D> sorted_balls(const ContactPoints<D>& points, const Domain<D>& domain,
                            Neighbours<D>& neighbours) {
    SortedBalls<D> balls;
    Array<std::uint8_t> fixed;
    for (std::size_t c = 0; c < points.size(); ++c) {
        if (points.reach(c) <= 0.0 || points.removed[c]) continue;
        Vec<double, D> x = points.position[c];
        for (int axis = 0; axis < D; ++axis)
            if (domain.periodic[axis])
                x[axis] -= domain.length(axis) *
                           std::floor((x[axis] - domain.low[axis]) / domain.length(axis));
        balls.point.push_back(static_cast<std::int32_t>(c));
        balls.position.push_back(x), balls.support.push_back(2.0 * points.reach(c));
        fixed.push_back(points.fixed[c]);
    }
    if (balls.point.size() < 2) return balls;
    const auto order = neighbours.sort(balls.position, balls.support, fixed);
    auto sort = [&order](auto& values) {
        auto sorted = values;
        for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = values[order[k]];
        values.swap(sorted);
    };
    sort(balls.point), sort(balls.position), sort(balls.support);
    return balls;
}

/// Adds pairs of balls of different bodies that are nearer than `margin`.
template <int D>
void find_ball_pairs(const ContactPoints<D>& points, const Domain<D>& domain, double margin,
                     Array<ContactPair>& pairs) {
    Neighbours<D> neighbours(domain);
    const SortedBalls<D> balls = sorted_balls(points, domain, neighbours);
    if (balls.point.size() < 2) return;
    neighbours.build(1, balls.position, balls.support, margin);
    for (std::uint32_t i = 0; i < neighbours.moving(); ++i) {
        auto pair_with = [&](std::uint32_t entry) {
            const std::uint32_t j = entry & ListEntry::index_mask;
            const std::int32_t a = balls.point[i], b = balls.point[j];
            if (points.body[a] == points.body[b] || (j < neighbours.moving() && j <= i)) return;
            const Vec<double, D> r = nearest_image(domain, balls.position[j] - balls.position[i]);
            const double reach = points.reach(static_cast<std::size_t>(a)) +
                                 points.reach(static_cast<std::size_t>(b)) + margin;
            if (dot(r, r) < reach * reach) pairs.push_back({std::min(a, b), std::max(a, b)});
        };
        neighbours.clusters()[i].for_each_moving(pair_with);
        neighbours.clusters()[i].for_each_fixed(pair_with);
    }
}

/// Adds pairs of a contact point and a solid that are nearer than `margin`.
template <int D>
void find_solid_pairs(const ContactBodies<D>& bodies, const Domain<D>& domain, double margin,
                      Array<ContactPair>& pairs) {
    const ContactPoints<D>& points = bodies.points;
    for (std::size_t s = 0; s < bodies.solids.size(); ++s) {
        const ContactSolid<D>& solid = bodies.solids[s];
        if (solid.removed) continue;
        for (std::size_t c = 0; c < points.size(); ++c) {
            if (points.removed[c] || points.body[c] == solid.body ||
                (points.fixed[c] && solid.fixed))
                continue;
            const Vec<double, D> r = nearest_image(domain, points.position[c] - solid.centre);
            const double reach = points.radius[c] + margin,
                         around = solid.surface->radius() + reach;
            if (dot(r, r) > around * around) continue;
            if (solid.surface->is_touched_by(rotated_back(solid.rotation, r), reach))
                pairs.push_back({static_cast<std::int32_t>(c), -1 - static_cast<std::int32_t>(s)});
        }
    }
}

/// Points of two deformable bodies with surfaces touch the surface of the other, each once.
template <int D>
void turn_to_surfaces(const ContactBodies<D>& bodies, Array<ContactPair>& pairs) {
    const Array<std::int32_t>& surface = bodies.points.surface;
    Array<ContactPair> others, turned;
    for (const ContactPair& pair : pairs) {
        if (pair.with_shape() || surface[pair.first()] < 0 || surface[pair.second()] < 0) {
            others.push_back(pair);
            continue;
        }
        turned.push_back(bodies.pair_with_surface(pair.a, surface[pair.second()]));
        turned.push_back(bodies.pair_with_surface(pair.b, surface[pair.first()]));
    }
    std::sort(turned.begin(), turned.end());
    turned.erase(std::unique(turned.begin(), turned.end()), turned.end());
    pairs = std::move(others);
    pairs.insert(pairs.end(), turned.begin(), turned.end());
}

}  // namespace doseki
