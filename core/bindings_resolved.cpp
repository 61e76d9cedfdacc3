// Simulations of the resolved scheme.

#include "bound_simulation.hpp"
#include "resolved/flow_rates.hpp"

void bind_resolved(nanobind::module_& m) {
    using namespace doseki;
    bind_simulation<FlowRates<2>>(m, "ResolvedSimulation2Double");
    bind_simulation<FlowRates<3>>(m, "ResolvedSimulation3Double");
}
