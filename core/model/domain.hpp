#pragma once
#include <array>
#include <cmath>

#include "base/vec.hpp"

namespace doseki {

/// A box with periodic directions; positions are wrapped into it at each sort.
template <int D>
struct Domain {
    Vec<double, D> low{}, high{};
    std::array<bool, D> periodic{};

    DOSEKI_DEVICE_FN double length(int a) const { return high[a] - low[a]; }
    bool any_periodic() const {
        for (bool p : periodic)
            if (p) return true;
        return false;
    }
};

/// Of the periodic images of r the one nearest to `place`.
template <int D>
DOSEKI_DEVICE_FN Vec<double, D> image_near(const Domain<D>& domain, Vec<double, D> r,
                                           const Vec<double, D>& place) {
    for (int c = 0; c < D; ++c)
        if (domain.periodic[c])
            r[c] -= domain.length(c) * std::round((r[c] - place[c]) / domain.length(c));
    return r;
}

/// The shortest vector to any periodic image.
template <int D>
DOSEKI_DEVICE_FN Vec<double, D> nearest_image(const Domain<D>& domain, const Vec<double, D>& r) {
    return image_near(domain, r, {});
}

/// The image inside the domain.
template <int D>
DOSEKI_DEVICE_FN Vec<double, D> wrapped(const Domain<D>& domain, Vec<double, D> x) {
    for (int c = 0; c < D; ++c)
        if (domain.periodic[c])
            x[c] -= domain.length(c) * std::floor((x[c] - domain.low[c]) / domain.length(c));
    return x;
}

}  // namespace doseki
