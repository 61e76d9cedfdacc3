#pragma once
#include "base/vec.hpp"

namespace doseki {

/// What a scheme does to free particles beside what pairs of them exchange, as last evaluated; of
/// the particles of this rank, 2-D: per metre.
template <int D>
struct SchemeWork {
    Vec<double, D> layer_force{};  // on free particles, of the driven layers behind inflows [N]
    double layer_power = 0.0;      // of what drives those layers [W]
    double power = 0.0;            // that shifting, walls and films make [W]
    // By which the relaxation of density and surfaces that part change the energy of compression in
    // the step, however short it is [J].
    double energy = 0.0;
    double relaxation = 0.0;  // share of `energy` by which densities go to those of the arrangement

    DOSEKI_DEVICE_FN void add(const SchemeWork& other) {
        layer_force = layer_force + other.layer_force;
        layer_power += other.layer_power, power += other.power;
        energy += other.energy, relaxation += other.relaxation;
    }
};

}  // namespace doseki
