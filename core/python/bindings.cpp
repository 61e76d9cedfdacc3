// The compiled module.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "device/card.hpp"

namespace nb = nanobind;

void bind_simulation(nb::module_& m);
void bind_elastic(nb::module_& m);
void bind_mesh(nb::module_& m);
void bind_physics(nb::module_& m);
void bind_terrain(nb::module_& m);
void bind_work(nb::module_& m);

NB_MODULE(DOSEKI_MODULE, m) {
    nb::exception<doseki::PhysicsFailure>(m, "PhysicsFailure");
    nb::exception<doseki::ResourceFailure>(m, "ResourceFailure");
    m.def("set_threads", &doseki::set_threads, nb::arg("n"));
    m.def("threads", &doseki::thread_count);
    bind_simulation(m);
    bind_elastic(m);
    bind_mesh(m);
    bind_physics(m);
    bind_terrain(m);
    bind_work(m);
#if defined(DOSEKI_CUDA)
    m.def("card_problem", &doseki::card_problem);
    m.def("use_card", &doseki::use_card, nb::arg("k"));
    m.def("card_name", &doseki::card_name);
    m.def("card_memory", &doseki::card_memory);
    m.def("card_bandwidth", &doseki::card_bandwidth);
    m.def("card_arithmetic", &doseki::card_arithmetic, nb::arg("in_double"));
#endif
}
