#pragma once
// The neighbour lists of the back end that a build of the core is for.

#if defined(DOSEKI_DEVICE)
#include "device/row_lists.hpp"
#else
#include "pairs/neighbour_lists.hpp"
#endif

namespace doseki {

#if defined(DOSEKI_DEVICE)
template <int D>
using ListsOfBuild = RowLists<D>;
#else
template <int D>
using ListsOfBuild = Neighbours<D>;
#endif

}  // namespace doseki
