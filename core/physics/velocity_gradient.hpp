#pragma once
#include "base/vec.hpp"

namespace doseki {

/// Eq. (9) with * = tensor product, written so that L_ab = d v_a / d x_b:
/// rho_i L += m_j (v_j - v_i) (x) grad_i W.
template <class T, int D>
DOSEKI_FN void add_velocity_gradient(Mat<T, D>& gradient, const T& m_j, const Vec<T, D>& v_ij,
                                     const T& F, const Vec<T, D>& r_ij) {
    const T weight = -(m_j * F);
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) gradient(a, b) += (weight * r_ij[b]) * v_ij[a];
}

/// |curl v| from L; one component in 2-D.
template <class T, int D>
DOSEKI_FN T curl_magnitude(const Mat<T, D>& L) {
    const T z = L(1, 0) - L(0, 1);
    if constexpr (D == 2) {
        return abs(z);
    } else {
        const T x = L(2, 1) - L(1, 2), y = L(0, 2) - L(2, 0);
        return sqrt(x * x + y * y + z * z);
    }
}

/// Balsara's switch (1995): close to 1 in compression, to 0 in shear.
template <class T, int D>
DOSEKI_FN T balsara_switch(const Mat<T, D>& L, const T& c, const T& h) {
    const T div = abs(trace(L));
    return div / (div + curl_magnitude(L) + number<T>(1e-4) * c / h);
}

}  // namespace doseki
