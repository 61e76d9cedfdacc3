#pragma once
// Neighbours, part two: the union lists of clusters.

#include <algorithm>

#include "base/array.hpp"
#include "base/parallel.hpp"
#include "pairs/neighbour_lists.hpp"
#include "physics/wall.hpp"

namespace doseki {

/// The cells within `radius` of the bounds, direction by direction.
template <int D>
void Neighbours<D>::fill_steps(const Grid& grid, const Bounds& bounds, double radius,
                               Scratch& scratch) const {
    std::uint32_t weight = 1;
    for (int a = 0; a < D; ++a, weight *= 3) {
        const std::int64_t low = grid.cell_of(bounds.low[a] - radius, a);
        std::int64_t high = grid.cell_of(bounds.high[a] + radius, a);
        // Around a wrapped table once is everything; twice would list particles twice.
        if (!grid.periodic[a]) high = std::min(high, low + grid.cells[a] - 1);
        scratch.steps[a].clear();
        for (std::int64_t cell = low; cell <= high; ++cell) {
            const std::int64_t wrapped = grid.wrap(cell, a);
            // Cell n of a periodic direction is cell 0 seen one box further.
            const std::int64_t turns = grid.periodic[a] ? (cell - wrapped) / grid.cells[a] : 0;
            scratch.steps[a].push_back(
                {grid.key_along(wrapped, a), weight * static_cast<std::uint32_t>(turns + 1)});
        }
    }
}

template <int D>
template <int width>
void Neighbours<D>::search(const Grid& grid, const Part& part, std::uint32_t first, double skin,
                           std::span<const Vec<double, D>> position,
                           std::span<const double> support, Scratch& scratch) const {
    using Lanes = stdx::fixed_size_simd<double, width>;
    const auto last = static_cast<std::uint32_t>(this->size() - 1);
    Vec<Lanes, D> x;
    for (int a = 0; a < D; ++a)
        x[a] = Lanes([&](auto l) { return position[std::min<std::uint32_t>(first + l, last)][a]; });
    const auto reach =
        Lanes([&](auto l) { return support[std::min<std::uint32_t>(first + l, last)]; });

    const std::span<const Vec<double, D>> shifts(this->image_shifts());
    const auto face = Lanes([&](auto l) {
        return scratch.faces.empty() ? Face::none
                                     : scratch.faces[std::min<std::uint32_t>(first + l, last)];
    });
    auto visit = [&](std::uint32_t key, std::uint32_t image) __attribute__((always_inline)) {
        const Vec<double, D>& shift = shifts[image];
        const std::uint32_t code = image << ListEntry::index_bits;
        const CellRange cell = grid.particles(key);
        for (std::uint32_t j = cell.first; j < cell.last; ++j) {
            typename Lanes::mask_type near(true);
            if (!scratch.faces.empty()) {
                near = Face::meet(face, Lanes(scratch.faces[j]));
                if (stdx::none_of(near)) continue;
            }
            Lanes square = 0.0;
            for (int a = 0; a < D; ++a) {
                const Lanes d = x[a] - (position[j][a] + shift[a]);
                square += d * d;
            }
            Lanes limit = support[j];
            stdx::where(limit < reach, limit) = reach;
            limit += skin;
            near = near && square < limit * limit;
            if (stdx::none_of(near)) continue;
            // Another part finds what is near its particles, too.
            const int lane = stdx::find_first_set(near);
            if (part.first <= lane && lane < part.last) scratch.list.push_back(j | code);
        }
    };
    const double radius = std::max(part.bounds.support, grid.support) + skin;
    if (grid.is_beyond(part.bounds.low, part.bounds.high, radius)) return;
    fill_steps(grid, part.bounds, radius, scratch);
    const auto& steps = scratch.steps;
    for (const CellStep& y : steps[1])
        for (const CellStep& x_step : steps[0]) {
            const std::uint32_t key = x_step.key_part | y.key_part,
                                image = x_step.image_part + y.image_part;
            if constexpr (D == 2)
                visit(key, image);
            else
                for (const CellStep& z : steps[2]) visit(key | z.key_part, image + z.image_part);
        }
}

/// The width is a constant where pairs are searched.
template <int D>
void Neighbours<D>::search_cells(int width, const Grid& grid, const Part& part, std::uint32_t first,
                                 double skin, std::span<const Vec<double, D>> position,
                                 std::span<const double> support, Scratch& scratch) const {
    if (width == lanes<double>)
        search<lanes<double>>(grid, part, first, skin, position, support, scratch);
    else if (width == lanes<float>)
        search<lanes<float>>(grid, part, first, skin, position, support, scratch);
    else
        search<1>(grid, part, first, skin, position, support, scratch);
}

template <int D>
void Neighbours<D>::build(int width, std::span<const Vec<double, D>> position,
                          std::span<const double> support, double skin,
                          std::span<const std::int32_t> faces) {
    const auto in_cluster = static_cast<std::size_t>(width);
    const std::size_t n = this->size(), count = (n + in_cluster - 1) / in_cluster;
    clusters_.assign(count, {});
    storage_.resize(static_cast<std::size_t>(thread_count()));
    for (ListStorage& storage : storage_) storage.clear();
    Array<Scratch> scratches(storage_.size());

    for_each_task(count, 64, [&](std::size_t thread, std::size_t c) {
        Scratch& scratch = scratches[thread];
        const std::size_t first = c * in_cluster;
        find_parts(position, support, first, std::min(n, first + in_cluster), scratch.parts);
        auto search_grids = [&](bool fixed) {
            for (const Part& part : scratch.parts)
                for (const Grid& grid : this->grids())
                    if (grid.fixed == fixed)
                        search_cells(width, grid, part, static_cast<std::uint32_t>(first), skin,
                                     position, support, scratch);
        };
        scratch.list.clear();
        search_grids(false);
        const std::size_t moving = scratch.list.size();
        const std::size_t end = std::min(n, first + in_cluster);
        const bool any_face = std::any_of(faces.begin() + std::min(first, faces.size()),
                                          faces.begin() + std::min(end, faces.size()),
                                          [](std::int32_t face) { return face != 0; });
        if (first < this->moving())
            search_grids(true);
        else if (any_face) {
            scratch.faces = faces;
            search_grids(true);
            scratch.faces = {};
        }
        clusters_[c] = storage_[thread].keep(scratch.list, moving);
    });
}

/// Cuts a cluster into runs of particles that lie together. Spray is stored one after the other,
/// too, and a search around all of such a cluster would visit whatever lies between.
template <int D>
void Neighbours<D>::find_parts(std::span<const Vec<double, D>> position,
                               std::span<const double> support, std::size_t first, std::size_t last,
                               Array<Part>& parts) {
    constexpr double widest = 2.5;  // of the support radius
    parts.clear();
    for (std::size_t p = first; p < last; ++p) {
        const int lane = static_cast<int>(p - first);
        const Bounds alone{position[p], position[p], support[p]};
        Bounds joined = parts.empty() ? alone : parts.back().bounds;
        joined.support = std::max(joined.support, support[p]);
        bool together = !parts.empty();
        for (int a = 0; a < D; ++a) {
            joined.low[a] = std::min(joined.low[a], position[p][a]);
            joined.high[a] = std::max(joined.high[a], position[p][a]);
            together &= joined.high[a] - joined.low[a] < widest * joined.support;
        }
        if (together)
            parts.back() = {joined, parts.back().first, lane + 1};
        else
            parts.push_back({alone, lane, lane + 1});
    }
}

}  // namespace doseki
