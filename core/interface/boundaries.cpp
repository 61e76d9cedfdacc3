#include "interface/boundaries.hpp"

#include <cmath>

#include "interface/reader.hpp"

namespace doseki {
namespace {

SpeedTable read_speeds(Reader& read, const NamedValues& table) {
    SpeedTable speeds;
    if (table.find("times")) {
        read("times", speeds.time), read("distances", speeds.distance),
            read("speeds", speeds.speed);
    } else {
        double start = 0.0, stop = 0.0, speed = 0.0;
        read("start", start), read("stop", stop), read("speed", speed);
        speeds = SpeedTable::constant(start, stop, speed);
    }
    if (speeds.time.size() < 2 || speeds.distance.size() != speeds.time.size() ||
        speeds.speed.size() != speeds.time.size())
        throw std::invalid_argument(
            "inflow: expected two rows or more of times, distances and speeds");
    return speeds;
}

}  // namespace

template <int D>
Inflow<D> BoundaryTables<D>::inflow(const NamedValues& table) {
    Inflow<D> inflow;
    Reader read(table, "inflow");
    read("layer", inflow.layer), read("direction", inflow.direction);
    inflow.speed = read_speeds(read, table);
    read("spacing", inflow.spacing), read("buffer_layers", inflow.buffer_layers);
    read("jitter", inflow.jitter), read("mass", inflow.mass), read("density", inflow.density);
    read("smoothing_length", inflow.smoothing_length);
    read("material", inflow.material), read("body", inflow.body);
    read("row_height", inflow.row_height, optional), read("thickness", inflow.thickness, optional);
    read.finish();
    const bool rises = !inflow.thickness.empty();
    if (rises && (inflow.thickness.size() != inflow.speed.time.size() ||
                  inflow.row_height.size() != inflow.layer.size()))
        throw std::invalid_argument("inflow: thickness or row_height of the wrong length");
    return inflow;
}

template <int D>
Outflow<D> BoundaryTables<D>::outflow(std::span<const double> low, std::span<const double> high) {
    if (low.size() != D || high.size() != D)
        throw std::invalid_argument("box: corners of the wrong dimension");
    return {vectors_of<D>(low)[0], vectors_of<D>(high)[0]};
}

template <int D>
CountingPlane<D> BoundaryTables<D>::plane(std::span<const double> point,
                                          std::span<const double> normal) {
    if (point.size() != D || normal.size() != D)
        throw std::invalid_argument("plane: a point or normal of the wrong dimension");
    CountingPlane<D> plane;
    plane.point = vectors_of<D>(point)[0], plane.normal = vectors_of<D>(normal)[0];
    const double length = std::sqrt(dot(plane.normal, plane.normal));
    if (!(length > 0.0)) throw std::invalid_argument("plane: a normal of length 0");
    plane.normal = (1.0 / length) * plane.normal;
    return plane;
}

template <int D>
WallMotion<D> BoundaryTables<D>::motion(const NamedValues& table) {
    WallMotion<D> motion;
    Reader read(table, "motion");
    read("body", motion.body), read("velocity", motion.velocity);
    read("angular_velocity", motion.spin), read("pivot", motion.pivot);
    read("start", motion.start), read("stop", motion.stop);
    read("removed_at", motion.removed_at);
    read.finish();
    return motion;
}

template <int D>
HeightField<D> BoundaryTables<D>::height_field(const NamedValues& table) {
    HeightField<D> field;
    NumberArray heights;
    Reader read(table, "terrain");
    read("origin", field.origin), read("cell", field.cell), read("heights", heights);
    read.allow("unknown"), read.finish();
    if (heights.shape.size() != D - 1)
        throw std::invalid_argument("terrain.heights: a grid of the wrong dimension");
    std::size_t width = 1;
    for (int a = 0; a < D - 1; ++a) {
        field.nodes[a] = static_cast<std::int64_t>(heights.shape[D - 2 - a]);
        if (field.nodes[a] < 2) throw std::invalid_argument("terrain.heights: fewer than 2 nodes");
        if (a < D - 2) width = heights.shape[D - 2 - a];
    }
    ColumnReader column(table, "terrain", ColumnReader::any_rows);
    field.heights = column.numbers<double>("heights", width);
    field.unknown = column.numbers<std::uint8_t>("unknown", width);
    if (field.unknown.size() != field.heights.size() || !(field.cell > 0.0))
        throw std::invalid_argument("terrain: unknown and heights differ in shape, or no cell");
    for (const double height : field.heights)
        if (!std::isfinite(height)) throw std::invalid_argument("terrain.heights: not finite");
    return field;
}

template <int D>
TerrainWall BoundaryTables<D>::terrain_wall(const NamedValues& table) {
    TerrainWall wall;
    Reader read(table, "terrain wall");
    read("dp", wall.dp), read("layers", wall.layers), read("density", wall.density);
    read("smoothing_length", wall.smoothing_length);
    read("material", wall.material), read("body", wall.body), read("faces", wall.faces);
    read.finish();
    return wall;
}

template struct BoundaryTables<2>;
template struct BoundaryTables<3>;

}  // namespace doseki
