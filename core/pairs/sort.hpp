#pragma once
// Neighbours, part one: classes, cells and the order in which particles are stored.

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/array.hpp"
#include "base/hilbert.hpp"
#include "pairs/neighbour_lists.hpp"

namespace doseki {

/// The counts of layers after the upper half has been put onto the lower one.
inline Array<double> folded(const Array<double>& layers) {
    const std::size_t half = layers.size() / 2;
    Array<double> sum(half);
    for (std::size_t k = 0; k < half; ++k) sum[k] = layers[k] + layers[k + half];
    return sum;
}

/// Proportional to the number of pairs within layers.
inline double crowding(const Array<double>& layers) {
    return std::inner_product(layers.begin(), layers.end(), layers.begin(), 0.0);
}

template <int D>
void Neighbours<D>::fill_image_shifts() {
    constexpr int images = D == 2 ? 9 : 27;
    image_shift_.resize(images);
    for (int code = 0; code < images; ++code) {
        int digits = code;
        for (int a = 0; a < D; ++a, digits /= 3)
            image_shift_[code][a] =
                (digits % 3 - 1) * (domain_.periodic[a] ? domain_.length(a) : 0.0);
    }
}

template <int D>
std::int64_t Neighbours<D>::cell_of(const Grid& grid, double x, int a) {
    return static_cast<std::int64_t>(std::floor((x - grid.origin[a]) / grid.cell_size[a]));
}

template <int D>
std::int64_t Neighbours<D>::wrap(const Grid& grid, std::int64_t cell, int a) const {
    const std::int64_t n = grid.cells[a];
    return domain_.periodic[a] ? ((cell % n) + n) % n : cell & (n - 1);
}

/// Bits of a Morton key are those of all directions in turn, as long as a direction has some left;
/// so the key is the OR of one part for each direction. Blocks have bits of all.
template <int D>
void Neighbours<D>::fill_key_parts(Grid& grid) {
    std::array<Array<int>, D> places;
    const std::int64_t fewest = *std::min_element(grid.cells.begin(), grid.cells.end());
    grid.curve = hilbert_curve<D>(std::bit_width(static_cast<std::uint64_t>(fewest - 1)));
    for (int bit = 0, place = 0; bit < 32; ++bit)
        for (int a = 0; a < D; ++a)
            if ((std::uint64_t{1} << bit) < static_cast<std::uint64_t>(grid.cells[a]))
                places[a].push_back(place++);
    for (int a = 0; a < D; ++a) {
        grid.key_part[a].assign(static_cast<std::size_t>(grid.cells[a]), 0);
        for (std::size_t cell = 0; cell < grid.key_part[a].size(); ++cell)
            for (std::size_t bit = 0; bit < places[a].size(); ++bit)
                grid.key_part[a][cell] |= static_cast<std::uint32_t>((cell >> bit) & 1)
                                          << places[a][bit];
    }
}

template <int D>
std::uint32_t Neighbours<D>::key_of(const Grid& grid, const Vec<double, D>& x) const {
    std::uint32_t key = 0;
    for (int a = 0; a < D; ++a)
        key |= grid.key_part[a][static_cast<std::size_t>(wrap(grid, cell_of(grid, x[a], a), a))];
    return grid.place(key);
}

template <int D>
void Neighbours<D>::size_grid(Grid& grid, std::span<const Vec<double, D>> position,
                              std::span<const std::uint32_t> members) const {
    grid.bounds = Box<D>::nowhere();
    for (const std::uint32_t p : members) grid.bounds.add(position[p]);
    std::array<std::int64_t, D> cells;
    for (int a = 0; a < D; ++a) {
        const double size = 0.5 * grid.support;
        if (domain_.periodic[a]) {
            cells[a] = std::max<std::int64_t>(
                1, static_cast<std::int64_t>(std::min(domain_.length(a) / size, 1048576.0)));
            grid.origin[a] = domain_.low[a];
            grid.cell_size[a] = domain_.length(a) / static_cast<double>(cells[a]);
        } else {
            const double count = std::min(grid.bounds.size()[a] / size + 1.0, 1048576.0);
            cells[a] = std::bit_ceil(static_cast<std::uint64_t>(count));
            grid.origin[a] = grid.bounds.low[a];
            grid.cell_size[a] = size;
        }
    }
    grid.cells = fold(grid, cells, position, members);
    fill_key_parts(grid);
    grid.cell_start.assign(static_cast<std::size_t>(table_size(grid.cells)) + 1, 0);
}

template <int D>
std::int64_t Neighbours<D>::table_size(const std::array<std::int64_t, D>& cells) {
    std::int64_t product = 1;
    for (const std::int64_t count : cells)
        product *= static_cast<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(count)));
    return product;
}

/// A table no larger than the particles warrant. Folding a direction only adds candidates, and
/// fewest where one half is nearly empty: a long flow that splashes is folded upwards, not onto
/// itself.
template <int D>
std::array<std::int64_t, D> Neighbours<D>::fold(const Grid& grid, std::array<std::int64_t, D> cells,
                                                std::span<const Vec<double, D>> position,
                                                std::span<const std::uint32_t> members) const {
    const std::int64_t limit =
        std::max<std::int64_t>(4096, 4 * static_cast<std::int64_t>(members.size()));
    if (table_size(cells) <= limit) return cells;
    std::array<Array<double>, D> layers;  // particles with the same cell along a direction
    for (int a = 0; a < D; ++a) {
        if (domain_.periodic[a]) continue;
        layers[a].assign(static_cast<std::size_t>(cells[a]), 0.0);
        for (const std::uint32_t p : members)
            layers[a][static_cast<std::size_t>(cell_of(grid, position[p][a], a) % cells[a])] += 1.0;
    }
    while (table_size(cells) > limit) {
        int best = -1;
        double min_growth = 0.0;
        for (int a = 0; a < D; ++a) {
            if (domain_.periodic[a] || cells[a] < 2) continue;
            const double growth = crowding(folded(layers[a])) / crowding(layers[a]);
            if (best < 0 || growth < min_growth) best = a, min_growth = growth;
        }
        if (best < 0) break;
        layers[best] = folded(layers[best]);
        cells[best] /= 2;
    }
    return cells;
}

template <int D>
Array<std::uint32_t> Neighbours<D>::sort(std::span<const Vec<double, D>> position,
                                         std::span<const double> support,
                                         std::span<const std::uint8_t> is_fixed,
                                         std::span<const std::uint8_t> is_near) {
    if (position.size() > ListEntry::max_index)
        throw ResourceFailure("more than 2^27 particles on one rank");
    Classes classes;
    for (std::uint32_t p = 0; p < position.size(); ++p)
        classes[{is_fixed[p] != 0, !is_near.empty() && is_near[p] != 0, std::ilogb(support[p])}]
            .push_back(p);
    grids_.clear();
    size_ = position.size(), moving_ = 0, inner_ = 0;
    for (const auto& [name, members] : classes) {
        if (!std::get<0>(name)) moving_ += members.size();
        if (!std::get<0>(name) && !std::get<1>(name)) inner_ += members.size();
    }
    return sort_classes(classes, position, support, 0);
}

template <int D>
Array<std::uint32_t> Neighbours<D>::sort_ghosts(std::span<const Vec<double, D>> position,
                                                std::span<const double> support,
                                                std::span<const std::uint8_t> is_fixed) {
    if (size_ + position.size() > ListEntry::max_index)
        throw ResourceFailure("more than 2^27 particles and ghosts on one rank");
    Classes classes;
    for (std::uint32_t p = 0; p < position.size(); ++p)
        classes[{is_fixed[p] != 0, true, std::ilogb(support[p])}].push_back(p);
    return sort_classes(classes, position, support, size_);
}

/// Adds a grid for each class; the first particle is to be stored at `first`.
template <int D>
Array<std::uint32_t> Neighbours<D>::sort_classes(const Classes& classes,
                                                 std::span<const Vec<double, D>> position,
                                                 std::span<const double> support,
                                                 std::size_t first) {
    Array<std::uint32_t> order;
    order.reserve(position.size());
    for (const auto& [name, members] : classes) {
        Grid grid;
        grid.fixed = std::get<0>(name);
        grid.first = static_cast<std::uint32_t>(first + order.size());
        grid.last = grid.first + static_cast<std::uint32_t>(members.size());
        for (std::uint32_t p : members) grid.support = std::max(grid.support, support[p]);
        size_grid(grid, position, members);

        Array<std::uint32_t> keys(members.size());
        for (std::size_t k = 0; k < members.size(); ++k) {
            keys[k] = key_of(grid, position[members[k]]);
            ++grid.cell_start[keys[k] + 1];
        }
        grid.cell_start[0] = grid.first;
        for (std::size_t c = 1; c < grid.cell_start.size(); ++c)
            grid.cell_start[c] += grid.cell_start[c - 1];
        Array<std::uint32_t> next(grid.cell_start.begin(), grid.cell_start.end() - 1);
        order.resize(order.size() + members.size());
        for (std::size_t k = 0; k < members.size(); ++k)
            order[next[keys[k]]++ - first] = members[k];
        grids_.push_back(std::move(grid));
    }
    return order;
}

template <int D>
auto Neighbours<D>::flatten() const -> FlatLists {
    FlatLists flat;
    for (const ClusterList& list : clusters_) {
        const std::size_t first = flat.entries.size();
        auto add = [&flat](std::uint32_t entry) { flat.entries.push_back(entry); };
        list.for_each_moving(add);
        flat.moving.push_back(static_cast<std::uint32_t>(flat.entries.size() - first));
        list.for_each_fixed(add);
        flat.fixed.push_back(static_cast<std::uint32_t>(flat.entries.size() - first) -
                             flat.moving.back());
    }
    return flat;
}

template <int D>
void Neighbours<D>::unflatten(const FlatLists& flat) {
    expect_fit(flat.moving.size() == flat.fixed.size(), "lists_fixed");
    storage_.assign(1, {});
    clusters_.assign(flat.moving.size(), {});
    std::span<const std::uint32_t> rest(flat.entries);
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
        const std::size_t length = std::size_t{flat.moving[c]} + flat.fixed[c];
        expect_fit(length <= rest.size(), "lists_entries");
        clusters_[c] = storage_[0].keep(rest.first(length), flat.moving[c]);
        rest = rest.subspan(length);
    }
    expect_fit(rest.empty(), "lists_entries");
}

template <int D>
void Neighbours<D>::expect_fit_of(int width, std::span<const std::uint8_t> is_fixed) const {
    const auto in_cluster = static_cast<std::size_t>(width);
    const std::size_t n = is_fixed.size();
    expect_fit(clusters_.size() == (n + in_cluster - 1) / in_cluster, "lists_moving");
    expect_fit(moving_ <= n, "moving_particles");
    for (std::size_t p = 0; p < n; ++p)
        expect_fit((is_fixed[p] != 0) == (p >= moving_), "moving_particles");
    auto expect_entry = [this](std::uint32_t entry, std::size_t first, std::size_t last) {
        const std::size_t j = entry & ListEntry::index_mask;
        expect_fit(first <= j && j < last, "lists_entries");
        expect_index(entry >> ListEntry::index_bits, image_shift_.size(), "lists_entries");
    };
    for (const ClusterList& list : clusters_) {
        list.for_each_moving([&](std::uint32_t entry) { expect_entry(entry, 0, moving_); });
        list.for_each_fixed([&](std::uint32_t entry) { expect_entry(entry, moving_, n); });
    }
}

template <int D>
std::size_t Neighbours<D>::entries() const {
    std::size_t count = 0;
    for (const ListStorage& list : storage_) count += list.entries();
    return count;
}

template <int D>
std::size_t Neighbours<D>::bytes() const {
    std::size_t bytes = clusters_.capacity() * sizeof(ClusterList);
    for (const ListStorage& list : storage_) bytes += list.bytes();
    for (const auto& grid : grids_) bytes += grid.cell_start.capacity() * sizeof(std::uint32_t);
    return bytes;
}

}  // namespace doseki
