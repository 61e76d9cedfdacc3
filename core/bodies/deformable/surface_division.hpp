#pragma once
// What becomes of the surfaces of bodies that divide, which deformable.cpp compiles.

#include <set>
#include <utility>

#include "bodies/deformable/surfaces.hpp"

namespace doseki {

/// Vertices of the parts of 2-D bodies that divide, in order.
template <int D>
Array<PlacedVertex> DeformableSurfaces<D>::parts_of(const TotalLagrangian<D>& solids,
                                                    const Division& division,
                                                    std::span<const std::int32_t> before,
                                                    const Array<Vec<double, D>>& places) const {
    Array<PlacedVertex> known, parts;
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        const std::int32_t body = before[point_of(v)];
        if (body >= 0 && division.divides[static_cast<std::size_t>(body)])
            known.push_back({vertices_[v], places[v], static_cast<std::int32_t>(v)});
    }
    OutlineTracer tracer({cells_, carrier_at_rest_, before, division.body, solids.x}, known);
    std::set<std::int32_t> bodies;
    for (std::size_t p = 0; p < before.size(); ++p)
        if (division.body[p] >= 0 && division.divides[static_cast<std::size_t>(before[p])])
            bodies.insert(division.body[p]);
    for (const std::int32_t body : bodies) {
        const auto curves = tracer.trace(body);
        for (std::uint32_t curve = 0; curve < curves.size(); ++curve)
            for (PlacedVertex placed : curves[curve]) {
                const std::uint32_t p = placed.vertex.point;
                placed.vertex.curve = curve;
                placed.vertex.offset =
                    inverse(solids.motion_around(p), 0.0) * (placed.place - solids.x[p]);
                parts.push_back(placed);
            }
    }
    return parts;
}

template <int D>
Array<std::int32_t> DeformableSurfaces<D>::divide(const TotalLagrangian<D>& solids,
                                                  const Division& division,
                                                  std::span<const std::int32_t> before,
                                                  const Array<std::uint32_t>& crack,
                                                  const Array<Vec<double, D>>& places) {
    Array<std::pair<SurfaceVertex<D>, std::int32_t>> kept;  // and their number before
    auto divides = [&](std::uint32_t p) {
        if (is_rigid(p, solids)) return false;
        return before[p] < 0 || division.divides[static_cast<std::size_t>(before[p])];
    };
    for (std::size_t v = 0; v < vertices_.size(); ++v)
        if (!divides(vertices_[v].point) || (D == 3 && division.body[vertices_[v].point] >= 0))
            kept.push_back({vertices_[v], static_cast<std::int32_t>(v)});
    if constexpr (D == 2)
        for (const PlacedVertex& part : parts_of(solids, division, before, places))
            kept.push_back({part.vertex, part.number});
    else {
        std::set<std::uint32_t> ball;
        for (const auto& [vertex, number] : kept) ball.insert(vertex.point);
        for (const std::uint32_t p : crack)
            if (division.body[p] >= 0 && !ball.contains(p))
                kept.push_back({{p, {}, 0, 0.5 * solids.body_of(p).spacing, p, 0}, -1});
    }
    std::stable_sort(kept.begin(), kept.end(), [&](const auto& a, const auto& b) {
        return solids.body(a.first.point) < solids.body(b.first.point);
    });
    Array<std::int32_t> number(vertices_.size(), -1);
    vertices_.clear();
    for (const auto& [vertex, old] : kept) {
        if (old >= 0)
            number[static_cast<std::size_t>(old)] = static_cast<std::int32_t>(vertices_.size());
        vertices_.push_back(vertex);
    }
    return number;
}

}  // namespace doseki
