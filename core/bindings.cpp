// The compiled module: simulations of the ueta2022 scheme, and what is common to all.

#include "bound_simulation.hpp"
#include "rates.hpp"

namespace nb = nanobind;
using namespace doseki;

void bind_resolved(nb::module_& m);
void bind_elastic(nb::module_& m);
void bind_physics(nb::module_& m);

NB_MODULE(DOSEKI_MODULE, m) {
    nb::exception<PhysicsFailure>(m, "PhysicsFailure");
    nb::exception<ResourceFailure>(m, "ResourceFailure");
    m.attr("lanes") = lanes<double>;
    m.def("set_threads", [](int n) { omp_set_num_threads(n); });
    m.def("threads", [] { return omp_get_max_threads(); });
    bind_simulation<Rates<double, 2>>(m, "Simulation2Double");
    bind_simulation<Rates<double, 3>>(m, "Simulation3Double");
    bind_simulation<Rates<float, 2>>(m, "Simulation2Float");
    bind_simulation<Rates<float, 3>>(m, "Simulation3Float");
    bind_resolved(m);
    bind_elastic(m);
    nb::module_ physics =
        m.def_submodule("physics", "Point functions, each on scalars and on packs.");
    bind_physics(physics);
}
