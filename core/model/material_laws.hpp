#pragma once
// What follows from the laws of a material. The laws themselves (model/chosen_laws.hpp) are seen by
// few, so that one that is changed compiles no pair loop anew.

#include "physics/equation_of_state/thermodynamic_state.hpp"
#include "physics/rheology/pair_viscosity.hpp"

namespace doseki {

struct MaterialLaws;

/// Least density of a liquid over rho0, whatever tension it could bear: the resolved scheme is one
/// of weak compressibility.
inline constexpr double least_relative_density = 0.98;

DOSEKI_DEVICE_FN ThermodynamicState<double> thermodynamic_state(const MaterialLaws& laws,
                                                                double rho);
/// Its pressure alone [Pa], without what its energy takes to work out.
DOSEKI_DEVICE_FN double pressure_at(const MaterialLaws& laws, double rho);
/// Density at which the equation of state has this pressure; `low` or `high` where that lies beyond
/// them.
double density_of(const MaterialLaws& laws, double pressure, double low, double high);
/// Of the fluid itself, without turbulence [Pa s].
DOSEKI_DEVICE_FN double viscosity(const MaterialLaws& laws, const ShearState<double>& state);
/// What pairs take of two viscosities.
PairViscosity viscosity_of_pairs(const MaterialLaws& laws);

}  // namespace doseki
