#pragma once
#include <cmath>
#include <numbers>

#include "base/matrix.hpp"

namespace doseki {

/// Largest eigenvalue of a symmetric matrix and its direction, of length 1.
template <int D>
struct Principal {
    double value;
    Vec<double, D> direction;
};

inline Principal<2> largest_principal(const Sym<double, 2>& s) {
    const double mean = 0.5 * (s(0, 0) + s(1, 1)), half = 0.5 * (s(0, 0) - s(1, 1));
    const double radius = std::hypot(half, s(0, 1));
    const double angle = radius > 0.0 ? 0.5 * std::atan2(s(0, 1), half) : 0.0;
    return {mean + radius, {{std::cos(angle), std::sin(angle)}}};
}

/// The eigenvalues are cosines of a third of an angle (Smith, Commun. ACM 4, 1961); the direction
/// is normal to two columns of s - value.
inline Principal<3> largest_principal(const Sym<double, 3>& s) {
    const double mean = (s(0, 0) + s(1, 1) + s(2, 2)) / 3.0;
    Mat<double, 3> rest = full(s);
    for (int a = 0; a < 3; ++a) rest(a, a) -= mean;
    double square = 0.0;
    for (const double element : rest.element) square += element * element;
    const double size = std::sqrt(square / 6.0);
    if (!(size > 0.0)) return {mean, {{1.0, 0.0, 0.0}}};
    const double half = 0.5 * determinant(rest) / (size * size * size);
    const double value = 2.0 * size * std::cos(std::acos(min(max(half, -1.0), 1.0)) / 3.0);
    for (int a = 0; a < 3; ++a) rest(a, a) -= value;
    const Mat<double, 3> normals = cofactors(rest);  // rows: products of two rows of `rest`
    Vec<double, 3> best{{1.0, 0.0, 0.0}};
    double longest = 0.0;
    for (int a = 0; a < 3; ++a) {
        const Vec<double, 3> row{{normals(a, 0), normals(a, 1), normals(a, 2)}};
        if (dot(row, row) > longest) longest = dot(row, row), best = row;
    }
    return {mean + value, longest > 0.0 ? (1.0 / std::sqrt(longest)) * best : best};
}

}  // namespace doseki
