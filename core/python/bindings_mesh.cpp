// Meshes of triangles as Python asks of them when it lays out their particles.

#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>

#include "base/parallel.hpp"
#include "bodies/shapes/mesh_inside.hpp"
#include "bodies/shapes/mesh_surface.hpp"
#include "interface/reader.hpp"
#include "python/values.hpp"

namespace doseki {
namespace {

Array<Vec3> points_of(const nb::object& position) {
    NamedValues columns;
    columns["position"] = to_value(position);
    return ColumnReader(columns, "points").vectors<3>("position");
}

Array<Facet<3>> triangles_of(const nb::object& corners) {
    const Array<Vec3> points = points_of(corners);
    Array<Facet<3>> triangles;
    for (std::size_t k = 0; k + 3 <= points.size(); k += 3)
        triangles.push_back({points[k], points[k + 1], points[k + 2]});
    return triangles;
}

class BoundMesh {
public:
    BoundMesh(const nb::object& corners, double thickness)
        : surface_(triangles_of(corners), thickness), inside_(triangles_of(corners)) {}

    nb::object from_wall(const nb::object& position, double width) const {
        const Array<Vec3> points = points_of(position);
        NewArray<double> result({points.size(), 4});
        for_each_task(points.size(), chunk, [&](std::size_t, std::size_t k) {
            const SurfacePoint<3> place = surface_.from_wall(points[k], width);
            double* const row = result.row(k);
            row[0] = place.distance;
            std::copy_n(place.normal.component.begin(), 3, row + 1);
        });
        return to_python(Value(result));
    }

    nb::object winding(const nb::object& position) const {
        const Array<Vec3> points = points_of(position);
        NewArray<std::int32_t> result({points.size()});
        for_each_task(points.size(), chunk,
                      [&](std::size_t, std::size_t k) { result[k] = inside_.winding(points[k]); });
        return to_python(Value(result));
    }

    std::tuple<std::uint32_t, double, double, double> cuts() const {
        const MeshInside::Cut found = inside_.cuts();
        return {found.count, found.first[0], found.first[1], found.first[2]};
    }

private:
    static constexpr std::size_t chunk = 256;

    MeshSurface<3> surface_;
    MeshInside inside_;
};

}  // namespace
}  // namespace doseki

void bind_mesh(nanobind::module_& m) {
    using doseki::BoundMesh;
    namespace nb = nanobind;
    nb::class_<BoundMesh>(m, "SurfaceMesh")
        .def(nb::init<const nb::object&, double>(), nb::arg("corners"), nb::arg("thickness"),
             nb::sig("def __init__(self, corners: numpy.ndarray, thickness: float) -> None"),
             "Triangles by their corners (3 m, 3), m; a thickness above 0 is that of a sheet.")
        .def("from_wall", &BoundMesh::from_wall, nb::arg("position"), nb::arg("width"),
             nb::sig("def from_wall(self, position: numpy.ndarray, width: float) -> numpy.ndarray"),
             "Signed distance, negative inside, and outward normal (n, 4) of points (n, 3).")
        .def("winding", &BoundMesh::winding, nb::arg("position"),
             nb::sig("def winding(self, position: numpy.ndarray) -> numpy.ndarray"),
             "How often the mesh, which is closed, goes around each of the points (n, 3).")
        .def("cuts", &BoundMesh::cuts,
             "How often an edge goes through another triangle, and where it does so first.");
}
