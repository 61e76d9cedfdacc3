#pragma once
#include <numbers>

#include "base/pack.hpp"

namespace doseki {

/// Wendland C2 kernel (Wendland 1995) with support radius R = 2 h:
/// W = C_D / R^D (1-q)^4 (1 + 4q), q = r/R < 1.
template <int D>
struct WendlandC2 {
    static constexpr double support = 2.0;
    static constexpr double normalisation =
        D == 2 ? 7.0 / std::numbers::pi : 21.0 / (2.0 * std::numbers::pi);

    /// W(r) [1/m^D] for inverse_support = 1/R.
    template <class T>
    DOSEKI_FN static T value(const T& r, const T& inverse_support) {
        const T q = r * inverse_support;
        const T t = max(T(0), T(1) - q);
        T scale = number<T>(normalisation) * inverse_support * inverse_support;
        if constexpr (D == 3) scale *= inverse_support;
        return scale * (t * t) * (t * t) * (T(1) + T(4) * q);
    }

    /// F(r) = W'(r)/r <= 0 [1/m^(D+2)].
    template <class T>
    DOSEKI_FN static T gradient_factor(const T& r, const T& inverse_support) {
        const T t = max(T(0), T(1) - r * inverse_support);
        const T square = inverse_support * inverse_support;
        T scale = number<T>(-20 * normalisation) * square * square;
        if constexpr (D == 3) scale *= inverse_support;
        return scale * (t * t * t);
    }
};

}  // namespace doseki
