#pragma once
#include "model/material_laws.hpp"
#include "physics/equation_of_state.hpp"
#include "physics/rheology.hpp"

namespace doseki {

/// What a material obeys, scaled as its numbers are (model/material.hpp).
struct MaterialLaws {
    EquationOfState<double> eos;
    Rheology<double> rheology;  // of fluids
};

}  // namespace doseki
