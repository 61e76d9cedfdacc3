#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>

namespace doseki {

/// Physics went wrong: the run must stop. Names the particle and the quantity.
struct PhysicsFailure : std::runtime_error {
    PhysicsFailure(const std::string& what, const std::string& kind, std::int64_t particle)
        : std::runtime_error(what), kind(kind), particle(particle) {}
    std::string kind;  // "density", "speed", "timestep", "outside", "not_finite", "empty"
    std::int64_t particle;
};

/// A limit of this build was met (more particles than an index can hold).
struct ResourceFailure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace doseki
