// Simulations, compiled once for all schemes.

#include "device/lists_of_build.hpp"
#include "interface/adapter.hpp"

namespace doseki {
namespace {

const SimulationKind plane(2, Adapter<ListsOfBuild<2>>::make);
const SimulationKind solid(3, Adapter<ListsOfBuild<3>>::make);

}  // namespace
}  // namespace doseki
