// Deformable bodies in two dimensions, compiled once for all schemes.

#include "bodies/deformable/advance.hpp"

namespace doseki {

template class TotalLagrangian<2>;
template class DeformableBodies<2>;

}  // namespace doseki
