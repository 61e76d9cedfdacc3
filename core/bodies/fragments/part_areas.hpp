#pragma once
#include <cstdint>

#include "base/array.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "bodies/shapes/box_tree.hpp"
#include "physics/wall.hpp"

namespace doseki {

/// Eq. (87): what the points of a body, where they are at rest, leave of one another's kernels
/// [m^2], 2-D: [m].
template <int D>
Array<Vec<double, D>> areas_of(const TotalLagrangian<D>& solids, const Array<std::uint32_t>& points,
                               const PairArea& pair_area) {
    auto place = [&](std::size_t n) { return solids.rest_position(points[n]); };
    auto volume = [&](std::size_t n) {
        return solids.mass(points[n]) / solids.body_of(points[n]).rho0;
    };
    Array<Box<D>> places;
    for (std::size_t n = 0; n < points.size(); ++n) places.push_back({place(n), place(n)});
    const BoxTree<D> tree(places);
    Array<Vec<double, D>> area(points.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
        double square = pair_area.support * pair_area.support;
        tree.visit_near(place(n), square, [&](std::uint32_t j) {
            const Vec<double, D> r = place(j) - place(n);
            area[n] = area[n] + (volume(n) * volume(j) * pair_area.at(dot(r, r))) * r;
        });
    }
    return area;
}

}  // namespace doseki
