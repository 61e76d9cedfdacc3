#pragma once
#include "base/pack.hpp"

namespace doseki {

/// What the viscosity of a fluid may depend on.
template <class T>
struct ShearState {
    T rate;  // |D| = sqrt(2 D:D) of the strain rate [1/s]
    T p;     // mean pressure [Pa]
    T rho;   // [kg/m^3]
};

}  // namespace doseki
