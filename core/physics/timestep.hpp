#pragma once
#include "base/pack.hpp"

namespace doseki {

/// C_CFL 2h / max v_sig of Eq. (18).
template <class T>
DOSEKI_FN T acoustic_timestep(const T& h, const T& max_v_sig, const T& cflnumber) {
    return cflnumber * T(2) * h / max_v_sig;
}

/// C_f sqrt(h/|a|) of Eqs. (18) and (41).
template <class T>
DOSEKI_FN T force_timestep(const T& h, const T& acceleration, const T& cfl_force) {
    return cfl_force * sqrt(h / max(acceleration, number<T>(1e-300)));
}

/// Eq. (18): dt = min(C_CFL 2h / max v_sig, C_f sqrt(h/|a|)).
template <class T>
DOSEKI_FN T timestep(const T& h, const T& max_v_sig, const T& acceleration, const T& cflnumber,
                     const T& cfl_force) {
    return min(acoustic_timestep(h, max_v_sig, cflnumber),
               force_timestep(h, acceleration, cfl_force));
}

}  // namespace doseki
