#pragma once
// Inflows, outflows and prescribed motions as tables.

#include "base/array.hpp"
#include "boundaries/moving_walls.hpp"
#include "boundaries/open_boundaries.hpp"
#include "interface/value.hpp"

namespace doseki {

template <int D>
struct BoundaryTables {
    /// An inflow of `times`, `distances` and `speeds`, or of a constant `speed` from `start` to
    /// `stop`.
    static Inflow<D> inflow(const NamedValues& table);
    static Outflow<D> outflow(std::span<const double> low, std::span<const double> high);
    static WallMotion<D> motion(const NamedValues& table);
};

extern template struct BoundaryTables<2>;
extern template struct BoundaryTables<3>;

}  // namespace doseki
