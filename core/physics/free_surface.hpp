#pragma once
#include <cmath>

#include "base/matrix.hpp"

namespace doseki {

/// Where the free surface is, and how dense the fluid is regardless of it. C = sum_j m_j/rho0_j W,
/// over its value on a lattice, is 1 in a fluid that fills the kernel, whatever the law of pressure
/// makes of it; the indicator x = R |grad C|/C is 0 inside and 1.5 for particles of a flat surface,
/// and does not change when the fluid is diluted. C over what it should be at x is therefore the
/// normalised density of the fluid, near a surface as well as inside.
struct FreeSurfaceIndicator {
    static constexpr double surface = 0.9;  // above: on the surface
    static constexpr double edge = 2.2;     // above: a corner or less, where x tells nothing
    static constexpr double alone = 3.0;    // indicator of spray
    static constexpr double min_concentration = 0.6;  // below: spray

    double x, normalised_density;

    /// Whether particles are so few that they are apart, each as dense as the liquid.
    DOSEKI_DEVICE_FN bool is_spray() const { return x >= alone; }

    /// `wide`: Wendland C6 with support 3 dp, otherwise C2 with 2.78 dp. The constants give 1
    /// for the first two rows of a lattice under a flat surface, to 0.4 % in 2-D and 1.4 % in 3-D.
    DOSEKI_DEVICE_FN static FreeSurfaceIndicator of(double concentration, double scaled_gradient,
                                                    bool wide) {
        if (concentration < min_concentration) return {alone, 1.0};
        const double x = std::min(scaled_gradient / concentration, double{alone});
        const double a = wide ? 0.045 : 0.053, b = wide ? 0.047 : 0.086;
        return {x, x < edge ? concentration * (1.0 + x * (a + x * b)) : 1.0};
    }
};

/// sum V W and -sum V F x^2 on a square (2-D) or cubic lattice of spacing dp, both 1 for an
/// integral, and V W of the particle itself.
struct LatticeSums {
    double concentration = 0.0, moment = 0.0, own_share = 0.0;
};

template <class Kernel, int D>
LatticeSums lattice_sums(double dp, double support) {
    const int reach = static_cast<int>(support / dp) + 1;
    const double volume = std::pow(dp, D);
    LatticeSums sums;
    sums.own_share = volume * Kernel::value(0.0, 1.0 / support);
    for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
            for (int z = D == 3 ? -reach : 0; z <= (D == 3 ? reach : 0); ++z) {
                const double r = dp * std::sqrt(static_cast<double>(x * x + y * y + z * z));
                sums.concentration += volume * Kernel::value(r, 1.0 / support);
                sums.moment -= volume * Kernel::gradient_factor(r, 1.0 / support) * dp * dp * x * x;
            }
    return sums;
}

/// Inverse of a symmetric moment matrix; zero where particles do not span the space.
template <int D>
DOSEKI_DEVICE_FN Mat<double, D> inverse_moment(const Sym<double, D>& m) {
    constexpr double min_determinant = 0.05;
    return inverse(full(m), min_determinant);
}

/// The greatest rate |L| of shifting_velocity() over 1/dt with which a step does not go past the
/// place that a particle is shifted to, Eq. (153). Twice this makes disorder.
inline constexpr double max_shifting_rate = 0.0075;

/// Velocity at which particles are shifted towards where they are scarce (Lind et al., J. Comput.
/// Phys. 231, 2012; Sun et al. 2017), -A h^2 |L| grad C, at most 10 h |L|: what disorder the flow
/// makes in the time 1/|L| is undone in about that time, however fast the frame moves.
template <int D>
DOSEKI_DEVICE_FN Vec<double, D> shifting_velocity(const Vec<double, D>& gradient_of_concentration,
                                                  double rate, double h) {
    constexpr double strength = 80.0, max_speed = 10.0;
    const double length = std::sqrt(dot(gradient_of_concentration, gradient_of_concentration));
    if (!(length > 0.0)) return {};
    const double speed = std::min(strength * h * length, max_speed) * h * rate;
    return (-speed / length) * gradient_of_concentration;
}

/// v without its part along the direction of `normal` (of any length).
template <int D>
DOSEKI_DEVICE_FN Vec<double, D> tangential(const Vec<double, D>& v, const Vec<double, D>& normal) {
    const double square = dot(normal, normal);
    return square > 0.0 ? v - (dot(v, normal) / square) * normal : v;
}

}  // namespace doseki
