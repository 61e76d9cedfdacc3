#pragma once
#include "base/vec.hpp"

namespace doseki {

/// What the viscosity of a fluid may depend on.
template <class T>
struct ShearState {
    T rate;  // |D| = sqrt(2 D:D) of the strain rate [1/s]
    T p;     // mean pressure [Pa]
    T rho;   // [kg/m^3]
};

/// |D| = sqrt(2 D:D) of the strain rate, the symmetric part of L [1/s].
template <class T, int D>
DOSEKI_FN T strain_rate(const Mat<T, D>& L) {
    T sum = T(0);
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) {
            const T d = number<T>(0.5) * (L(a, b) + L(b, a));
            sum += T(2) * d * d;
        }
    return sqrt(sum);
}

}  // namespace doseki
