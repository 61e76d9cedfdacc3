// Deformable bodies by themselves: without water, contact or record.

#include "bound_elastic.hpp"

namespace doseki {
namespace {

template <int D>
class BoundElastic {
public:
    void add(const nb::dict& d, Input<double> position, Input<double> velocity,
             Input<std::uint8_t> clamped) {
        if (position.size() != clamped.size() * D || velocity.size() != position.size())
            throw nb::value_error("point arrays of unequal length");
        const auto x = rows(position), v = rows(velocity);
        bodies_.add(elastic_body(d), x, v, {clamped.data(), clamped.size()});
    }

    void start() { bodies_.start(); }
    void advance(double dt) { bodies_.advance(dt); }
    void set_gravity(const std::vector<double>& g) {
        for (int a = 0; a < D; ++a) bodies_.gravity[a] = g.at(static_cast<std::size_t>(a));
    }
    void set_load(Input<double> force) {
        if (force.size() != bodies_.size() * D) throw nb::value_error("one force for each point");
        const auto by_number = rows(force);
        for (std::size_t k = 0; k < by_number.size(); ++k)
            bodies_.load[bodies_.slot(k)] = by_number[k];
    }
    double timestep() const { return bodies_.timestep(); }

    /// Fields in the order of adding.
    nb::dict state() const {
        const std::size_t n = bodies_.size();
        Output<double> position({n, D}), velocity({n, D}), acceleration({n, D}), rest({n, D}),
            mass({n}), F({n, D, D}), P({n, D, D});
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t p = bodies_.slot(k);
            const auto rest_position = bodies_.rest_position(p);
            const auto stress = bodies_.stress(p);
            mass.data[k] = bodies_.mass(p);
            for (int a = 0; a < D; ++a) {
                position.data[k * D + a] = bodies_.x[p][a],
                                      velocity.data[k * D + a] = bodies_.v[p][a];
                acceleration.data[k * D + a] = bodies_.a[p][a],
                                          rest.data[k * D + a] = rest_position[a];
                for (int b = 0; b < D; ++b) {
                    F.data[(k * D + a) * D + b] = bodies_.deformation(p)(a, b);
                    P.data[(k * D + a) * D + b] = stress(a, b);
                }
            }
        }
        nb::dict d;
        d["position"] = position.release(), d["velocity"] = velocity.release(),
        d["rest"] = rest.release();
        d["acceleration"] = acceleration.release(), d["mass"] = mass.release();
        d["deformation"] = F.release(), d["stress"] = P.release();
        d["strain_energy"] = bodies_.strain_energy(),
        d["kinetic_energy"] = bodies_.kinetic_energy();
        return d;
    }

private:
    static std::vector<Vec<double, D>> rows(const Input<double>& array) {
        std::vector<Vec<double, D>> vectors(array.size() / D);
        for (std::size_t k = 0; k < array.size(); ++k)
            vectors[k / D][static_cast<int>(k % D)] = array.data()[k];
        return vectors;
    }

    ElasticBodies<D> bodies_;
};

template <int D>
void bind(nb::module_& m, const char* name) {
    using B = BoundElastic<D>;
    const auto unlocked = nb::call_guard<nb::gil_scoped_release>();
    nb::class_<B>(m, name)
        .def(nb::init<>())
        .def("add", &B::add, nb::arg("body"), nb::kw_only(), nb::arg("position"),
             nb::arg("velocity"), nb::arg("clamped"),
             "Add a body: rho0, young_modulus, poisson_ratio, spacing and, if wanted, law, "
             "hourglass, damping.")
        .def("start", &B::start, unlocked)
        .def("advance", &B::advance, nb::arg("dt"), unlocked)
        .def("set_gravity", &B::set_gravity, nb::arg("g"))
        .def("set_load", &B::set_load, nb::arg("force"),
             "Forces (n, D) in the order of adding, N (2-D: N/m).")
        .def_prop_ro("timestep", &B::timestep)
        .def("state", &B::state);
}

}  // namespace
}  // namespace doseki

void bind_elastic(nanobind::module_& m) {
    doseki::bind<2>(m, "ElasticBodies2");
    doseki::bind<3>(m, "ElasticBodies3");
}
