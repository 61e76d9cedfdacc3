#pragma once
#include <cmath>
#include <limits>

#include "base/vec.hpp"

namespace doseki {

/// Eq. (61): sqrt(J2) + alpha I1 <= k, with I1 = -3p. A cone around the hydrostatic axis, or, with
/// alpha = 0, a cylinder. What never yields has k = infinity.
template <class T>
struct YieldSurface {
    T alpha, k;  // [1], [Pa]
};

inline YieldSurface<double> unyielding() { return {0.0, std::numeric_limits<double>::infinity()}; }

/// von Mises: sqrt(3 J2) <= Y.
inline YieldSurface<double> von_mises(double yield_strength) {
    return {0.0, yield_strength / std::sqrt(3.0)};
}

/// Drucker and Prager's cone for a cohesion [Pa] and an angle of friction [rad]: in 2-D that of
/// plane strain (Bui, Fukagawa, Sako & Ohno, Int. J. Numer. Anal. Methods Geomech. 32, 2008), in
/// 3-D the one through the meridian of compression of Mohr and Coulomb's pyramid.
template <int D>
YieldSurface<double> drucker_prager(double cohesion, double friction_angle) {
    if constexpr (D == 2) {
        const double tangent = std::tan(friction_angle),
                     scale = 1.0 / std::sqrt(9.0 + 12.0 * tangent * tangent);
        return {tangent * scale, 3.0 * cohesion * scale};
    } else {
        const double sine = std::sin(friction_angle), scale = 2.0 / (std::sqrt(3.0) * (3.0 - sine));
        return {sine * scale, 3.0 * cohesion * std::cos(friction_angle) * scale};
    }
}

/// Eq. (62): the smallest pressure that a surface admits, at its apex.
template <class T>
DOSEKI_FN T tension_cut(const YieldSurface<T>& surface, const T& p) {
    const T apex = -surface.k / (T(3) * surface.alpha);
    return select(surface.alpha > T(0), max(p, apex), p);
}

/// Eq. (63): S brought back to the surface along the deviatoric plane; volume does not change
/// (dilatancy zero). `p` is not below the tension cut.
template <class T, int D>
DOSEKI_FN Deviator<T, D> return_map(const Deviator<T, D>& S, const T& p,
                                    const YieldSurface<T>& surface) {
    const T size = sqrt(number<T>(0.5) * double_dot(S));
    const T limit = max(surface.k + T(3) * surface.alpha * p, T(0));
    const T scale = min(T(1), limit / max(size, number<T>(1e-30)));
    Deviator<T, D> mapped;
    for (int k = 0; k < Deviator<T, D>::size; ++k) mapped.element[k] = scale * S.element[k];
    return mapped;
}

}  // namespace doseki
