#pragma once
#include <cmath>

#include "base/vec.hpp"

namespace doseki {

using Vec3 = Vec<double, 3>;

/// A vector of the plane as one of space, and back. Spins and torques are always vectors of space.
template <int D>
DOSEKI_FN Vec3 in_space(const Vec<double, D>& u) {
    Vec3 v;
    for (int a = 0; a < D; ++a) v[a] = u[a];
    return v;
}
template <int D>
DOSEKI_FN Vec<double, D> in_run(const Vec3& u) {
    Vec<double, D> v;
    for (int a = 0; a < D; ++a) v[a] = u[a];
    return v;
}

/// A turn of the run as one of space, and back.
template <int D>
DOSEKI_FN Vec3 about_axes(const Turn<double, D>& turn) {
    if constexpr (D == 3) return turn;
    Vec3 axis;
    axis[2] = turn[0];
    return axis;
}
template <int D>
DOSEKI_FN Turn<double, D> turn_of(const Vec3& axis) {
    if constexpr (D == 3) return axis;
    Turn<double, D> turn;
    turn[0] = axis[2];
    return turn;
}

DOSEKI_FN Vec3 cross(const Vec3& u, const Vec3& v) { return turned_by<double, 3>(u, v); }

/// spin x r, both ends in the space of the run.
template <int D>
DOSEKI_FN Vec<double, D> turning_velocity(const Vec3& spin, const Vec<double, D>& r) {
    return in_run<D>(cross(spin, in_space(r)));
}

template <int D>
DOSEKI_FN double norm(const Vec<double, D>& u) {
    return std::sqrt(dot(u, u));
}

/// Unit quaternion (w, x, y, z): the orientation of a body.
struct Quaternion {
    double w = 1.0, x = 0.0, y = 0.0, z = 0.0;

    /// What it becomes when the body turns by the vector `angle` (axis times angle, fixed axes).
    DOSEKI_DEVICE_FN Quaternion turned(const Vec3& angle) const {
        const double full = norm(angle);
        if (full == 0.0) return *this;
        const double s = std::sin(0.5 * full) / full, c = std::cos(0.5 * full);
        const Quaternion t{c, s * angle[0], s * angle[1], s * angle[2]};
        Quaternion q{t.w * w - t.x * x - t.y * y - t.z * z, t.w * x + t.x * w + t.y * z - t.z * y,
                     t.w * y - t.x * z + t.y * w + t.z * x, t.w * z + t.x * y - t.y * x + t.z * w};
        const double scale = 1.0 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        q.w *= scale, q.x *= scale, q.y *= scale, q.z *= scale;
        return q;
    }

    /// This turn after another.
    Quaternion after(const Quaternion& q) const {
        return {w * q.w - x * q.x - y * q.y - z * q.z, w * q.x + x * q.w + y * q.z - z * q.y,
                w * q.y - x * q.z + y * q.w + z * q.x, w * q.z + x * q.y - y * q.x + z * q.w};
    }

    DOSEKI_DEVICE_FN Mat<double, 3> matrix() const {
        Mat<double, 3> R;
        R(0, 0) = 1 - 2 * (y * y + z * z), R(0, 1) = 2 * (x * y - w * z),
             R(0, 2) = 2 * (x * z + w * y);
        R(1, 0) = 2 * (x * y + w * z), R(1, 1) = 1 - 2 * (x * x + z * z),
             R(1, 2) = 2 * (y * z - w * x);
        R(2, 0) = 2 * (x * z - w * y), R(2, 1) = 2 * (y * z + w * x),
             R(2, 2) = 1 - 2 * (x * x + y * y);
        return R;
    }
};

/// The leading D x D block of R (or of its transpose) times u.
template <int D>
DOSEKI_FN Vec<double, D> rotated(const Mat<double, 3>& R, const Vec<double, D>& u) {
    Vec<double, D> v;
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) v[a] += R(a, b) * u[b];
    return v;
}
template <int D>
DOSEKI_FN Vec<double, D> rotated_back(const Mat<double, 3>& R, const Vec<double, D>& u) {
    Vec<double, D> v;
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) v[a] += R(b, a) * u[b];
    return v;
}

}  // namespace doseki
