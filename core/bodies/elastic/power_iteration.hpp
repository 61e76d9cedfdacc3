#pragma once
#include <algorithm>
#include <cmath>

#include "base/array.hpp"
#include "base/vec.hpp"

namespace doseki {

/// Largest eigenvalue of -A for a linear map A of displacements, by power iteration from `mode`.
/// `apply(mode)` returns A mode; modes are scaled so that no vector is longer than `amplitude`.
template <int D, class Apply>
double largest_eigenvalue(Array<Vec<double, D>> mode, double amplitude, const Apply& apply) {
    constexpr int iterations = 60;
    double eigenvalue = 0.0;
    for (int n = 0; n < iterations; ++n) {
        double longest = 0.0;
        for (const auto& u : mode) longest = std::max(longest, std::sqrt(dot(u, u)));
        if (longest == 0.0) break;
        for (auto& u : mode) u = (amplitude / longest) * u;
        const Array<Vec<double, D>> image = apply(mode);
        double product = 0.0, square = 0.0;
        for (std::size_t p = 0; p < mode.size(); ++p)
            product -= dot(mode[p], image[p]), square += dot(mode[p], mode[p]);
        eigenvalue = product / square;
        mode = image;
    }
    return eigenvalue;
}

}  // namespace doseki
