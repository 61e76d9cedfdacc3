#pragma once
#include <string>
#include <utility>

#include "base/array.hpp"
#include "base/vec.hpp"

namespace doseki {

/// What acts on one particle, and what limits its timestep, by name: the terms of the acceleration
/// add up to it, the timestep is the smallest of its limits.
template <int D>
struct ForceTerms {
    Array<std::pair<std::string, Vec<double, D>>> acceleration;  // [m/s^2]
    Array<std::pair<std::string, double>> timestep;              // [s]

    Vec<double, D> total_acceleration() const {
        Vec<double, D> sum{};
        for (const auto& [name, term] : acceleration) sum = sum + term;
        return sum;
    }
};

}  // namespace doseki
