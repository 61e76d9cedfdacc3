#pragma once
#include "base/pack.hpp"

namespace doseki {

/// Eq. (18): dt = min(C_CFL 2h / max v_sig, C_f sqrt(h/|a|)).
template <class T>
DOSEKI_FN T timestep(const T& h, const T& max_v_sig, const T& acceleration, const T& cflnumber,
                     const T& cfl_force) {
    const T acoustic = cflnumber * T(2) * h / max_v_sig;
    const T forced = cfl_force * sqrt(h / max(acceleration, number<T>(1e-300)));
    return min(acoustic, forced);
}

}  // namespace doseki
