#pragma once
// How deformable bodies fall apart, which deformable.cpp compiles.

#include "bodies/deformable/deformable_bodies.hpp"
#include "bodies/deformable/surface_division.hpp"
#include "bodies/fragments/components.hpp"
#include "bodies/fragments/pressed_bodies.hpp"

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

/// The component of each point, one for all points of a body that waits.
inline Array<std::uint32_t> together(Array<std::uint32_t> component,
                                     const Array<std::int32_t>& body,
                                     const Array<std::uint8_t>& waits) {
    Array<std::int64_t> label(waits.size(), -1);
    for (std::uint32_t p = 0; p < component.size(); ++p) {
        if (body[p] < 0 || waits[static_cast<std::size_t>(body[p])] == 0) continue;
        std::int64_t& of_body = label[static_cast<std::size_t>(body[p])];
        if (of_body < 0) of_body = component[p];
        component[p] = static_cast<std::uint32_t>(of_body);
    }
    return component;
}

/// A bond holds while it bears tension: it is intact and one of its points has a stress. Points of
/// a part that the others of it do not span are none of its surface, and points of dust that would
/// be a ball in the way of others none of one grain: they hold to nothing. Bodies that do not fall
/// apart keep theirs, such as the sharp corners that they begin with. In 2-D only those count
/// to which a point holds, and well enough: outlines go with the points around a vertex, Eq. (121).
/// What is pressed too hard stays together.
template <int D>
Division DeformableBodies<D>::division() {
    const Array<std::int32_t> before = solids_.holders();
    Array<std::uint8_t> loose(size(), 0), waits(bodies(), 0);
    auto for_each_bond = [&](std::uint32_t p, auto&& f) {
        if (before[p] < 0 || loose[p]) return;
        if (!solids_.body_of(p).breaks())
            for (const std::uint32_t j : solids_.pairs_of(p)) f(j);
        solids_.bonds().for_each_bond(p, [&](std::uint32_t j, double intactness) {
            if (intactness > 0.0 && !loose[j] && (solids_.spans(p) || solids_.spans(j))) f(j);
        });
    };
    auto is_clamped = [this](std::uint32_t p) { return solids_.clamped(p); };
    auto is_spanned = [&](std::uint32_t p, const Division& found) {
        if constexpr (D == 3)
            return determines_strain(solids_.shape_around(
                p, [&](std::uint32_t j) { return found.body[j] == found.body[p]; }));
        Array<std::uint32_t> held;
        for_each_bond(p, [&](std::uint32_t j) { held.push_back(j); });
        return spans_space(solids_.shape_around(
            p, [&](std::uint32_t j) { return std::ranges::find(held, j) != held.end(); }));
    };
    waits_ = false;
    for (;;) {
        Division found = divided(together(components(size(), for_each_bond), before, waits), before,
                                 is_clamped, bodies(), fewest_points<D>);
        auto falls_apart = [&](std::uint32_t p) {
            return found.body[p] >= 0 && found.divides[static_cast<std::size_t>(before[p])];
        };
        bool more = false;
        for (std::uint32_t p = 0; p < size(); ++p)
            if (falls_apart(p) && !is_spanned(p, found)) loose[p] = 1, more = true;
        for (const Array<std::uint32_t>& points : found.dust)
            if (points.size() > 1 && !has_room(solids_, points)) {
                for (const std::uint32_t p : points) loose[p] = 1;
                more = true;
            }
        if (more) continue;
        const Array<std::uint8_t> pressed = pressed_bodies(solids_, before, found);
        for (std::size_t body = 0; body < pressed.size(); ++body)
            if (pressed[body] != 0) waits[body] = 1, waits_ = more = true;
        if (!more) return found;
    }
}

template <int D>
Fragments<D> DeformableBodies<D>::divide(double dt, const PairArea& pair_area) {
    Fragments<D> fragments{};
    const Division parts = division();
    if (!parts.any()) return fragments;
    const Array<std::int32_t> before = solids_.holders();
    const Array<std::uint32_t> crack = crack_points(solids_, before, parts.body);
    const Array<Vec<double, D>> places = surfaces_.places(solids_);
    fragments.lost = kinetic_energy() + solids_.energy_across(dt);
    for (const auto& points : parts.dust) {
        fragments.dust.push_back(dust_grain(solids_, points));
        auto& normals = fragments.dust_normals.emplace_back();
        for (const std::uint32_t p : points) normals.push_back(normal(p));
    }
    fragments.first_contact_point = surfaces_.first_contact_point();
    fragments.surface_body = surfaces_.bodies(solids_);
    solids_.divide(parts);
    fragments.lost -= kinetic_energy() + solids_.energy_across(dt);
    Array<std::int32_t> shown = surfaces_.shown();
    const Array<std::int32_t> number = surfaces_.divide(solids_, parts, before, crack, places);
    for (std::int32_t& vertex : shown) vertex = number[static_cast<std::size_t>(vertex)];
    fragments.vertex = shown;
    const Array<std::int32_t> faces = faces_.renumber(before, material_.size(), parts);
    const CrackFaces<D> cracks(solids_, crack, before, parts.body, faces);
    cracks.turn(faces_), cracks.uncover(faces_, pair_area);
    for (const std::int32_t parent : parts.parent) {
        const auto k = static_cast<std::size_t>(parent);
        material_.push_back(std::int32_t{material_[k]}), group_.push_back(std::int32_t{group_[k]});
        unwetted_.push_back(double{unwetted_[k]});
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
