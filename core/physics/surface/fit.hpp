#pragma once
// A smooth surface through vertices that know their normals, Eqs. (166) and (167). Places in its
// tangent plane are in reaches of the weight.

#include "base/matrix.hpp"
#include "base/vec.hpp"
#include "physics/kernel/wendland_c2.hpp"

namespace doseki {

/// Weight of a vertex for which some area stands, at the root of `square` from a place, Eq. (166).
DOSEKI_DEVICE_FN inline double weight_on_surface(double area, double square) {
    return square < 1.0 ? area * WendlandC2<2>::value(std::sqrt(square), 1.0) : 0.0;
}

/// Weights theta (constant + slope . t) that are exact for what is linear in the plane, Eq. (166).
struct LinearWeights {
    double constant = 0.0;
    Vec<double, 3> slope{};

    DOSEKI_DEVICE_FN double at(double theta, const Vec<double, 3>& t) const {
        return theta * (constant + dot(slope, t));
    }
};

/// How the vertices around a place lie in its plane.
struct SurfaceMoments {
    double weight = 0.0;
    Vec<double, 3> first{};
    Sym<double, 3> second{};

    DOSEKI_DEVICE_FN void add(double theta, const Vec<double, 3>& t) {
        weight += theta, first = first + theta * t;
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) second(a, b) += theta * t[a] * t[b];
    }
    /// From the place to the middle of the vertices: nothing inside a surface, some 0.21 on its
    /// straight rim.
    DOSEKI_DEVICE_FN Vec<double, 3> middle() const { return (1.0 / weight) * first; }
    /// n: normal of the plane. Without a slope where the vertices do not span it.
    DOSEKI_DEVICE_FN LinearWeights weights(const Vec<double, 3>& n) const {
        constexpr double least_determinant = 1e-5;
        const Vec<double, 3> m = middle();
        Mat<double, 3> spread{};
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                spread(a, b) = second(a, b) / weight - m[a] * m[b] + n[a] * n[b];
        const Vec<double, 3> slope = inverse(spread, least_determinant) * m;
        return {(1.0 + dot(slope, m)) / weight, (-1.0 / weight) * slope};
    }
};

/// Means over the vertices around a place, with the weights of Eq. (166).
struct SurfaceMeans {
    Vec<double, 3> place{}, normal{};  // from the place; of the vertices
    double depth = 0.0;                // of the place below the planes of the vertices

    DOSEKI_DEVICE_FN void add(double weight, const Vec<double, 3>& r, const Vec<double, 3>& n) {
        place = place + weight * r, normal = normal + weight * n, depth += weight * dot(n, r);
    }
    /// How deep the place lies below the surface, whose normal there is n, Eq. (167): halfway
    /// between the planes of the vertices and that of the place, which is exact on every sphere and
    /// to the third order elsewhere.
    DOSEKI_DEVICE_FN double depth_below(const Vec<double, 3>& n) const {
        return 0.5 * (depth + dot(n, place));
    }
};

}  // namespace doseki
