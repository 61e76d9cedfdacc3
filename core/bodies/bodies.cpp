// Bodies, compiled once for all schemes.

#include "bodies/bodies.hpp"

#include "bodies/contact_forces.hpp"

namespace doseki {

template class ContactLaws<2>;
template class RigidBodies<2>;
template class RigidParticles<2>;
template class Contacts<2>;
template class Bodies<2>;

template class ContactLaws<3>;
template class RigidBodies<3>;
template class RigidParticles<3>;
template class Contacts<3>;
template class Bodies<3>;

}  // namespace doseki
