#pragma once
// What a ball touches at several places of one surface.

#include <algorithm>
#include <array>
#include <span>

#include "bodies/overlap.hpp"

namespace doseki {

/// Part of its force that each of the places gets. Places whose normals differ by less than some 30
/// degrees push as one: a hollow of many small faces is not stiffer than the smooth one. Nothing
/// jumps where a face comes in, whose overlap is zero then.
template <int D>
DOSEKI_DEVICE_FN std::array<double, SurfacePoints<D>::most> shares_of(const Overlaps<D>& overlaps) {
    constexpr double apart = 0.866;  // cosine of the angle beyond which places push on their own
    std::array<double, SurfacePoints<D>::most> share{};
    for (std::size_t i = 0; i < overlaps.size(); ++i) {
        double together = 0.0;
        for (std::size_t j = 0; j < overlaps.size(); ++j) {
            const double c = dot(overlaps[i].normal, overlaps[j].normal);
            const double alike = i == j ? 1.0 : std::max(0.0, (c - apart) / (1.0 - apart));
            together += alike * overlaps[j].depth;
        }
        share[i] = together > 0.0 ? overlaps[i].depth / together : 1.0;
    }
    return share;
}

/// For each overlap a row, each once, where what it did in the step before is kept: the one with
/// the nearest normal, or else one that has not touched. `normals` are those of the rows before,
/// zero of those that did not touch. Overlaps beyond their number are left out.
template <int D>
DOSEKI_DEVICE_FN std::array<std::size_t, SurfacePoints<D>::most> rows_of(
    const Overlaps<D>& overlaps, std::span<const Vec<double, D>> normals) {
    constexpr double turned = 0.5;  // cosine of what a normal turns in one step at most
    constexpr std::size_t most = SurfacePoints<D>::most, none = most;
    const std::size_t count = std::min(overlaps.size(), normals.size());
    std::array<std::size_t, most> row;
    row.fill(none);
    std::array<bool, most> taken{};
    auto take = [&](std::size_t k, std::size_t n) { row[k] = n, taken[n] = true; };
    for (std::size_t k = 0; k < count; ++k) {
        std::size_t nearest = none;
        double greatest = turned;
        for (std::size_t n = 0; n < normals.size(); ++n)
            if (const double c = dot(normals[n], overlaps[k].normal); !taken[n] && c > greatest)
                greatest = c, nearest = n;
        if (nearest != none) take(k, nearest);
    }
    for (const bool used_before : {false, true})
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t n = 0; n < normals.size() && row[k] == none; ++n)
                if (!taken[n] && (dot(normals[n], normals[n]) > 0.0) == used_before) take(k, n);
    return row;
}

}  // namespace doseki
