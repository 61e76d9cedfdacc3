#pragma once
#include <string>

#include "bodies/contacts.hpp"

namespace doseki {

enum class Law { fluid, solid };

/// Parameters of one material, already scaled by xi (Eq. 19): c0 -> xi c0, mu -> xi^2 mu.
struct Material {
    std::string name;
    Law law = Law::fluid;
    double rho0 = 1000.0;           // [kg/m^3]
    double c0 = 1400.0;             // [m/s]
    double shear_modulus = 0.0;     // [Pa]; 0 = no strength
    double nu = 0.0;                // kinematic viscosity [m^2/s]
    Surface surface{};              // of a solid, where it touches another
};

}  // namespace doseki
