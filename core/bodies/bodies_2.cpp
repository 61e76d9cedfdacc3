// Bodies in two dimensions, compiled once for all schemes.

#include "bodies/bodies.hpp"
#include "bodies/contact_forces.hpp"

namespace doseki {

template class RigidBodies<2>;
template class RigidParticles<2>;
template class Contacts<2>;
template class Bodies<2>;

}  // namespace doseki
