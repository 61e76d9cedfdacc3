#pragma once
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "base/error.hpp"
#include "cells/cell_grid.hpp"
#include "model/archive.hpp"
#include "model/domain.hpp"

namespace doseki {

namespace bulk {
struct Buckets;
}

/// Entry of a list: particle index and, in the upper bits, through which image of it.
struct ListEntry {
    static constexpr int index_bits = 27;
    static constexpr std::uint32_t index_mask = (1u << index_bits) - 1;
    static constexpr std::uint32_t max_index = index_mask;
};

/// Sorted cells, one wrapped grid for each class of particles (moving or fixed, and per factor two
/// of the smoothing length). The sort is by class, then cell in Morton order, so that particles in
/// a row sit together. Cells wrap around a power-of-two table, so a particle far away costs nothing
/// and loses nothing: cells that share a table entry only add candidates, which a test of distance
/// removes.
template <int D>
class SortedCells {
public:
    static constexpr int dim = D;

    explicit SortedCells(const Domain<D>& domain) : domain_(domain) { fill_image_shifts(); }

    /// Order in which particles are to be stored: moving ones before fixed ones, and among each
    /// those that are near other ranks last; none are where `is_near` is empty.
    Array<std::uint32_t> sort(std::span<const Vec<double, D>> position,
                              std::span<const double> support,
                              std::span<const std::uint8_t> is_fixed,
                              std::span<const std::uint8_t> is_near = {});

    /// Order in which ghosts are to be stored after the particles: moving ones first. They are
    /// neighbours, and have none themselves.
    Array<std::uint32_t> sort_ghosts(std::span<const Vec<double, D>> position,
                                     std::span<const double> support,
                                     std::span<const std::uint8_t> is_fixed);

    const Array<Vec<double, D>>& image_shifts() const { return image_shift_; }
    const Domain<D>& domain() const { return domain_; }
    bool is_periodic() const { return domain_.any_periodic(); }
    std::size_t moving() const { return moving_; }
    /// Particles that have neighbours, ghosts left out.
    std::size_t size() const { return size_; }
    /// The first moving ones, which have no ghosts among their neighbours.
    std::size_t inner() const { return inner_; }
    void set_size(std::size_t size) { size_ = size; }

protected:
    std::span<const CellGrid<D>> grids() const { return grids_; }
    std::size_t bytes_of_cells() const;
    /// Throws std::invalid_argument unless these are lists of clusters of `width` particles, so
    /// many as there are flags, moving ones first.
    template <class List>
    void expect_fit_of(std::span<const List> lists, int width,
                       std::span<const std::uint8_t> is_fixed) const;
    void serialise(Archive& archive) { archive("moving_particles", moving_); }

private:
    void fill_image_shifts();
    Array<std::uint32_t> sort_classes(const bulk::Buckets& classes,
                                      std::span<const Vec<double, D>> position,
                                      std::span<const double> support, std::size_t first);

    Domain<D> domain_;
    Array<Vec<double, D>> image_shift_;
    Array<CellGrid<D>> grids_;
    std::size_t moving_ = 0, inner_ = 0, size_ = 0;
};

template <int D>
template <class List>
void SortedCells<D>::expect_fit_of(std::span<const List> lists, int width,
                                   std::span<const std::uint8_t> is_fixed) const {
    const auto in_cluster = static_cast<std::size_t>(width);
    const std::size_t n = is_fixed.size();
    expect_fit(lists.size() == (n + in_cluster - 1) / in_cluster, "lists_moving");
    expect_fit(moving_ <= n, "moving_particles");
    for (std::size_t p = 0; p < n; ++p)
        expect_fit((is_fixed[p] != 0) == (p >= moving_), "moving_particles");
    auto expect_entry = [this](std::uint32_t entry, std::size_t first, std::size_t last) {
        const std::size_t j = entry & ListEntry::index_mask;
        expect_fit(first <= j && j < last, "lists_entries");
        expect_index(entry >> ListEntry::index_bits, image_shift_.size(), "lists_entries");
    };
    for (const List& list : lists) {
        list.for_each_moving([&](std::uint32_t entry) { expect_entry(entry, 0, moving_); });
        list.for_each_fixed([&](std::uint32_t entry) { expect_entry(entry, moving_, n); });
    }
}

// Compiled once, in sorted_cells.cpp.
extern template class SortedCells<2>;
extern template class SortedCells<3>;

}  // namespace doseki
