#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

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
    Vec<double, D> rest_centre{};
    Mat<double, 3> inertia{};  // about the centre
    Vec3 angular_momentum{};
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

/// That of the points of one body; zero where there are none.
template <int D>
RigidMotion<D> rigid_motion(const TotalLagrangian<D>& solids,
                            std::span<const std::uint32_t> points) {
    RigidMotion<D> motion;
    for (const std::uint32_t p : points) {
        const double m = solids.mass(p);
        motion.mass += m, motion.rest_centre = motion.rest_centre + m * solids.rest_position(p);
        motion.centre = motion.centre + m * solids.x[p];
        motion.velocity = motion.velocity + m * solids.v[p];
    }
    if (!(motion.mass > 0.0)) return motion;
    const double share = 1.0 / motion.mass;
    motion.centre = share * motion.centre, motion.rest_centre = share * motion.rest_centre;
    motion.velocity = share * motion.velocity;
    Mat<double, 3> turn{};
    for (const std::uint32_t p : points) {
        const double m = solids.mass(p);
        const Vec3 r = in_space(solids.x[p] - motion.centre),
                   R = in_space(solids.rest_position(p) - motion.rest_centre);
        motion.angular_momentum =
            motion.angular_momentum + m * cross(r, in_space(solids.v[p] - motion.velocity));
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                motion.inertia(i, j) += m * ((i == j ? dot(r, r) : 0.0) - r[i] * r[j]);
                turn(i, j) += m * r[i] * R[j];
            }
        motion.radius = std::max(motion.radius, norm(r) + 0.5 * solids.body_of(p).spacing);
    }
    motion.spin = inverse(motion.inertia, 0.0) * motion.angular_momentum;
    const double size = turn(0, 0) * turn(0, 0) + turn(1, 1) * turn(1, 1) +
                        turn(0, 1) * turn(0, 1) + turn(1, 0) * turn(1, 0);
    if (D == 2) turn(2, 2) = std::sqrt(size);
    if (determinant(turn) > 0.0) motion.orientation = quaternion_of(nearest_rotation(turn));
    return motion;
}

/// Points of all bodies that are not rigid.
template <int D>
Array<Array<std::uint32_t>> stepped_points(const TotalLagrangian<D>& solids) {
    Array<Array<std::uint32_t>> points(solids.bodies());
    for (const std::uint32_t p : solids.stepped().points())
        if (!solids.gone(p)) points[static_cast<std::size_t>(solids.body(p))].push_back(p);
    return points;
}

/// Motions of all bodies that are not rigid.
template <int D>
Array<RigidMotion<D>> rigid_motions(const TotalLagrangian<D>& solids) {
    Array<RigidMotion<D>> motions;
    for (const auto& of_body : stepped_points(solids))
        motions.push_back(rigid_motion<D>(solids, of_body));
    return motions;
}

}  // namespace doseki
