#pragma once
#include <cmath>

#include "model/domain.hpp"

namespace doseki {

/// The shortest vector to any periodic image.
template <int D>
Vec<double, D> nearest_image(const Domain<D>& domain, Vec<double, D> r) {
    for (int c = 0; c < D; ++c)
        if (domain.periodic[c]) r[c] -= domain.length(c) * std::round(r[c] / domain.length(c));
    return r;
}

}  // namespace doseki
