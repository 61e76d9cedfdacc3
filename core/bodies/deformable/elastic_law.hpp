#pragma once
#include "physics/hyperelastic.hpp"

namespace doseki {

/// The law of one body, which only what evaluates it knows.
struct ElasticLaw {
    Hyperelastic<double> law;
};

}  // namespace doseki
