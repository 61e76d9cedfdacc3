#pragma once

namespace doseki {

/// Where the energy of bodies is [J], 2-D: [J/m].
struct BodyEnergy {
    double kinetic = 0.0;   // of all
    double strain = 0.0;    // of deformable ones
    double springs = 0.0;   // of those that may break, Eq. (83)
    double contacts = 0.0;  // of the springs between bodies

    template <class F>
    void members(F&& f) const {
        f("kinetic", kinetic), f("strain", strain), f("springs", springs), f("contacts", contacts);
    }
};

}  // namespace doseki
