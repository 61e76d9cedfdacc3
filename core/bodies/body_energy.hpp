#pragma once

namespace doseki {

/// Where the energy of bodies is [J], 2-D: [J/m].
struct BodyEnergy {
    double kinetic = 0.0;   // of all
    double elastic = 0.0;   // of strain and springs of deformable ones
    double contacts = 0.0;  // of the springs between bodies

    template <class F>
    void members(F&& f) const {
        f("kinetic", kinetic), f("elastic", elastic), f("contacts", contacts);
    }
};

}  // namespace doseki
