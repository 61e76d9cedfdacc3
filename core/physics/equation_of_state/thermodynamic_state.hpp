#pragma once
#include "base/pack.hpp"

namespace doseki {

/// What an equation of state says about a density.
template <class T>
struct ThermodynamicState {
    T pressure;     // [Pa]
    T sound_speed;  // [m/s]
    T bulk_energy;  // of compression, from the density at rest [J/kg]
};

}  // namespace doseki
