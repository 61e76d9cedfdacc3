// Bodies in three dimensions, compiled once for all schemes.

#include "bodies/bodies.hpp"
#include "bodies/deformable/advance.hpp"

namespace doseki {

template class TotalLagrangian<3>;
template class DeformableBodies<3>;
template class RigidBodies<3>;
template class RigidParticles<3>;
template class Contacts<3>;
template class Bodies<3>;

}  // namespace doseki
