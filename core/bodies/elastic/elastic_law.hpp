#pragma once
#include "physics/fracture.hpp"
#include "physics/hyperelastic.hpp"

namespace doseki {

/// The laws of one body, which only what evaluates them knows.
struct ElasticLaw {
    Hyperelastic<double> law;
    Fracture<double> fracture{};
};

}  // namespace doseki
