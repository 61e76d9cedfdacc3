#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

namespace doseki {

/// What went wrong with a run.
enum class FailureKind { density, speed, timestep, outside, not_finite, empty, unresolved };

/// Its name, as Python has it.
inline const char* name_of(FailureKind kind) {
    constexpr std::array names{"density",    "speed", "timestep",  "outside",
                               "not_finite", "empty", "unresolved"};
    return names[static_cast<std::size_t>(kind)];
}

/// The particle to blame, as it was; id -1: none.
struct FailureSite {
    std::int64_t id = -1;
    int material = -1;
    std::array<double, 3> position{};   // [m]
    double speed = 0.0, density = 0.0;  // [m/s], [kg/m^3]
};

/// Physics went wrong: the run must stop.
struct PhysicsFailure : std::runtime_error {
    PhysicsFailure(const std::string& what, FailureKind kind, const FailureSite& site = {})
        : std::runtime_error(what), kind(kind), site(site) {}
    FailureKind kind;
    FailureSite site;
};

/// A limit of this build was met (more particles than an index can hold).
struct ResourceFailure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// For state that comes from a file: throws std::invalid_argument, which names the array, unless it
/// fits the others.
inline void expect_fit(bool good, const char* name) {
    if (!good)
        throw std::invalid_argument(std::string("not the state of this simulation: ") + name);
}

/// The same for an index into `count` elements.
template <class Index>
void expect_index(Index index, std::size_t count, const char* name) {
    expect_fit(std::cmp_greater_equal(index, 0) && std::cmp_less(index, count), name);
}

}  // namespace doseki
