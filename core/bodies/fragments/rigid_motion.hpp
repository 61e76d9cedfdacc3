#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/array.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "bodies/rotation.hpp"

namespace doseki {

/// A deformable body as if it were rigid: the motion with its momentum and angular momentum, Eq.
/// (124), and the turn nearest to its deformation.
template <int D>
struct RigidMotion {
    Vec<double, D> centre{}, velocity{};
    Vec3 spin{};
    Quaternion orientation;
    double mass = 0.0, radius = 0.0;  // radius of the ball around the centre
};

/// The quaternion of a rotation.
inline Quaternion quaternion_of(const Mat<double, 3>& R) {
    const double trace = R(0, 0) + R(1, 1) + R(2, 2);
    Vec<double, 4> q;  // squares of 2 w, 2 x, 2 y, 2 z
    q[0] = 1.0 + trace;
    for (int a = 0; a < 3; ++a) q[a + 1] = 1.0 + 2.0 * R(a, a) - trace;
    for (int a = 0; a < 4; ++a) q[a] = 0.5 * std::sqrt(std::max(0.0, q[a]));
    auto with_sign = [](double size, double sign) { return std::copysign(size, sign); };
    return {q[0], with_sign(q[1], R(2, 1) - R(1, 2)), with_sign(q[2], R(0, 2) - R(2, 0)),
            with_sign(q[3], R(1, 0) - R(0, 1))};
}

/// The rotation nearest to a matrix (Higham, SIAM J. Sci. Stat. Comput. 7, 1986).
inline Mat<double, 3> nearest_rotation(Mat<double, 3> m) {
    constexpr int steps = 30;
    for (int n = 0; n < steps; ++n) {
        const Mat<double, 3> inverted = transposed(inverse(m, 0.0));
        m = 0.5 * (m + inverted);
    }
    return m;
}

/// Those of all bodies.
template <int D>
Array<RigidMotion<D>> rigid_motions(const TotalLagrangian<D>& solids) {
    const std::size_t bodies = solids.bodies();
    Array<RigidMotion<D>> motions(bodies);
    Array<Vec<double, D>> rest(bodies);
    Array<Vec3> momentum(bodies);
    Array<Mat<double, 3>> inertia(bodies), turn(bodies);
    auto for_each_point = [&](auto&& f) {
        for (std::size_t p = 0; p < solids.size(); ++p)
            if (!solids.gone(p)) f(p, static_cast<std::size_t>(solids.body(p)), solids.mass(p));
    };
    for_each_point([&](std::size_t p, std::size_t b, double m) {
        RigidMotion<D>& motion = motions[b];
        motion.mass += m, rest[b] = rest[b] + m * solids.rest_position(p);
        motion.centre = motion.centre + m * solids.x[p];
        motion.velocity = motion.velocity + m * solids.v[p];
    });
    for (std::size_t b = 0; b < bodies; ++b) {
        const double share = motions[b].mass > 0.0 ? 1.0 / motions[b].mass : 0.0;
        motions[b].centre = share * motions[b].centre, rest[b] = share * rest[b];
        motions[b].velocity = share * motions[b].velocity;
    }
    for_each_point([&](std::size_t p, std::size_t b, double m) {
        RigidMotion<D>& motion = motions[b];
        const Vec3 r = in_space(solids.x[p] - motion.centre),
                   R = in_space(solids.rest_position(p) - rest[b]);
        momentum[b] = momentum[b] + m * cross(r, in_space(solids.v[p] - motion.velocity));
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                inertia[b](i, j) += m * ((i == j ? dot(r, r) : 0.0) - r[i] * r[j]);
                turn[b](i, j) += m * r[i] * R[j];
            }
        motion.radius = std::max(motion.radius, norm(r) + 0.5 * solids.body_of(p).spacing);
    });
    for (std::size_t b = 0; b < bodies; ++b) {
        if (!(motions[b].mass > 0.0)) continue;
        motions[b].spin = inverse(inertia[b], 0.0) * momentum[b];
        const double size = turn[b](0, 0) * turn[b](0, 0) + turn[b](1, 1) * turn[b](1, 1) +
                            turn[b](0, 1) * turn[b](0, 1) + turn[b](1, 0) * turn[b](1, 0);
        if (D == 2) turn[b](2, 2) = std::sqrt(size);
        if (determinant(turn[b]) > 0.0)
            motions[b].orientation = quaternion_of(nearest_rotation(turn[b]));
    }
    return motions;
}

}  // namespace doseki
