#pragma once

namespace doseki {

/// Where the energy of bodies is, and what breaking ones have given away since the start [J], 2-D:
/// [J/m].
struct BodyEnergy {
    double kinetic = 0.0;    // of all bodies
    double strain = 0.0;     // of deformable ones
    double springs = 0.0;    // of those that may break, Eq. (83)
    double contacts = 0.0;   // of the springs between bodies
    double cracks = 0.0;     // taken by cracks
    double damping = 0.0;    // taken by damping in bodies that may break
};

}  // namespace doseki
