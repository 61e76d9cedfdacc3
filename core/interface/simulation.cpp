// Simulations, compiled once for all schemes.

#include "interface/adapter.hpp"
#include "pairs/neighbour_lists.hpp"

namespace doseki {
namespace {

const SimulationKind plane(2, Adapter<Neighbours<2>>::make);
const SimulationKind solid(3, Adapter<Neighbours<3>>::make);

}  // namespace
}  // namespace doseki
