#pragma once
#include <cmath>
#include <cstdint>

#include "base/pack.hpp"

namespace doseki {

/// Abort limits of the density over that at rest.
inline constexpr double min_compression = 0.1, max_compression = 10.0;

DOSEKI_DEVICE_FN inline bool is_absurd(double rho, double rho0) {
    return !(rho > min_compression * rho0 && rho < max_compression * rho0);
}

/// Root-cause attribution of non-finite values. NaN times zero is NaN, so one broken particle
/// breaks the right-hand side of its cluster and of all its neighbours: those are blamed last, a
/// particle whose own state is broken first, and among equals the one noted first.
struct Fault {
    enum Rank : std::int8_t { none, right_hand_side, density, state };
    Rank rank = none;
    std::int64_t particle = -1;

    DOSEKI_DEVICE_FN void note(Rank found, std::size_t p) {
        if (found > rank) rank = found, particle = static_cast<std::int64_t>(p);
    }
    DOSEKI_DEVICE_FN void note_density(double rho, double rho0, std::size_t p) {
        if (is_absurd(rho, rho0)) note(density, p);
    }
    DOSEKI_DEVICE_FN void note_right_hand_side(double sum, std::size_t p) {
        if (!std::isfinite(sum)) note(right_hand_side, p);
    }
    DOSEKI_DEVICE_FN void merge(const Fault& later) {
        if (later.rank > rank || (later.rank == rank && later.particle < particle)) *this = later;
    }
};

/// What a pass over pairs found, and what the state itself says: looked at only once something is
/// wrong.
template <class State, class Materials>
Fault traced_to_its_source(Fault fault, const State& state, const Materials& materials) {
    if (fault.rank == Fault::none) return fault;
    for (std::size_t p = 0; p < state.size(); ++p) {
        if (!std::isfinite(state.sum_of_fields(p))) fault.note(Fault::state, p);
        if (state.has_density(p))
            fault.note_density(state.density[p], materials[state.tag[p].material].rho0, p);
    }
    return fault;
}

}  // namespace doseki
