#pragma once
#include <cstdint>

#include "base/matrix.hpp"
#include "physics/rheology/shear_state.hpp"

namespace doseki {

/// The viscosity of a pair. `by_rate`, Eq. (161): the one whose stress and rate of strain are the
/// means of both. `harmonic`: what is continuous beside a plug, where viscosity varies by orders of
/// magnitude (Cleary & Monaghan, J. Comput. Phys. 148, 1999). The last that a liquid of a run asks
/// for holds for all of it.
enum class PairViscosity : std::uint8_t { mean, by_rate, harmonic };

template <class T, int D>
DOSEKI_FN T pair_viscosity(const T& mu_i, const T& mu_j, const Sym<T, D>& strain_i,
                           const Sym<T, D>& strain_j, PairViscosity kind) {
    const T sum = mu_i + mu_j;
    if (kind == PairViscosity::harmonic) return T(2) * mu_i * mu_j / max(sum, number<T>(1e-30));
    if (kind == PairViscosity::mean) return number<T>(0.5) * sum;
    const T least = number<T>(1e-12);
    const T rate_i = strain_rate(full(strain_i)) + least,
            rate_j = strain_rate(full(strain_j)) + least;
    return (mu_i * rate_i + mu_j * rate_j) / (rate_i + rate_j);
}

}  // namespace doseki
