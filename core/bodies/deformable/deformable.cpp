// Deformable bodies, compiled once for all schemes.

#include "bodies/deformable/advance.hpp"
#include "bodies/deformable/breakable.hpp"
#include "bodies/deformable/breaking.hpp"
#include "bodies/deformable/dividing.hpp"
#include "bodies/deformable/energy.hpp"
#include "bodies/deformable/rigid_shape.hpp"
#include "bodies/deformable/stable_step.hpp"

namespace doseki {

template class TotalLagrangian<2>;
template class DeformableBodies<2>;

template class TotalLagrangian<3>;
template class DeformableBodies<3>;

}  // namespace doseki
