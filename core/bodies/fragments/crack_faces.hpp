#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "bodies/shapes/box_tree.hpp"

namespace doseki {

/// Points that have lost neighbours to another part.
template <int D>
Array<std::uint32_t> crack_points(const TotalLagrangian<D>& solids,
                                  std::span<const std::int32_t> before,
                                  std::span<const std::int32_t> after) {
    Array<std::uint32_t> crack;
    for (std::uint32_t p = 0; p < solids.size(); ++p) {
        if (before[p] < 0) continue;
        const Array<std::uint32_t> pairs = solids.pairs_of(p);
        if (std::ranges::any_of(pairs, [&](std::uint32_t j) {
                return before[j] == before[p] && after[j] != after[p];
            }))
            crack.push_back(p);
    }
    return crack;
}

/// Normals at rest, outwards, and depths below the surface of all points, for which the faces of
/// new cracks are surfaces too: halfway to the nearest points beyond.
template <int D>
void turn_to_cracks(const TotalLagrangian<D>& solids, const Array<std::uint32_t>& crack,
                    std::span<const std::int32_t> before, std::span<const std::int32_t> after,
                    Array<Vec<double, D>>& normal, Array<double>& depth) {
    constexpr double reach = 4.0;     // spacings: deeper ones meet no fluid
    constexpr double as_near = 0.25;  // spacings: two faces count as equally near
    Array<Box<D>> places;
    for (const std::uint32_t q : crack)
        places.push_back({solids.rest_position(q), solids.rest_position(q)});
    const BoxTree<D> tree(places);
    for (std::size_t p = 0; p < solids.size(); ++p) {
        if (after[p] < 0) continue;
        const double spacing = solids.body_of(p).spacing;
        double square = reach * reach * spacing * spacing, nearest = reach * spacing;
        Vec<double, D> towards{};
        tree.visit_near(solids.rest_position(p), square, [&](std::uint32_t k) {
            const std::uint32_t q = crack[k];
            const Vec<double, D> r = solids.rest_position(q) - solids.rest_position(p);
            const double distance = norm(r);
            if (before[q] != before[p] || after[q] == after[p] || distance >= reach * spacing)
                return;
            nearest = std::min(nearest, distance);
            const double weight = std::pow(spacing / distance, 4);
            towards = towards + (weight / distance) * r;
        });
        const double below = nearest - 0.5 * spacing;
        if (!(dot(towards, towards) > 0.0) || below > depth[p] + as_near * spacing) continue;
        towards = (1.0 / norm(towards)) * towards;
        if (below > depth[p] - as_near * spacing) towards = towards + normal[p];
        if (dot(towards, towards) > 0.0) normal[p] = (1.0 / norm(towards)) * towards;
        depth[p] = std::min(depth[p], below);
    }
}

}  // namespace doseki
