#pragma once
#include <cmath>
#include <cstdint>

#include "material.hpp"
#include "particles.hpp"

namespace doseki {

/// Density over density at rest beyond which a state is no longer one of matter.
inline constexpr double least_compression = 0.1, most_compression = 10.0;

inline bool is_absurd(double rho, double rho0) {
    return !(rho > least_compression * rho0 && rho < most_compression * rho0);
}

/// Whom to blame when numbers go wrong. NaN times zero is NaN, so one broken particle breaks the
/// rates of its cluster and of all its neighbours: those are blamed last, a particle whose own
/// state is broken first, and among equals the one noted first.
struct Fault {
    enum Rank : std::int8_t { none, rates, density, state };
    Rank rank = none;
    std::int64_t particle = -1;

    void note(Rank found, std::size_t p) {
        if (found > rank) rank = found, particle = static_cast<std::int64_t>(p);
    }
    void note_density(double rho, double rho0, std::size_t p) {
        if (is_absurd(rho, rho0)) note(density, p);
    }
    void note_rates(double sum, std::size_t p) {
        if (!std::isfinite(sum)) note(rates, p);
    }
    void merge(const Fault& later) {
        if (later.rank > rank) *this = later;
    }
};

template <int D>
bool has_finite_state(const Particles<D>& particles, std::size_t p) {
    double sum = particles.density[p];
    for (int a = 0; a < D; ++a) sum += particles.position[p][a] + particles.velocity[p][a];
    for (double element : particles.stress(p).element) sum += element;
    return std::isfinite(sum);
}

/// What a pass over pairs found, and what the state itself says: looked at only once something is
/// wrong.
template <int D, class Materials>
Fault traced_to_its_source(Fault fault, const Particles<D>& particles, const Materials& materials) {
    if (fault.rank == Fault::none) return fault;
    for (std::size_t p = 0; p < particles.size(); ++p) {
        if (!has_finite_state(particles, p)) fault.note(Fault::state, p);
        if (particles.has_flow && particles.is_wall(p)) continue;  // whose density means nothing
        fault.note_density(particles.density[p], materials[particles.tag[p].material].rho0, p);
    }
    return fault;
}

}  // namespace doseki
