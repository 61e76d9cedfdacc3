#pragma once
#include <numbers>

#include "base/pack.hpp"

namespace doseki {

/// Wendland C6 kernel (Wendland 1995; Dehnen & Aly 2012) with support radius R = H h, H = 2.5:
/// W = C_D / R^D (1-q)^8 (1 + 8q + 25q^2 + 32q^3), q = r/R < 1.
template <int D>
struct WendlandC6 {
    static constexpr double support = 2.5;
    static constexpr double normalisation =
        D == 2 ? 78.0 / (7.0 * std::numbers::pi) : 1365.0 / (64.0 * std::numbers::pi);

    /// W(r) [1/m^D] for inverse_support = 1/R.
    template <class T>
    DOSEKI_FN static T value(const T& r, const T& inverse_support) {
        const T q = r * inverse_support;
        const T t = max(T(0), T(1) - q);
        const T t2 = t * t, t4 = t2 * t2;
        T scale = number<T>(normalisation) * inverse_support * inverse_support;
        if constexpr (D == 3) scale *= inverse_support;
        return scale * t4 * t4 * (T(1) + q * (T(8) + q * (T(25) + T(32) * q)));
    }

    /// F(r) = W'(r)/r <= 0 [1/m^(D+2)], so that grad_i W = F (x_i - x_j). A polynomial: regular at
    /// r = 0, and (1-q)_+^7 masks whatever lies outside the support.
    template <class T>
    DOSEKI_FN static T gradient_factor(const T& r, const T& inverse_support) {
        const T q = r * inverse_support;
        const T t = max(T(0), T(1) - q);
        const T t2 = t * t, t4 = t2 * t2;
        return gradient_scale(inverse_support) * (t4 * t2 * t) * (T(1) + q * (T(7) + T(16) * q));
    }

    /// -22 C_D / R^(D+2): what does not depend on r.
    template <class T>
    DOSEKI_FN static T gradient_scale(const T& inverse_support) {
        const T square = inverse_support * inverse_support;
        T scale = number<T>(-22 * normalisation) * square * square;
        if constexpr (D == 3) scale *= inverse_support;
        return scale;
    }
};

}  // namespace doseki
