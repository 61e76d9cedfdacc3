// Neighbours of particles, compiled once for all schemes: sorting them in space and listing who is
// near whom.

#include "pairs/neighbour_lists.hpp"
#include "pairs/search.hpp"
#include "pairs/sort.hpp"

namespace doseki {

template class Neighbours<2>;
template class Neighbours<3>;

}  // namespace doseki
