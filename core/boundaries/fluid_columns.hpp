#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/array.hpp"
#include "boundaries/tile_grid.hpp"
#include "model/particles.hpp"

namespace doseki {

/// What flows, and the faces of bodies that water may stand under, sorted by the column of the bed
/// that it is over.
template <int D>
class FluidColumns {
    using Grid = TileGrid<D>;
    using Index = typename Grid::Index;
    static constexpr int axes = D - 1;

public:
    /// A tile with fluid over it: what of it that is, in plan, and where the lowest is [m].
    struct Over {
        std::int64_t tile;
        Horizontal<D> from, to;
        double low;
        std::array<std::uint32_t, Grid::columns + 1> first;  // of each column among all
        std::array<double, Grid::columns> lowest;            // of each column [m]
    };

    FluidColumns(const Grid& grid, const Particles<D>& particles, double reach, bool faces)
        : grid_(grid), particles_(particles), faces_(faces) {
        sort_particles();
        list_columns_in(reach);
    }

    const Array<Over>& tiles() const { return tiles_; }

    /// What lies over a tile and those around it, so that a column is found at once.
    class Around {
    public:
        Around(const FluidColumns& fluid, std::int64_t tile) {
            const Index middle = fluid.grid_.tile(tile);
            for (int k = 0; k < places; ++k) {
                Index index = middle;
                for (int a = 0, digits = k; a < axes; ++a, digits /= width)
                    index[a] += digits % width - rings;
                around_[k] =
                    fluid.grid_.inside(index) ? fluid.find(fluid.grid_.number(index)) : nullptr;
            }
            for (int a = 0; a < axes; ++a) first_[a] = middle[a] - rings;
        }

        const Over* of(const Index& tile) const {
            int place = 0;
            for (int a = axes - 1; a >= 0; --a) {
                const std::int64_t k = tile[a] - first_[a];
                if (k < 0 || k >= width) return nullptr;
                place = place * width + static_cast<int>(k);
            }
            return around_[place];
        }

    private:
        static constexpr int rings = 3, width = 2 * rings + 1;
        static constexpr int places = D == 2 ? width : width * width;
        std::array<const Over*, places> around_;
        Index first_;
    };

    /// Whether any of it is nearer to x than `distance` [m], the reach at most.
    bool is_near(const Around& around, const Vec<double, D>& x, double distance) const;

private:
    struct Entry {
        std::int64_t column;
        std::uint32_t particle;
    };
    /// From a column to another one, and how far the two are apart at least, in columns squared.
    struct Offset {
        Index step;
        double gap;
    };

    bool is_in(std::uint32_t p) const {
        if (!particles_.is_wall(p)) return true;
        return faces_ && particles_.wall.in_use && particles_.wall.face[p] >= Face::first_body;
    }
    void sort_particles();
    void list_columns_in(double reach);
    const Over* find(std::int64_t tile) const {
        const auto found =
            std::lower_bound(tiles_.begin(), tiles_.end(), tile,
                             [](const Over& each, std::int64_t k) { return each.tile < k; });
        return found != tiles_.end() && found->tile == tile ? &*found : nullptr;
    }
    double squared_gap(const Horizontal<D>& place, const Index& column) const {
        double sum = 0.0;
        for (int a = 0; a < axes; ++a) {
            const double from = grid_.low(a) + static_cast<double>(column[a]) * grid_.dp();
            const double gap = std::max({0.0, from - place[a], place[a] - from - grid_.dp()});
            sum += gap * gap;
        }
        return sum;
    }

    const Grid& grid_;
    const Particles<D>& particles_;
    bool faces_;
    Array<Entry> entries_;   // column by column
    Array<Over> tiles_;      // in the order of their numbers
    Array<Offset> offsets_;  // the nearest first
};

template <int D>
void FluidColumns<D>::sort_particles() {
    for (std::uint32_t p = 0; p < particles_.size(); ++p) {
        if (!is_in(p)) continue;
        const Index column = grid_.column_inside(horizontal(particles_.position[p]));
        const std::int64_t tile = grid_.number(Grid::tile_of(column));
        entries_.push_back({tile * Grid::columns + Grid::number_in_tile(column), p});
    }
    std::sort(entries_.begin(), entries_.end(),
              [](const Entry& a, const Entry& b) { return a.column < b.column; });
    constexpr double infinite = std::numeric_limits<double>::infinity();
    int column = 0;  // of the last tile
    const auto go_on_to = [&](int next, std::uint32_t k) {
        while (column < next) tiles_.back().first[static_cast<std::size_t>(++column)] = k;
    };
    for (std::uint32_t k = 0; k < entries_.size(); ++k) {
        const Vec<double, D>& x = particles_.position[entries_[k].particle];
        const Horizontal<D> place = horizontal(x);
        const std::int64_t tile = entries_[k].column / Grid::columns;
        if (tiles_.empty() || tiles_.back().tile != tile) {
            if (!tiles_.empty()) go_on_to(Grid::columns, k);
            tiles_.push_back({tile, place, place, x[axes], {}, {}});
            tiles_.back().first[0] = k, tiles_.back().lowest.fill(infinite), column = 0;
        }
        Over& over = tiles_.back();
        go_on_to(static_cast<int>(entries_[k].column % Grid::columns), k);
        for (int a = 0; a < axes; ++a) {
            over.from[a] = std::min(over.from[a], place[a]);
            over.to[a] = std::max(over.to[a], place[a]);
        }
        over.low = std::min(over.low, x[axes]);
        double& lowest = over.lowest[static_cast<std::size_t>(column)];
        lowest = std::min(lowest, x[axes]);
    }
    if (!tiles_.empty()) go_on_to(Grid::columns, static_cast<std::uint32_t>(entries_.size()));
}

template <int D>
void FluidColumns<D>::list_columns_in(double reach) {
    const double dp = grid_.dp();
    const auto n = static_cast<std::int64_t>(std::ceil(reach / dp));
    const auto gap = [](std::int64_t k) {
        return std::max(0.0, std::abs(static_cast<double>(k)) - 1.0);
    };
    for (std::int64_t j = D == 3 ? -n : 0; j <= (D == 3 ? n : 0); ++j)
        for (std::int64_t i = -n; i <= n; ++i) {
            Offset offset{{}, gap(i) * gap(i) + gap(j) * gap(j)};
            offset.step[0] = i;
            if constexpr (D == 3) offset.step[1] = j;
            if (offset.gap * dp * dp < reach * reach) offsets_.push_back(offset);
        }
    const auto length = [](const Offset& offset) {
        double sum = 0.0;
        for (const std::int64_t k : offset.step) sum += static_cast<double>(k * k);
        return sum;
    };
    std::stable_sort(offsets_.begin(), offsets_.end(),
                     [&](const Offset& a, const Offset& b) { return length(a) < length(b); });
}

template <int D>
bool FluidColumns<D>::is_near(const Around& around, const Vec<double, D>& x,
                              double distance) const {
    const Horizontal<D> place = horizontal(x);
    const Index own = grid_.column_at(place);
    const double square = distance * distance;
    for (const Offset& offset : offsets_) {
        Index column = own;
        for (int a = 0; a < axes; ++a) column[a] += offset.step[a];
        const Over* const over = around.of(Grid::tile_of(column));
        if (!over) continue;
        const auto k = static_cast<std::size_t>(Grid::number_in_tile(column));
        const double above = std::max(0.0, over->lowest[k] - x[axes]);
        if (squared_gap(place, column) + above * above >= square) continue;
        for (std::uint32_t e = over->first[k]; e < over->first[k + 1]; ++e) {
            const Vec<double, D> gap = particles_.position[entries_[e].particle] - x;
            if (dot(gap, gap) < square) return true;
        }
    }
    return false;
}

}  // namespace doseki
