#include "model/material_laws.hpp"

#include "model/chosen_laws.hpp"

namespace doseki {

DOSEKI_DEVICE_FN ThermodynamicState<double> thermodynamic_state(const MaterialLaws& laws,
                                                                double rho) {
    return thermodynamic_state(laws.eos, rho);
}

DOSEKI_DEVICE_FN double pressure_at(const MaterialLaws& laws, double rho) {
    return thermodynamic_state(laws.eos, rho).pressure;
}

double density_of(const MaterialLaws& laws, double pressure, double low, double high) {
    return density_of(laws.eos, pressure, low, high);
}

DOSEKI_DEVICE_FN double viscosity(const MaterialLaws& laws, const ShearState<double>& state) {
    return viscosity(laws.rheology, state);
}

PairViscosity viscosity_of_pairs(const MaterialLaws& laws) {
    return viscosity_of_pairs(laws.rheology);
}

}  // namespace doseki
