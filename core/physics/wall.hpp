#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/vec.hpp"

namespace doseki {

/// Pressure of a wall particle minus that of one fluid particle i near it [Pa], Eq. (36): weight of
/// the fluid along the wall normal, rho_i g_n (r_iw.n), and the fluid's own pressure gradient along
/// the wall. Using all of gravity instead would cancel part of the pull along a slope; using none
/// of it along the wall would let water sink at the sides of a tank. `g_normal` = (g - a_w).(-n).
/// Where gravity pulls off the wall its share takes p_i at most: no wall holds water up.
template <class T, int D>
DOSEKI_FN T wall_excess_pressure(const T& p_i, const T& rho_i, const Vec<T, D>& gradient_i,
                                 const T& g_normal, const Vec<T, D>& normal, const T& r_dot_n,
                                 const Vec<T, D>& r_iw) {
    const T weight = max(rho_i * g_normal * r_dot_n, min(T(0), -p_i));
    return weight + dot(gradient_i, normal) * r_dot_n - dot(gradient_i, r_iw);
}

/// Eq. (133): the rate over its density [1/s] at which fluid expands that slides past an edge of a
/// wall. It is what the pressure force of wall particles along their faces takes as work. `rate` is
/// the sum over wall particles; along a plane face it is nothing but the lattice of the wall and
/// the noise of the fluid, which would brake what slides. `size` is the rate if all of them pulled
/// the same way.
DOSEKI_DEVICE_FN inline double edge_rate(double rate, double size) {
    constexpr double noise = 0.15, edge = 0.3;  // of the size
    if (!(std::abs(rate) > noise * size)) return 0.0;
    return rate * std::min((std::abs(rate) / size - noise) / (edge - noise), 1.0);
}

/// How the normal of a surface turns that curves alike all ways, as that of a ball does: by `bend`
/// r where one goes along r [1/m].
template <int D>
DOSEKI_DEVICE_FN Sym<double, D> bend_of_ball(const Vec<double, D>& normal, double curvature) {
    Sym<double, D> bend;
    for (int a = 0; a < D; ++a)
        for (int b = a; b < D; ++b)
            bend(a, b) = curvature * ((a == b ? 1.0 : 0.0) - normal[a] * normal[b]);
    return bend;
}

/// That of a ball, once its normal has turned from `before` to `normal`. Their lengths count:
/// particles in the middle of a body have none.
template <int D>
DOSEKI_DEVICE_FN Sym<double, D> turned_bend(const Sym<double, D>& bend,
                                            const Vec<double, D>& before,
                                            const Vec<double, D>& normal) {
    double sum = 0.0;
    for (int a = 0; a < D; ++a) sum += bend(a, a);
    return bend_of_ball(normal, sum / (D - dot(before, before)));
}

/// Radius of the ball [m] to which such a bend belongs; 0 without one.
template <class T, int D>
DOSEKI_FN T radius_of_ball(const Sym<T, D>& bend, const Vec<T, D>& normal) {
    T sum(0);
    for (int a = 0; a < D; ++a) sum += bend(a, a);
    const T curves = select(sum > T(0), T(1), T(0));
    return curves * (T(D) - dot(normal, normal)) / max(sum, T(1) - curves);
}

/// Normal of a curved wall at the foot of the fluid particle, Eq. (130), which leans by `turn`
/// farther than that of the wall particle. Along the latter what slides in a hollow would run into
/// the wall ahead and be held by the wall behind it, and so around a ball. No farther than `most`:
/// a kink is no curvature that particles resolve.
template <class T, int D>
DOSEKI_FN Vec<T, D> normal_at_foot(const Vec<T, D>& normal, const Vec<T, D>& turn) {
    const T most = number<T>(0.3);
    const T square = dot(turn, turn);
    if (!any(square != T(0))) return normal;
    const T size = max(sqrt(square), most), length = sqrt(T(1) + min(square, most * most));
    const T inverse = T(1) / (size * length);  // one division for both
    return (size * inverse) * normal + (most * inverse) * turn;
}

/// How much larger than v_i - v_w the jump to the velocity extrapolated into a no-slip wall is
/// (Morris et al. 1997): 1 + d_w/d_i for distances d_w below and d_i above the surface, the latter
/// no less than `min_distance`.
template <class T>
DOSEKI_FN T no_slip_factor(const T& d_w, const T& d_i, const T& min_distance) {
    return T(1) + d_w / max(d_i, min_distance);
}

/// Eq. (138): share of a no-slip wall's shear that the velocity gradient counts, for fluid that
/// slides along it at a speed [m/s]. All of it where viscosity makes the layer at the wall thicker
/// than the spacing; none where the layer is much thinner, for then fluid particles do not have
/// that shear, and what is reconstructed with it is an anti-viscosity.
template <class T>
DOSEKI_FN T resolved_shear(const T& mu, const T& rho, const T& speed, const T& dp) {
    const T tiny = number<T>(1e-30), inverse_reynolds = number<T>(0.1);
    return mu / (mu + inverse_reynolds * rho * speed * dp + tiny);
}

/// Stress that a rough bed takes from water of velocity |u| at height z: tau = rho (u kappa/ln(1 +
/// z/z0))^2 with z0 = ks/30 (Nikuradse's logarithmic law, regular at the bed). Returns tau/|u|^2
/// [kg/m^3].
DOSEKI_DEVICE_FN inline double bed_friction(double rho, double z, double ks) {
    constexpr double von_karman = 0.40;
    const double root = von_karman / std::log1p(30.0 * std::max(z, ks / 30.0) / ks);
    return rho * root * root;
}

/// Slope of that law times the height, over the speed there: z/((z + z0) ln(1 + z/z0)).
DOSEKI_DEVICE_FN inline double bed_slope(double z, double ks) {
    const double height = 30.0 * std::max(z, ks / 30.0) / ks;
    return height / ((1.0 + height) * std::log1p(height));
}

/// Stress that Voellmy's bed takes from what slides over it at a speed |u| under the effective
/// normal stress `normal_stress` (Voellmy, Schweiz. Bauzeitung 73, 1955): tau = mu sigma' + rho g
/// u^2/xi [Pa]. An infinite xi leaves Coulomb's friction alone.
DOSEKI_DEVICE_FN inline double voellmy_stress(double mu, double normal_stress, double rho, double g,
                                              double speed, double xi) {
    return mu * std::max(0.0, normal_stress) + rho * g * speed * speed / xi;
}

/// Spring and dashpot by which a bed holds what does not slide: no creep, and no force that could
/// reverse a motion within a step. Stiffness over area K = kappa rho c^2/dp, such that a layer of
/// particles swings slowly against sound; damping over area 2 zeta sqrt(K rho dp).
struct BedSpring {
    static constexpr double kappa = 0.5, zeta = 0.5;
    double stiffness;  // [Pa/m]
    double damping;    // [Pa s/m]

    DOSEKI_DEVICE_FN static BedSpring of(double rho, double c, double dp) {
        return {kappa * rho * c * c / dp, 2.0 * zeta * std::sqrt(kappa) * rho * c};
    }
};

/// Numbers of the faces of walls. Those of a body share one: films lie between two that differ.
/// Parts of bodies that broke have theirs from `first_part` on, which single precision holds.
/// Particles below the first row of a face have its number with a minus: films press on them, but
/// no other face sees them.
struct Face {
    static constexpr std::int32_t none = 0, fixed = 1, first_body = 2, first_part = 1 << 23;

    /// Whether there may be a film between them; of numbers, or of packs of them.
    template <class T>
    DOSEKI_DEVICE_FN static constexpr auto meet(const T& a, const T& b) {
        const auto of_others = a != b && a + b != T(0);
        return a != T(none) && b != T(none) && of_others && (a > T(none) || b > T(none));
    }
};

/// Sum of V f(r) over a plane lattice of spacing dp at this distance.
template <int D, class Function>
double sum_over_row(double dp, double support, double distance, const Function& f) {
    const int reach = static_cast<int>(support / dp) + 1;
    double sum = 0.0;
    for (int x = -reach; x <= reach; ++x)
        for (int y = D == 3 ? -reach : 0; y <= (D == 3 ? reach : 0); ++y)
            sum += std::pow(dp, D) * f(std::sqrt(distance * distance + dp * dp * (x * x + y * y)));
    return sum;
}

/// The same of V W.
template <class Kernel, int D>
double weight_of_row(double dp, double support, double distance) {
    return sum_over_row<D>(dp, support, distance,
                           [&](double r) { return Kernel::value(r, 1.0 / support); });
}

/// The gap between two walls in which there is no room for a fluid particle, told by what walls
/// take up of its kernel: `filled`, the sum of V W over them, and `slope`, that of V grad W, which
/// is nothing in the middle of a gap and large in front of one wall or in a corner. Eq. (156).
struct NarrowGap {
    double open = 1.0,
           closed = 1.0;     // what is filled in the middle of gaps of 0.95 and 0.7 spacings
    double per_slope = 0.0;  // so that a particle at one side of a gap counts like one there [m]

    /// From 0 in a gap that is wide enough to 1 in one that is too narrow.
    DOSEKI_DEVICE_FN double share(double filled, double slope) const {
        const double x =
            std::clamp((filled - per_slope * slope - open) / (closed - open), 0.0, 1.0);
        return x * x * (3.0 - 2.0 * x);
    }

    template <class Kernel, int D>
    static NarrowGap of(double dp, double support) {
        constexpr double weight_of_slope = 0.25;
        const int rows = static_cast<int>(support / dp) + 1;
        const auto wall = [&](double distance) {
            double weight = 0.0;
            for (int k = 0; k < rows; ++k)
                weight += weight_of_row<Kernel, D>(dp, support, distance + (k + 0.5) * dp);
            return weight;
        };
        // The slope in front of a wall is what its share loses on the way.
        const double slope = (wall(0.0) - wall(0.25 * dp)) / (0.25 * dp);
        return {2.0 * wall(0.475 * dp), 2.0 * wall(0.35 * dp), weight_of_slope / slope};
    }
};

/// What a wall particle sees of a plane face that goes on all around, by the distance of the first
/// row of that face, c(d) of Eq. (174). No two rows are nearer than one spacing, but for what
/// contacts yield.
struct FullCover {
    static constexpr int steps = 16;
    double nearest = 0.0, step = 1.0;  // [m]
    // Where c_min is meant [m]: nothing fits into a gap of one spacing; the second row sees no
    // farther.
    double farthest = 0.0, farthest_below = 0.0;
    std::array<double, steps + 1> weight{};

    DOSEKI_DEVICE_FN double at(double distance) const {
        const double x = std::clamp((distance - nearest) / step, 0.0, double(steps));
        const int k = std::min(static_cast<int>(x), steps - 1);
        return weight[k] + (x - k) * (weight[k + 1] - weight[k]);
    }

    template <class Kernel, int D>
    static FullCover of(double dp, double support) {
        FullCover cover{dp, 0.0, 2.0 * dp, 0.92 * support, {}};
        cover.step = (std::max(cover.farthest, cover.farthest_below) - dp) / steps;
        for (int k = 0; k <= steps; ++k)
            cover.weight[k] = weight_of_row<Kernel, D>(dp, support, dp + k * cover.step);
        return cover;
    }
};

/// What another particle of the same body takes of the area (87) of one, over both volumes, by
/// their distance r: that times the vector to the other one. Schemes without films have none.
struct PairArea {
    static constexpr int steps = 256;
    double support = 0.0;                    // [m]
    std::array<double, steps + 1> factor{};  // [1/m^(D+2)], of r^2 that rises evenly

    double at(double square) const {
        const double x = square / (support * support) * steps;
        if (!(x < steps)) return 0.0;
        const int k = static_cast<int>(x);
        return factor[k] + (x - k) * (factor[k + 1] - factor[k]);
    }

    /// `scale` is that of kernel gradients, Eq. (25).
    template <class Kernel>
    static PairArea of(double support, double scale) {
        PairArea area{support, {}};
        for (int k = 0; k <= steps; ++k) {
            const double r = support * std::sqrt(static_cast<double>(k) / steps);
            area.factor[k] = 2.0 * scale * Kernel::gradient_factor(r, 1.0 / support);
        }
        return area;
    }
};

/// The area (87) of a particle below a plane face that goes on all around, over its volume.
struct FlatArea {
    static constexpr int steps = 12;
    double step = 1.0;                        // of the depth below the face [m]
    std::array<double, steps + 1> inverse{};  // [1/m]

    DOSEKI_DEVICE_FN double at(double depth) const {
        const double x = std::clamp(depth / step, 0.0, double(steps));
        const int k = std::min(static_cast<int>(x), steps - 1);
        return inverse[k] + (x - k) * (inverse[k + 1] - inverse[k]);
    }

    /// `scale` is that of kernel gradients, Eq. (25).
    template <class Kernel, int D>
    static FlatArea of(double dp, double support, double scale) {
        FlatArea area{support / steps, {}};
        const int rows = static_cast<int>(support / dp) + 1;
        for (int k = 0; k <= steps; ++k)
            for (int n = 0; n < rows; ++n) {
                const double height = k * area.step + (n + 0.5) * dp;
                area.inverse[k] -=
                    2.0 * height * sum_over_row<D>(dp, support, height, [&](double r) {
                        return scale * Kernel::gradient_factor(r, 1.0 / support);
                    });
            }
        return area;
    }
};

}  // namespace doseki
