#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "base/array.hpp"

namespace doseki {

/// How bodies fall apart.
struct Division {
    /// Body of each point: one that was there, one of `parent` by their numbers after those, dust
    /// number -2 - body, or -1 of what was dust before.
    Array<std::int32_t> body;
    Array<std::int32_t> parent;        // of each new body
    Array<Array<std::uint32_t>> dust;  // the points of each grain of it
    Array<std::int32_t> dust_parent;
    Array<std::uint8_t> divides;  // each body that was there: whether it loses points

    bool any() const { return !parent.empty() || !dust.empty(); }
};

/// Fewer points than these are dust: they do not resolve a body that bends.
template <int D>
inline constexpr std::size_t fewest_points = D == 2 ? 4 : 8;

/// From the components of points to bodies. The largest part of a body stays that body, or of a
/// structure the largest that is clamped; the others are new ones, or dust where they have fewer
/// than `fewest` points. `body` is that of each point so far, below 0 where it is dust already.
template <class IsClamped>
Division divided(std::span<const std::uint32_t> component, std::span<const std::int32_t> body,
                 const IsClamped& is_clamped, std::size_t bodies, std::size_t fewest) {
    Division division;
    division.body.assign(body.begin(), body.end());
    division.divides.assign(bodies, 0);
    std::map<std::uint32_t, Array<std::uint32_t>> parts;
    for (std::uint32_t p = 0; p < component.size(); ++p)
        if (body[p] >= 0) parts[component[p]].push_back(p);
    const auto rank = [&](const Array<std::uint32_t>& points) {
        const bool holds = points.size() >= fewest && std::ranges::any_of(points, is_clamped);
        return std::pair{holds, points.size()};
    };
    Array<const Array<std::uint32_t>*> first(bodies, nullptr);
    for (const auto& [label, points] : parts) {
        auto& most = first[static_cast<std::size_t>(body[label])];
        if (!most || rank(points) > rank(*most)) most = &points;
    }
    for (const auto& [label, points] : parts) {
        const std::int32_t parent = body[label];
        const bool stays = &points == first[static_cast<std::size_t>(parent)];
        if (stays && points.size() >= fewest) continue;
        division.divides[static_cast<std::size_t>(parent)] = 1;
        std::int32_t number;
        if (points.size() < fewest) {
            number = -2 - static_cast<std::int32_t>(division.dust.size());
            division.dust.push_back(points), division.dust_parent.push_back(parent);
        } else {
            number = static_cast<std::int32_t>(bodies + division.parent.size());
            division.parent.push_back(parent);
        }
        for (const std::uint32_t p : points) division.body[p] = number;
    }
    return division;
}

}  // namespace doseki
