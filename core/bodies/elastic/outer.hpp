#pragma once
#include "base/matrix.hpp"

namespace doseki {

/// Adds a multiple of u (x) v.
template <int D>
void add_outer(Mat<double, D>& sum, double factor, const Vec<double, D>& u,
               const Vec<double, D>& v) {
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) sum(a, b) += factor * u[a] * v[b];
}

}  // namespace doseki
