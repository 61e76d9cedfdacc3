#pragma once
#include <cmath>
#include <numbers>

#include "base/matrix.hpp"

namespace doseki {

/// Largest eigenvalue of a symmetric matrix and its direction, of length 1: of several, which
/// differ by no more than rounding, the one nearest to another vector, so that rounding has no say
/// in it.
template <int D>
struct Principal {
    double value;
    Vec<double, D> direction;
};

inline constexpr double same_eigenvalues = 1e-6;  // difference over their size

inline Principal<2> largest_principal(const Sym<double, 2>& s, const Vec<double, 2>& near = {}) {
    const double mean = 0.5 * (s(0, 0) + s(1, 1)), half = 0.5 * (s(0, 0) - s(1, 1));
    const double radius = std::hypot(half, s(0, 1));
    if (radius <= same_eigenvalues * std::abs(mean) && dot(near, near) > 0.0)
        return {mean + radius, (1.0 / std::sqrt(dot(near, near))) * near};
    const double angle = radius > 0.0 ? 0.5 * std::atan2(s(0, 1), half) : 0.0;
    return {mean + radius, {{std::cos(angle), std::sin(angle)}}};
}

/// The longest row.
inline Vec<double, 3> longest_row(const Mat<double, 3>& m) {
    Vec<double, 3> best{};
    for (int a = 0; a < 3; ++a) {
        const Vec<double, 3> row{{m(a, 0), m(a, 1), m(a, 2)}};
        if (dot(row, row) > dot(best, best)) best = row;
    }
    return best;
}

/// The eigenvalues are cosines of a third of an angle (Smith, Commun. ACM 4, 1961); the direction
/// is normal to two columns of s - value, or to the only one where two eigenvalues are the largest.
inline Principal<3> largest_principal(const Sym<double, 3>& s, const Vec<double, 3>& near = {}) {
    const double mean = (s(0, 0) + s(1, 1) + s(2, 2)) / 3.0;
    Mat<double, 3> rest = full(s);
    for (int a = 0; a < 3; ++a) rest(a, a) -= mean;
    double square = 0.0;
    for (const double element : rest.element) square += element * element;
    const double size = std::sqrt(square / 6.0);
    Vec<double, 3> direction = near;
    double value = 0.0;
    if (size > same_eigenvalues * std::abs(mean)) {
        const double half = 0.5 * determinant(rest) / (size * size * size);
        const double third = std::acos(min(max(half, -1.0), 1.0)) / 3.0;
        value = 2.0 * size * std::cos(third);
        for (int a = 0; a < 3; ++a) rest(a, a) -= value;
        if (std::numbers::pi / 3.0 - third > same_eigenvalues) {
            direction = longest_row(cofactors(rest));  // rows: products of two rows of `rest`
        } else {
            const Vec<double, 3> other = longest_row(rest);
            direction = near - (dot(near, other) / dot(other, other)) * other;
        }
    }
    const double length = std::sqrt(dot(direction, direction));
    if (!(length > 0.0)) return {mean + value, {{1.0, 0.0, 0.0}}};
    return {mean + value, (1.0 / length) * direction};
}

}  // namespace doseki
