// Deformable bodies by themselves: without water, contact or record.

#include <nanobind/nanobind.h>
#include <nanobind/stl/vector.h>

#include "bodies/elastic/total_lagrangian.hpp"
#include "interface/bodies.hpp"
#include "interface/reader.hpp"
#include "python/values.hpp"

namespace doseki {
namespace {

template <int D>
class BoundElastic {
public:
    void add(const nb::dict& body, const nb::kwargs& points) {
        const NamedValues columns = to_table(points);
        ColumnReader column(columns, "points");
        const SolidPoints<D> solid = solid_points<D>(column);
        column.finish();
        bodies_.add(read_elastic_body(to_table(body), {}), solid);
    }

    void start() { bodies_.start(gravity_); }
    void advance(double dt) { bodies_.advance(dt, gravity_); }
    void set_gravity(const std::vector<double>& g) { gravity_ = vectors_of<D>(g).at(0); }
    void set_load(const nb::object& force) {
        NamedValues columns;
        columns["force"] = to_value(force);
        const auto by_number = ColumnReader(columns, "load").vectors<D>("force");
        if (by_number.size() != bodies_.size()) throw nb::value_error("one force for each point");
        for (std::size_t k = 0; k < by_number.size(); ++k)
            bodies_.load[bodies_.slot(k)] = by_number[k];
    }
    double timestep() const { return bodies_.timestep(); }
    void set_velocity(const nb::object& velocity) {
        NamedValues columns;
        columns["velocity"] = to_value(velocity);
        const auto by_number = ColumnReader(columns, "points").vectors<D>("velocity");
        if (by_number.size() != bodies_.size())
            throw nb::value_error("one velocity for each point");
        for (std::size_t k = 0; k < by_number.size(); ++k)
            bodies_.v[bodies_.slot(k)] = by_number[k];
    }

    /// Each bond once: its points in the order of adding, and how much of it is left.
    nb::dict bonds() const {
        Array<std::size_t> number(bodies_.size());
        for (std::size_t k = 0; k < number.size(); ++k) number[bodies_.slot(k)] = k;
        Array<std::int64_t> a, b;
        Array<double> left;
        for (std::size_t p = 0; p < number.size(); ++p)
            bodies_.bonds().for_each_bond(p, [&](std::uint32_t j, double intactness) {
                if (j < p) return;
                a.push_back(static_cast<std::int64_t>(number[p]));
                b.push_back(static_cast<std::int64_t>(number[j]));
                left.push_back(intactness);
            });
        NewArray<std::int64_t> first({a.size()}), second({a.size()});
        NewArray<double> intactness({a.size()});
        for (std::size_t n = 0; n < a.size(); ++n)
            first[n] = a[n], second[n] = b[n], intactness[n] = left[n];
        NamedValues table;
        table["a"] = first, table["b"] = second, table["intactness"] = intactness;
        return to_python(table);
    }

    /// Fields in the order of adding.
    nb::dict state() {
        const std::size_t n = bodies_.size();
        NewArray<double> position({n, D}), velocity({n, D}), acceleration({n, D}), rest({n, D}),
            mass({n}), F({n, D, D}), P({n, D, D});
        auto put = [](NewArray<double>& array, std::size_t k, const auto& numbers) {
            std::copy(numbers.begin(), numbers.end(), array.data() + k * numbers.size());
        };
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t p = bodies_.slot(k);
            mass[k] = bodies_.mass(p);
            put(position, k, bodies_.x[p].component), put(velocity, k, bodies_.v[p].component);
            put(acceleration, k, bodies_.a[p].component);
            put(rest, k, bodies_.rest_position(p).component);
            put(F, k, bodies_.deformation(p).element), put(P, k, bodies_.stress(p).element);
        }
        NamedValues table;
        table["position"] = position, table["velocity"] = velocity, table["rest"] = rest;
        table["acceleration"] = acceleration, table["mass"] = mass;
        table["deformation"] = F, table["stress"] = P;
        const ElasticEnergy energy = bodies_.elastic_energy();
        table["strain_energy"] = energy.strain, table["spring_energy"] = energy.springs;
        table["kinetic_energy"] = bodies_.kinetic_energy();
        table["fracture_work"] = bodies_.fracture_work();
        table["damping_work"] = bodies_.damping_work();
        return to_python(table);
    }

private:
    TotalLagrangian<D> bodies_;
    Vec<double, D> gravity_{};
};

template <int D>
void bind(nb::module_& m, const char* name) {
    using B = BoundElastic<D>;
    const auto unlocked = nb::call_guard<nb::gil_scoped_release>();
    nb::class_<B>(m, name)
        .def(nb::init<>())
        .def("add", &B::add, nb::arg("body"), nb::arg("points"),
             nb::sig("def add(self, body: doseki.solver.protocol.Table, **points: numpy.ndarray) "
                     "-> None"),
             "Add a body (rho0, young_modulus, poisson_ratio, elastic_law, spacing, hourglass, "
             "damping; fracture with the parameters of that law, flaw_seed) of points (rest, "
             "position, "
             "velocity, clamped).")
        .def("start", &B::start, unlocked)
        .def("advance", &B::advance, nb::arg("dt"), unlocked)
        .def("set_gravity", &B::set_gravity, nb::arg("g"))
        .def("set_load", &B::set_load, nb::arg("force"),
             nb::sig("def set_load(self, force: numpy.ndarray) -> None"),
             "Forces (n, D) in the order of adding, N (2-D: N/m).")
        .def("set_velocity", &B::set_velocity, nb::arg("velocity"),
             nb::sig("def set_velocity(self, velocity: numpy.ndarray) -> None"),
             "Velocities (n, D) in the order of adding, m/s; clamped points keep theirs.")
        .def_prop_ro("timestep", &B::timestep)
        .def("bonds", &B::bonds, nb::sig("def bonds(self) -> dict[str, object]"),
             "Bonds of breakable bodies: points a and b, and intactness, 1 whole, 0 broken.")
        .def("state", &B::state, nb::sig("def state(self) -> dict[str, object]"));
}

}  // namespace
}  // namespace doseki

void bind_elastic(nanobind::module_& m) {
    doseki::bind<2>(m, "ElasticBodies2");
    doseki::bind<3>(m, "ElasticBodies3");
}
