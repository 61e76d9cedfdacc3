// The surface of a terrain by itself, for what is made on it before a run.

#include <nanobind/nanobind.h>
#include <nanobind/stl/vector.h>

#include "boundaries/tile_layer.hpp"
#include "interface/boundaries.hpp"
#include "interface/reader.hpp"
#include "python/values.hpp"

namespace doseki {
namespace {

template <int D>
class BoundHeightField {
public:
    explicit BoundHeightField(const nb::dict& table)
        : field_(BoundaryTables<D>::height_field(to_table(table))) {
        field_.hold_all();
    }

    nb::dict at(const nb::object& places) const {
        const auto place = vectors<D - 1>(places);
        const std::size_t n = place.size();
        NewArray<double> height({n}), area({n}), normal({n, D});
        NewArray<std::uint8_t> unknown({n});
        for (std::size_t k = 0; k < n; ++k) {
            const auto surface = field_.at(place[k]);
            height[k] = surface.height, area[k] = surface.area;
            unknown[k] = field_.is_unknown(place[k]);
            std::copy_n(surface.normal.component.begin(), D, normal.row(k));
        }
        NamedValues table;
        table["height"] = height, table["area"] = area, table["normal"] = normal;
        table["unknown"] = unknown;
        return to_python(table);
    }

    nb::dict nearest(const nb::object& points) const {
        const auto point = vectors<D>(points);
        const std::size_t n = point.size();
        NewArray<double> distance({n}), normal({n, D});
        for (std::size_t k = 0; k < n; ++k) {
            const auto found = field_.nearest(point[k]);
            distance[k] = found.distance;
            std::copy_n(found.normal.component.begin(), D, normal.row(k));
        }
        NamedValues table;
        table["distance"] = distance, table["normal"] = normal;
        return to_python(table);
    }

    nb::dict layer(const std::vector<double>& low, double side, double dp, double depth) const {
        if (low.size() != D - 1 || !(side > 0.0) || !(dp > 0.0))
            throw nb::value_error("layer: a corner of the wrong dimension, or no size");
        const TileLayer<D> made(field_, vectors_of<D - 1>(low)[0], side, dp, depth);
        const std::size_t n = made.feet().size();
        NewArray<double> place({n, D - 1}), area({n});
        for (std::size_t k = 0; k < n; ++k) {
            std::copy_n(made.feet()[k].place.component.begin(), D - 1, place.row(k));
            area[k] = made.feet()[k].area;
        }
        NamedValues table;
        table["place"] = place, table["area"] = area;
        return to_python(table);
    }

private:
    template <int width>
    static Array<Vec<double, width>> vectors(const nb::object& rows) {
        NamedValues columns;
        columns["rows"] = to_value(rows);
        return ColumnReader(columns, "points").vectors<width>("rows");
    }

    HeightField<D> field_;
};

template <int D>
void bind_height_field(nb::module_& m, const char* name) {
    using Field = BoundHeightField<D>;
    nb::class_<Field>(m, name, "What solver.protocol.HeightField describes.")
        .def(nb::init<const nb::dict&>(), nb::arg("table"),
             nb::sig("def __init__(self, table: doseki.solver.protocol.Table) -> None"))
        .def("at", &Field::at, nb::arg("places"),
             nb::sig("def at(self, places: numpy.ndarray) -> doseki.solver.protocol.Columns"))
        .def("nearest", &Field::nearest, nb::arg("points"),
             nb::sig("def nearest(self, points: numpy.ndarray) -> doseki.solver.protocol.Columns"))
        .def("layer", &Field::layer, nb::arg("low"), nb::arg("side"), nb::arg("dp"),
             nb::arg("depth"),
             nb::sig("def layer(self, low: collections.abc.Sequence[float], side: float, dp: "
                     "float, depth: float) -> doseki.solver.protocol.Columns"));
}

}  // namespace
}  // namespace doseki

void bind_terrain(nanobind::module_& m) {
    doseki::bind_height_field<2>(m, "HeightField2");
    doseki::bind_height_field<3>(m, "HeightField3");
}
