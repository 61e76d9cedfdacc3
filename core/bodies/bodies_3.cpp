// Bodies in three dimensions, compiled once for all schemes.

#include "bodies/bodies.hpp"
#include "bodies/contact_forces.hpp"

namespace doseki {

template class RigidBodies<3>;
template class RigidParticles<3>;
template class Contacts<3>;
template class Bodies<3>;

}  // namespace doseki
