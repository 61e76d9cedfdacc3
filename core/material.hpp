#pragma once
#include <string>

#include "bodies/contacts.hpp"
#include "physics/rheology.hpp"

namespace doseki {

enum class Law { fluid, solid };

/// How the viscosity of a fluid follows from the rate of strain; only in the resolved scheme other
/// than newtonian.
enum class Rheology { newtonian, herschel_bulkley, mu_i };

/// Parameters of one material, already scaled by xi (Eq. 19): c0 -> xi c0, mu -> xi^2 mu.
struct Material {
    std::string name;
    Law law = Law::fluid;
    double rho0 = 1000.0;        // [kg/m^3]
    double c0 = 1400.0;          // [m/s]
    double shear_modulus = 0.0;  // [Pa]; 0 = no strength
    double nu = 0.0;             // kinematic viscosity [m^2/s]
    // Of solids; all zero: never yields.
    double yield_strength = 0.0;  // von Mises [Pa]
    double cohesion = 0.0;        // Drucker-Prager [Pa]
    double friction_angle = 0.0;  // Drucker-Prager [rad]
    // Of fluids.
    Rheology rheology = Rheology::newtonian;
    HerschelBulkley<double> herschel_bulkley{};
    MuI<double> mu_i{};
    Surface surface{};  // of a solid, where it touches another
};

}  // namespace doseki
