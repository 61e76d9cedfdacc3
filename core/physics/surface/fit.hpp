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

/// What a vertex has, summed with its weight alone and times where it lies.
template <class T>
struct LinearSums {
    T alone{}, times[3]{};

    DOSEKI_DEVICE_FN void add(double weight, const Vec<double, 3>& at, const T& value) {
        alone = alone + weight * value;
        for (int a = 0; a < 3; ++a) times[a] = times[a] + weight * at[a] * value;
    }
};

/// Weights theta (constant + slope . t) that are exact for what is linear in the plane, Eq. (166).
struct LinearWeights {
    double constant = 0.0;
    Vec<double, 3> slope{};

    DOSEKI_DEVICE_FN double at(double weight, const Vec<double, 3>& t) const {
        return weight * (constant + dot(slope, t));
    }
    template <class T>
    DOSEKI_DEVICE_FN T mean(const LinearSums<T>& sums) const {
        T mean = constant * sums.alone;
        for (int a = 0; a < 3; ++a) mean = mean + slope[a] * sums.times[a];
        return mean;
    }
};

/// Sums over the vertices around a place.
struct SurfaceSums {
    double weight = 0.0;
    Vec<double, 3> first{};
    Mat<double, 3> second{};
    LinearSums<Vec<double, 3>> place, normal;  // from the place; of the vertices
    LinearSums<double> depth;                  // of the place below the plane of each

    DOSEKI_DEVICE_FN void add(double theta, const Vec<double, 3>& t, const Vec<double, 3>& r,
                              const Vec<double, 3>& n) {
        weight += theta, first = first + theta * t;
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) second(a, b) += theta * t[a] * t[b];
        place.add(theta, t, r), normal.add(theta, t, n), depth.add(theta, t, dot(n, r));
    }
    /// From the place to the middle of the vertices: nothing inside a surface, some 0.21 on its
    /// straight rim.
    DOSEKI_DEVICE_FN Vec<double, 3> middle() const { return (1.0 / weight) * first; }
    /// n: normal of the plane. Means without a slope where the vertices do not span it.
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

/// How deep a place lies below the surface, Eq. (167): halfway between the planes of the vertices
/// and that of the place, which is exact on every sphere and to the third order elsewhere.
DOSEKI_DEVICE_FN inline double depth_below(const SurfaceSums& sums, const LinearWeights& weights,
                                           const Vec<double, 3>& n) {
    return 0.5 * (weights.mean(sums.depth) + dot(n, weights.mean(sums.place)));
}

}  // namespace doseki
