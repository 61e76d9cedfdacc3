#pragma once
// Rigid and deformable bodies as tables, in and out.

#include <optional>

#include "base/array.hpp"
#include "bodies/bodies.hpp"
#include "interface/particles.hpp"
#include "interface/reader.hpp"
#include "interface/value.hpp"

namespace doseki {

/// Body parameters of a table {rho0, young_modulus, poisson_ratio, elastic_law, spacing, hourglass,
/// damping}; `others` are keys that the caller reads itself.
DeformableBody read_elastic_body(const NamedValues& table, const Array<const char*>& others);

/// Columns rest, position, velocity and clamped of the points of a deformable body.
template <int D>
SolidPoints<D> solid_points(ColumnReader& column) {
    return {column.vectors<D>("rest"), column.vectors<D>("position"), column.vectors<D>("velocity"),
            column.numbers<std::uint8_t>("clamped")};
}

template <int D>
struct BodyTables {
    /// Balls {radius}, convex shapes {vertices, faces, samples}, or meshes with a thickness too,
    /// which is that of a sheet, [0] of one that encloses a body; {radius, ground} is `ground`.
    static Shape<D> shape(const NamedValues& table, const SharedSurface<D>& ground);
    static void add_rigid(Bodies<D>& bodies, const NamedValues& columns);
    /// `body`: index of its rigid body for each particle, or -1.
    static void bind(Bodies<D>& bodies, Particles<D>& particles, const NamedValues& columns);
    /// The parameters of read_elastic_body, its `material`, for each of its `particles` the columns
    /// of solid_points, places not wrapped, and of its surface each `vertex` at rest, the number of
    /// the particle that is its `carrier` and whether it is a `crease`. One that `breaks` is
    /// followed in the record, and in 2-D has cells: `cell_count` corners each, and `cell_node`,
    /// the numbers of points, then of vertices, that are corners, anticlockwise.
    static void add_elastic(Bodies<D>& bodies, Particles<D>& particles, const NamedValues& table);
    static LoadMeter<D> load_meter(const NamedValues& table);
    /// Impulses, peaks and hits of all load meters, and the panels of one after those of another.
    static NamedValues loads(const Bodies<D>& bodies);

    /// The rigid bodies, in the order in which they were added.
    static NamedValues rigid(const Bodies<D>& bodies);
    /// The deformable bodies that may break, and the parts of those that did.
    static NamedValues fragments(const Bodies<D>& bodies);
    /// Index of the body of each particle among those that the record follows, or -1.
    static Value body_number_of(const Bodies<D>& bodies, const Particles<D>& particles,
                                const Array<std::size_t>& order);
    /// How much of the bonds of each particle is broken; nothing of runs in which none can be.
    static std::optional<Value> damage(const Bodies<D>& bodies, const Particles<D>& particles,
                                       const Array<std::size_t>& order);
    /// Cauchy stress of particles, that of deformable bodies included.
    static Value stress(const Bodies<D>& bodies, const Particles<D>& particles,
                        const Array<std::size_t>& order, const PointStates<D>& states);
};

extern template struct BodyTables<2>;
extern template struct BodyTables<3>;

}  // namespace doseki
