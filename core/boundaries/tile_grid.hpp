#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "base/array.hpp"
#include "boundaries/height_field.hpp"
#include "boundaries/tile_layer.hpp"

namespace doseki {

/// The plan of a bed in tiles, each of them some columns dp wide.
template <int D>
class TileGrid {
public:
    static constexpr int axes = D - 1;
    static constexpr int along = D == 2 ? 16 : 8;        // columns along a side of a tile
    static constexpr int columns = D == 2 ? 16 : 8 * 8;  // of a tile
    using Index = std::array<std::int64_t, axes>;

    TileGrid() = default;
    /// Throws std::invalid_argument where particles cannot number all columns.
    TileGrid(const HeightField<D>& field, double dp) : dp_(dp), side_(along * dp) {
        double total = columns;
        for (int a = 0; a < axes; ++a) {
            // One tile more on each side, for what flows along the edge of the map.
            low_[a] = field.origin[a] - side_;
            const double tiles = std::ceil((field.end(a) + side_ - low_[a]) / side_);
            tiles_[a] = static_cast<std::int64_t>(tiles);
            total *= tiles;
        }
        if (total > std::numeric_limits<std::int32_t>::max())
            throw std::invalid_argument("terrain: too many columns of dp x dp");
    }

    double dp() const { return dp_; }
    double side() const { return side_; }  // of a tile [m]
    double low(int a) const { return low_[a]; }
    std::int64_t count() const {
        std::int64_t count = 1;
        for (const std::int64_t tiles : tiles_) count *= tiles;
        return count;
    }

    /// The number of a tile; it is inside().
    std::int64_t number(const Index& tile) const {
        if constexpr (D == 2)
            return tile[0];
        else
            return tile[1] * tiles_[0] + tile[0];
    }
    bool inside(const Index& tile) const {
        for (int a = 0; a < axes; ++a)
            if (tile[a] < 0 || tile[a] >= tiles_[a]) return false;
        return true;
    }
    Index tile(std::int64_t number) const {
        if constexpr (D == 2)
            return {number};
        else
            return {number % tiles_[0], number / tiles_[0]};
    }
    Horizontal<D> corner(std::int64_t number) const {
        const Index index = tile(number);
        Horizontal<D> corner;
        for (int a = 0; a < axes; ++a) corner[a] = low_[a] + static_cast<double>(index[a]) * side_;
        return corner;
    }

    /// Calls f(number) for the tiles that a box in plan touches; beyond the grid is its edge.
    template <class F>
    void for_each_tile(const Horizontal<D>& from, const Horizontal<D>& to, const F& f) const {
        const Index first = tile_of(column_inside(from)), last = tile_of(column_inside(to));
        Index tile = first;
        if constexpr (D == 2) {
            for (; tile[0] <= last[0]; ++tile[0]) f(number(tile));
        } else {
            for (; tile[1] <= last[1]; ++tile[1])
                for (tile[0] = first[0]; tile[0] <= last[0]; ++tile[0]) f(number(tile));
        }
    }

    /// The column over which a place is, counted over all tiles; outside the grid too.
    Index column_at(const Horizontal<D>& place) const {
        Index column;
        for (int a = 0; a < axes; ++a)
            column[a] = static_cast<std::int64_t>(
                std::clamp(std::floor((place[a] - low_[a]) / dp_), -farthest, farthest));
        return column;
    }
    /// The nearest one inside the grid.
    Index column_inside(const Horizontal<D>& place) const {
        Index column = column_at(place);
        for (int a = 0; a < axes; ++a)
            column[a] = std::clamp(column[a], std::int64_t{0}, along * tiles_[a] - 1);
        return column;
    }
    static Index tile_of(const Index& column) {
        Index tile;
        for (int a = 0; a < axes; ++a)
            tile[a] = column[a] >= 0 ? column[a] / along : -((along - 1 - column[a]) / along);
        return tile;
    }
    /// Its number in its tile.
    static int number_in_tile(const Index& column) {
        const Index tile = tile_of(column);
        int number = 0;
        for (int a = axes - 1; a >= 0; --a)
            number = number * along + static_cast<int>(column[a] - along * tile[a]);
        return number;
    }

private:
    static constexpr double farthest = 1e15;  // a whole number that all types can hold

    double dp_ = 1.0, side_ = 1.0;
    Horizontal<D> low_{};  // corner of the first tile
    Index tiles_{};        // along each axis
};

/// Where the wall particles of a tile go. They come and go in groups: those of one layer in one
/// column, in hollows and on steep ground several.
template <int D>
struct WallTile {
    struct Slot {
        Vec<double, D> position, normal;
        Sym<double, D> bend;  // of the surface, see HeightField::bend
        double area;          // of the layer that it stands for [m^(D-1)]
        double depth;         // below the surface [m]
        int layer, column;
        double share = 1.0;  // of its cell that no body takes up
    };

    std::int64_t number = 0;
    Array<Slot> slots;  // layer by layer, from the surface down

    WallTile() = default;
    WallTile(const HeightField<D>& field, const TileGrid<D>& grid, std::int64_t number, int layers)
        : number(number) {
        const Horizontal<D> corner = grid.corner(number);
        for (int layer = 0; layer < layers; ++layer) {
            const double depth = depth_of(layer, grid.dp());
            const TileLayer<D> made(field, corner, grid.side(), grid.dp(), depth);
            for (const auto& foot : made.feet()) {
                const auto surface = field.at(foot.place);
                Vec<double, D> x{};
                for (int a = 0; a < D - 1; ++a) x[a] = foot.place[a];
                x[D - 1] = surface.height;
                slots.push_back({x - depth * surface.normal, surface.normal,
                                 field.bend(foot.place, grid.dp()), foot.area, depth, layer,
                                 column_of(foot.place, corner, grid.dp())});
            }
        }
    }

    static double depth_of(int layer, double dp) { return (layer + 0.5) * dp; }
    static int layer_of(double depth, double dp) {
        return static_cast<int>(std::floor(std::clamp(depth / dp, 0.0, 1e6)));
    }

private:
    static int column_of(const Horizontal<D>& place, const Horizontal<D>& corner, double dp) {
        int column = 0;
        for (int a = D - 2; a >= 0; --a) {
            const double u = std::floor((place[a] - corner[a]) / dp);
            column = column * TileGrid<D>::along +
                     static_cast<int>(std::clamp(u, 0.0, TileGrid<D>::along - 1.0));
        }
        return column;
    }
};

}  // namespace doseki
