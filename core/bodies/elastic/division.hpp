#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <span>

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

/// From the components of points to bodies. The largest part of a body stays that body; the others
/// are new ones, or dust where they have fewer than `fewest` points. `body` is that of each point
/// so far, below 0 where it is dust already.
inline Division divided(std::span<const std::uint32_t> component,
                        std::span<const std::int32_t> body, std::size_t bodies,
                        std::size_t fewest) {
    Division division;
    division.body.assign(body.begin(), body.end());
    division.divides.assign(bodies, 0);
    std::map<std::uint32_t, Array<std::uint32_t>> parts;
    for (std::uint32_t p = 0; p < component.size(); ++p)
        if (body[p] >= 0) parts[component[p]].push_back(p);
    Array<const Array<std::uint32_t>*> largest(bodies, nullptr);
    for (const auto& [label, points] : parts) {
        auto& most = largest[static_cast<std::size_t>(body[label])];
        if (!most || points.size() > most->size()) most = &points;
    }
    for (const auto& [label, points] : parts) {
        const std::int32_t parent = body[label];
        const bool stays = &points == largest[static_cast<std::size_t>(parent)];
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
