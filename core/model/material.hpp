#pragma once
#include <string>

#include "base/memory.hpp"
#include "model/contact_properties.hpp"

namespace doseki {

enum class Law { fluid, solid };

struct MaterialLaws;  // model/chosen_laws.hpp

/// Parameters of one material, already scaled by xi (Eq. 19): c0 -> xi c0, mu -> xi^2 mu.
struct Material {
    std::string name;
    Law law;
    double rho0;  // [kg/m^3]
    double c0;    // [m/s]
    /// Apart, so that only what evaluates a law is compiled anew when one changes.
    Shared<const MaterialLaws> laws;
    double cavitation_pressure;  // of fluids: gauge pressure at which they tear [Pa]
    double air_entry_suction;    // of fluids: suction that pores hold until air enters [Pa]
    // Of solids; no yield strength, cohesion or friction angle: never yields.
    double shear_modulus;   // [Pa]; 0 = no strength
    double yield_strength;  // von Mises [Pa]
    double cohesion;        // Drucker-Prager [Pa]
    double friction_angle;  // Drucker-Prager [rad]
    ContactProperties contact;
};

}  // namespace doseki
