#pragma once
// Inflows, outflows and prescribed motions as tables.

#include "base/array.hpp"
#include "boundaries/moving_walls.hpp"
#include "boundaries/open_boundaries.hpp"
#include "boundaries/terrain.hpp"
#include "interface/value.hpp"

namespace doseki {

template <int D>
struct BoundaryTables {
    /// An inflow of `times`, `distances` and `speeds`, or of a constant `speed` from `start` to
    /// `stop`.
    static Inflow<D> inflow(const NamedValues& table);
    static Outflow<D> outflow(std::span<const double> low, std::span<const double> high);
    static CountingPlane<D> plane(std::span<const double> point, std::span<const double> normal);
    static WallMotion<D> motion(const NamedValues& table);
    /// `origin` and `cell` of a grid of `heights`, which has a row for each node along the first
    /// axis (3-D: along the second, each of them a row of nodes along the first), and where it is
    /// `unknown`.
    static HeightField<D> height_field(const NamedValues& table);
    static TerrainWall terrain_wall(const NamedValues& table);
};

extern template struct BoundaryTables<2>;
extern template struct BoundaryTables<3>;

}  // namespace doseki
