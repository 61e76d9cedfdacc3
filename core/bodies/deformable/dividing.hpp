#pragma once
// How deformable bodies fall apart, which deformable.cpp compiles.

#include <map>

#include "bodies/deformable/deformable_bodies.hpp"
#include "bodies/fragments/components.hpp"

namespace doseki {

/// Whether there is room for a ball around the middle of some points between those beside them.
template <int D>
bool has_room(const TotalLagrangian<D>& solids, const Array<std::uint32_t>& points) {
    constexpr double near = 0.75;  // spacings: the diagonal of others' points passes the middle
    Vec<double, D> middle{};
    for (const std::uint32_t p : points) middle = middle + solids.rest_position(p);
    middle = (1.0 / static_cast<double>(points.size())) * middle;
    for (const std::uint32_t p : points)
        for (const std::uint32_t j : solids.pairs_of(p))
            if (std::ranges::find(points, j) == points.end() &&
                norm(solids.rest_position(j) - middle) < near * solids.body_of(p).spacing)
                return false;
    return true;
}

/// Holds the points of parts, but loose ones, that would have energy made by coming off, which is
/// that of the bonds still left: they wait. Tells whether there were any.
template <int D>
bool DeformableBodies<D>::hold_back(const Division& found, double ahead,
                                    std::span<const std::uint8_t> loose,
                                    Array<std::uint8_t>& held) const {
    std::map<std::int32_t, Array<std::uint32_t>> parts;
    for (std::uint32_t p = 0; p < size(); ++p) {
        const std::int32_t part = found.body[p];
        if (part < -1 || part >= static_cast<std::int32_t>(bodies())) parts[part].push_back(p);
    }
    bool any = false;
    for (const auto& [part, points] : parts) {
        if (loose[points[0]] || held[points[0]] ||
            solids_.lost_by_parting(points, found.body, part < -1, ahead) >= 0.0)
            continue;
        for (const std::uint32_t p : points) held[p] = 1;
        any = true;
    }
    return any;
}

/// A bond holds while it bears tension: it is intact and one of its points has a stress. Points of
/// a part that the others of it do not span are none of its surface, and points of dust that would
/// be a ball in the way of others none of one grain: they hold to nothing. Points that are held
/// back hold to all that they have not lost for good.
template <int D>
Division DeformableBodies<D>::division(double ahead) {
    const Array<std::int32_t> before = solids_.holders();
    Array<std::uint8_t> loose(size(), 0), held(size(), 0);
    waits_ = false;
    auto for_each_bond = [&](std::uint32_t p, auto&& f) {
        if (before[p] < 0 || loose[p]) return;
        if (!solids_.body_of(p).breaks())
            for (const std::uint32_t j : solids_.pairs_of(p)) f(j);
        solids_.bonds().for_each_bond(p, [&](std::uint32_t j, double intactness, bool ended) {
            const bool bears = intactness > 0.0 && (solids_.spans(p) || solids_.spans(j));
            if (!loose[j] && (bears || (!ended && (held[p] || held[j])))) f(j);
        });
    };
    for (;;) {
        Division found =
            divided(components(size(), for_each_bond), before, bodies(), fewest_points<D>);
        bool more = false;
        for (std::uint32_t p = 0; found.any() && p < size(); ++p)
            if (found.body[p] >= 0 && !solids_.is_spanned(p, [&](std::uint32_t j) {
                    return found.body[j] == found.body[p];
                }))
                loose[p] = 1, more = true;
        for (const Array<std::uint32_t>& points : found.dust)
            if (points.size() > 1 && !has_room(solids_, points)) {
                for (const std::uint32_t p : points) loose[p] = 1;
                more = true;
            }
        if (!more && hold_back(found, ahead, loose, held)) more = waits_ = true;
        if (!more) return found;
    }
}

template <int D>
Fragments<D> DeformableBodies<D>::divide(double ahead) {
    Fragments<D> fragments{};
    const Division parts = division(ahead);
    if (!parts.any()) return fragments;
    const Array<std::int32_t> before = solids_.holders();
    const Array<std::uint32_t> crack = crack_points(solids_, before, parts.body);
    const Array<Vec<double, D>> places = surfaces_.places(solids_);
    const ElasticEnergy whole = solids_.elastic_energy(ahead);
    fragments.lost = kinetic_energy() + whole.sum();
    for (const auto& points : parts.dust) {
        fragments.dust.push_back(dust_grain(solids_, points));
        auto& normals = fragments.dust_normals.emplace_back();
        for (const std::uint32_t p : points) normals.push_back(normal(p));
    }
    fragments.first_contact_point = surfaces_.first_contact_point();
    fragments.surface_body = surfaces_.bodies(solids_);
    solids_.divide(parts, whole.opening);
    fragments.lost -= kinetic_energy() + solids_.elastic_energy(ahead).sum();
    fragments.vertex = surfaces_.divide(solids_, parts, before, crack, places);
    turn_to_cracks(solids_, crack, before, parts.body, normal_, depth_);
    for (const std::int32_t parent : parts.parent) {
        const auto k = static_cast<std::size_t>(parent);
        material_.push_back(std::int32_t{material_[k]}), group_.push_back(std::int32_t{group_[k]});
    }
    fragments.parent = parts.parent, fragments.dust_parent = parts.dust_parent;
    fragments.divided = parts.divides;
    return fragments;
}

template <int D>
void DeformableBodies<D>::cut(std::span<const std::int32_t> label) {
    Array<std::int32_t> of(size());
    for (std::size_t k = 0; k < size(); ++k) of[solids_.slot(k)] = label[k];
    solids_.part_bonds([&of](std::uint32_t p, std::uint32_t j) { return of[p] != of[j]; });
}

}  // namespace doseki
