#pragma once
// Cells of one class of particles, and the order in which particles are stored by them.

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "base/box.hpp"
#include "model/domain.hpp"

namespace doseki {

/// The particles of a cell, which follow each other in storage.
struct CellRange {
    std::uint32_t first, last;
};

/// Particles of one class: a contiguous range in sorted order with its table of cells. Cells that
/// follow each other in storage form groups, and only groups with particles have cells in memory.
template <int D>
struct CellGrid {
    static constexpr int group_bits = 2 * D;
    static constexpr std::uint32_t group_size = 1u << group_bits;  // cells

    bool fixed = false;
    std::uint32_t first = 0, last = 0;
    double support = 0.0;  // largest R of the class
    Box<D> bounds{};       // of its particles
    std::array<bool, D> periodic{};
    Vec<double, D> cell_size{};
    Vec<double, D> origin{};
    std::array<std::int64_t, D> cells{};           // power of two, except in periodic directions
    std::array<Array<std::uint32_t>, D> key_part;  // Morton key = OR over directions
    Array<std::uint16_t> curve;                    // of the cells of a block
    Array<std::uint32_t> rank;        // of each group: how many before it have particles
    Array<std::uint32_t> cell_start;  // of the cells of groups with particles, and the end

    /// Makes the cells around `members`, none of which is sorted into them yet.
    void size(const Domain<D>& domain, std::span<const Vec<double, D>> position,
              std::span<const std::uint32_t> members);

    /// Number of the cell of a coordinate along one direction, before it is wrapped.
    DOSEKI_DEVICE_FN std::int64_t cell_of(double x, int a) const {
        return static_cast<std::int64_t>(std::floor((x - origin[a]) / cell_size[a]));
    }
    DOSEKI_DEVICE_FN std::int64_t wrap(std::int64_t cell, int a) const {
        const std::int64_t n = cells[a];
        return periodic[a] ? ((cell % n) + n) % n : cell & (n - 1);
    }
    DOSEKI_DEVICE_FN std::uint32_t key_along(std::int64_t wrapped, int a) const {
        return key_part[a][static_cast<std::size_t>(wrapped)];
    }
    /// Place of a cell in storage: blocks of cells in Morton order, the cells of each along a
    /// Hilbert curve.
    DOSEKI_DEVICE_FN std::uint32_t place(std::uint32_t key) const {
        const auto in_block = static_cast<std::uint32_t>(curve.size() - 1);
        return (key & ~in_block) | curve[key & in_block];
    }
    DOSEKI_DEVICE_FN std::uint32_t place_of(const Vec<double, D>& x) const {
        std::uint32_t key = 0;
        for (int a = 0; a < D; ++a) key |= key_along(wrap(cell_of(x[a], a), a), a);
        return place(key);
    }
    std::size_t groups() const {
        return (static_cast<std::size_t>(table_size(cells)) + group_size - 1) / group_size;
    }
    /// Those of a cell, by its key.
    DOSEKI_DEVICE_FN CellRange particles(std::uint32_t key) const {
        const std::uint32_t at = place(key), group = at >> group_bits, number = rank[group];
        if (rank[group + 1] == number) return {0, 0};
        const std::size_t cell = std::size_t{number} << group_bits | (at & (group_size - 1));
        return {cell_start[cell], cell_start[cell + 1]};
    }
    /// Whether none of its particles can be within `radius` of the box.
    DOSEKI_DEVICE_FN bool is_beyond(const Vec<double, D>& low, const Vec<double, D>& high,
                                    double radius) const {
        for (int a = 0; a < D; ++a)
            if (!periodic[a] &&
                (bounds.low[a] > high[a] + radius || bounds.high[a] < low[a] - radius))
                return true;
        return false;
    }

private:
    static std::int64_t table_size(const std::array<std::int64_t, D>& cells);
    std::array<std::int64_t, D> fold(std::array<std::int64_t, D> cells,
                                     std::span<const Vec<double, D>> position,
                                     std::span<const std::uint32_t> members) const;
    void fill_key_parts();
};

// Compiled once, in cell_grid.cpp.
extern template struct CellGrid<2>;
extern template struct CellGrid<3>;

}  // namespace doseki
