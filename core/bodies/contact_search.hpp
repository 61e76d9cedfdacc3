#pragma once
// Which bodies may touch.

#include <algorithm>
#include <cstdint>

#include "base/array.hpp"
#include "bodies/contact_points.hpp"
#include "bodies/shapes/box_tree.hpp"
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
        const Vec<double, D> x = wrapped(domain, points.position[c]);
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

/// Adds pairs of balls of different bodies that are nearer than `margin`. Of two points of surfaces
/// each touches the surface of the other, however many of its points are near.
template <int D>
void find_ball_pairs(const ContactPoints<D>& points, const Domain<D>& domain, double margin,
                     Array<ContactPair>& pairs) {
    Neighbours<D> neighbours(domain);
    const SortedBalls<D> balls = sorted_balls(points, domain, neighbours);
    if (balls.point.size() < 2) return;
    neighbours.build(1, balls.position, balls.support, margin);
    Array<std::int32_t> met;  // surfaces
    for (std::uint32_t i = 0; i < neighbours.moving(); ++i) {
        met.clear();
        auto pair_with = [&](std::uint32_t entry) {
            const std::uint32_t j = entry & ListEntry::index_mask;
            const std::int32_t a = balls.point[i], b = balls.point[j], surface = points.surface[b];
            const bool surfaces = points.surface[a] >= 0 && surface >= 0,
                       moves = j < neighbours.moving();
            if (points.body[a] == points.body[b] || (moves && j <= i && !surfaces)) return;
            if (surfaces && moves && std::ranges::find(met, surface) != met.end()) return;
            const Vec<double, D> r = nearest_image(domain, balls.position[j] - balls.position[i]);
            const double reach = points.reach(static_cast<std::size_t>(a)) +
                                 points.reach(static_cast<std::size_t>(b)) + margin;
            if (!(dot(r, r) < reach * reach)) return;
            if (!surfaces) {
                pairs.push_back({std::min(a, b), std::max(a, b)});
                return;
            }
            met.push_back(surface);
            pairs.push_back({a, b});
            if (!moves) pairs.push_back({b, a});
        };
        neighbours.clusters()[i].for_each_moving(pair_with);
        neighbours.clusters()[i].for_each_fixed(pair_with);
    }
}

/// The contact points in space, to be found by where they are: those of a body that follow each
/// other are near each other, and are found a few at a time.
template <int D>
class PointsInSpace {
public:
    PointsInSpace(const ContactPoints<D>& points, const Domain<D>& domain) : domain_(domain) {
        constexpr std::uint32_t longest = 16;
        Array<Box<D>> places;
        for (std::uint32_t c = 0; c < points.size(); ++c) {
            const bool goes_on =
                c > 0 && points.body[c] == points.body[c - 1] && c - first_.back() < longest;
            if (!goes_on) first_.push_back(c), places.push_back(Box<D>::nowhere());
            places.back().add(wrapped(domain, points.position[c]));
            largest_ = std::max(largest_, points.radius[c]);
        }
        first_.push_back(static_cast<std::uint32_t>(points.size()));
        tree_ = BoxTree<D>(places);
    }

    /// In rising order all points of which a part may be nearer to x than `distance`, and others.
    Array<std::uint32_t> near(const Vec<double, D>& x, double distance) const {
        Array<std::uint32_t> runs, found;
        int images = 1;
        for (int axis = 0; axis < D; ++axis) images *= domain_.periodic[axis] ? 3 : 1;
        for (int image = 0; image < images; ++image) {
            Vec<double, D> centre = wrapped(domain_, x);
            for (int axis = 0, rest = image; axis < D; ++axis) {
                if (!domain_.periodic[axis]) continue;
                centre[axis] += (rest % 3 - 1) * domain_.length(axis);
                rest /= 3;
            }
            double square = (distance + largest_) * (distance + largest_) * (1.0 + 1e-9);
            tree_.visit_near(centre, square, [&](std::uint32_t run) { runs.push_back(run); });
        }
        std::sort(runs.begin(), runs.end());
        runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
        for (const std::uint32_t run : runs)
            for (std::uint32_t c = first_[run]; c < first_[run + 1]; ++c) found.push_back(c);
        return found;
    }

private:
    const Domain<D>& domain_;
    Array<std::uint32_t> first_;  // of each run, and the end of the last
    BoxTree<D> tree_;             // of the runs
    double largest_ = 0.0;
};

/// Whether a sample between corners touches only what is not convex: of two polygons that overlap
/// one has a corner in the other.
template <int D>
bool is_not_needed(const ContactBodies<D>& bodies, std::size_t point,
                   const ContactSolid<D>& solid) {
    const std::int32_t own = bodies.points.solid[point];
    if (D == 3 || own < 0 || bodies.points.corner[point]) return false;
    return solid.surface->is_convex() &&
           bodies.solids[static_cast<std::size_t>(own)].surface->is_convex();
}

/// Adds pairs of a contact point and a solid that are nearer than `margin`.
template <int D>
void find_solid_pairs(const ContactBodies<D>& bodies, const Domain<D>& domain, double margin,
                      Array<ContactPair>& pairs) {
    if (bodies.solids.empty()) return;
    const ContactPoints<D>& points = bodies.points;
    const PointsInSpace<D> space(points, domain);
    for (std::size_t s = 0; s < bodies.solids.size(); ++s) {
        const ContactSolid<D>& solid = bodies.solids[s];
        if (solid.removed) continue;
        for (const std::uint32_t c : space.near(solid.centre, solid.surface->radius() + margin)) {
            if (points.removed[c] || points.hidden[c] || points.body[c] == solid.body ||
                (points.fixed[c] && solid.fixed) || is_not_needed(bodies, c, solid))
                continue;
            const Vec<double, D> r = solid.place_of(points.position[c], domain);
            const double reach = points.radius[c] + margin,
                         around = solid.surface->radius() + reach;
            if (dot(r, r) > around * around) continue;
            if (solid.surface->is_touched_by(rotated_back(solid.rotation, r), reach))
                pairs.push_back({static_cast<std::int32_t>(c), -1 - static_cast<std::int32_t>(s)});
        }
    }
}

/// Of a pair of points of surfaces the first touches the surface of the second, once.
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
    }
    std::sort(turned.begin(), turned.end());
    turned.erase(std::unique(turned.begin(), turned.end()), turned.end());
    pairs = std::move(others);
    pairs.insert(pairs.end(), turned.begin(), turned.end());
}

}  // namespace doseki
