#pragma once
// Forces where two bodies touch, eqs. (42) to (50). Numbers are those of the pair: m*, R*, E* of
// eq. (43).

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vec.hpp"

namespace doseki {

/// Restitution of the linear spring and dashpot of damping ratio zeta, when it parts as soon as the
/// force would pull (eq. 46; Schwager & Poeschel, Granular Matter 9 (2007)).
inline double restitution_of(double zeta) {
    if (zeta < 1.0 - 1e-9) {
        const double w = std::sqrt(1.0 - zeta * zeta);  // over that of the spring alone
        return std::exp(-zeta / w *
                        (std::numbers::pi - std::atan2(2.0 * zeta * w, w * w - zeta * zeta)));
    }
    if (zeta <= 1.0 + 1e-9) return std::exp(-2.0);
    const double w = std::sqrt(zeta * zeta - 1.0);
    return std::exp(-zeta / w * std::log((zeta + w) / (zeta - w)));
}

/// Normal spring of a pair at its overlap: force and tangent stiffness.
struct NormalSpring {
    double force, stiffness;
};

/// Hertz, eqs. (44) and (45).
DOSEKI_DEVICE_FN inline NormalSpring hertz_spring(double E, double R, double overlap) {
    const double root = std::sqrt(R * overlap);
    return {4.0 / 3.0 * E * root * overlap, 2.0 * E * root};
}

DOSEKI_DEVICE_FN inline NormalSpring linear_spring(double k, double overlap) {
    return {k * overlap, k};
}

/// Eq. (44), never tension: bodies do not stick. `approach` is the speed at which they come nearer.
DOSEKI_DEVICE_FN inline double normal_force(const NormalSpring& spring, double damping,
                                            double approach) {
    return std::max(0.0, spring.force + damping * approach);
}

/// Eq. (45); that of Tsuji et al. (1992) keeps the restitution of a Hertz contact
/// independent of speed.
DOSEKI_DEVICE_FN inline double contact_damping(bool hertz, double zeta, double stiffness,
                                               double mass) {
    return (hertz ? 2.0 * std::sqrt(5.0 / 6.0) : 2.0) * zeta * std::sqrt(stiffness * mass);
}

/// A spring that slides at a limit: friction (eq. 49), and the resistance to rolling (eq. 50).
/// `stretch` is carried from step to step; it is cut to what the limit can hold.
template <int D>
DOSEKI_DEVICE_FN Vec<double, D> sliding_spring(Vec<double, D>& stretch, const Vec<double, D>& speed,
                                               double dt, double stiffness, double damping,
                                               double limit) {
    stretch = stretch + dt * speed;
    Vec<double, D> force = -stiffness * stretch - damping * speed;
    const double size = std::sqrt(dot(force, force));
    if (size > limit) {
        force = (limit > 0.0 ? limit / size : 0.0) * force;
        stretch = (-1.0 / stiffness) * (force + damping * speed);
        const double held = std::sqrt(dot(stretch, stretch)), longest = limit / stiffness;
        if (held > longest) stretch = (longest / held) * stretch;
    }
    return force;
}

/// Restitution of a Hertz spring with that dashpot, which depends on neither speed nor stiffness;
/// from the motion itself, x'' = -F(x, x') with x'(0) = 1.
inline double restitution_of_hertz(double zeta) {
    constexpr double E = 0.75, dt = 1e-3;  // F = x^(3/2)
    auto pull = [zeta](double x, double v) {
        const NormalSpring spring = hertz_spring(E, 1.0, x);
        return -(spring.force + contact_damping(true, zeta, spring.stiffness, 1.0) * v);
    };
    double x = 0.5 * dt, v = 1.0;  // drift, kick, drift
    for (int n = 0; n < 20000 && x > 0.0; ++n) {
        const double half = v + 0.5 * dt * pull(x, v), a = pull(x, half);
        if (a > 0.0) break;  // it would pull
        v += dt * a, x += dt * v;
    }
    return std::max(0.0, -v);
}

/// The damping ratio that gives a restitution in (0, 1].
inline double damping_ratio(double restitution, bool hertz = false) {
    double low = 0.0, high = hertz ? 3.0 : 1e3;
    for (int k = 0; k < (hertz ? 40 : 200); ++k) {
        const double middle = 0.5 * (low + high);
        ((hertz ? restitution_of_hertz(middle) : restitution_of(middle)) > restitution ? low
                                                                                       : high) =
            middle;
    }
    return low;
}

/// Largest overlap and duration of a collision without damping, for a speed of approach.
struct CollisionEstimate {
    double overlap, time;
};

inline CollisionEstimate linear_collision(double k, double mass, double speed) {
    const double root = std::sqrt(mass / k);
    return {speed * root, std::numbers::pi * root};
}

/// Eq. (48).
inline CollisionEstimate hertz_collision(double E, double R, double mass, double speed) {
    const double overlap = std::pow(15.0 / 16.0 * mass * speed * speed / (E * std::sqrt(R)), 0.4);
    return {overlap, 2.9432751 * overlap / speed};
}

}  // namespace doseki
