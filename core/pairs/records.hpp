#pragma once
#include <cstdint>
#include <limits>
#include <type_traits>

#include "base/array.hpp"
#include "base/vec.hpp"

namespace doseki {

/// Coordinates as the pair loop sees them. In double they are metres. In float they are 32-bit
/// fractions of the domain: differences of neighbours are exact before they become floats, so a
/// single-precision run loses nothing to the size of its domain.
template <class real>
using Coordinate = std::conditional_t<std::is_same_v<real, double>, double, std::int32_t>;

template <class real, int D>
struct CoordinateFrame {
    Vec<double, D> origin{};
    double unit = 1.0;  // metres per unit of a coordinate

    static CoordinateFrame covering(const Vec<double, D>& low, const Vec<double, D>& high) {
        CoordinateFrame frame;
        if constexpr (std::is_same_v<real, float>) {
            double extent = 0.0;
            for (int a = 0; a < D; ++a) extent = max(extent, high[a] - low[a]);
            frame.origin = low;
            // Twice the extent: neighbours may leave the box a little before the next sort.
            frame.unit = 2.0 * extent / std::numeric_limits<std::int32_t>::max();
        }
        return frame;
    }

    DOSEKI_DEVICE_FN Coordinate<real> coordinate(double x, int a) const {
        if constexpr (std::is_same_v<real, double>)
            return x;
        else
            return static_cast<std::int32_t>((x - origin[a]) / unit);
    }
};

/// Particle i or j of a pair over a number type T, as every term sees it.
template <class T, int D>
struct MotionPoint {
    Vec<T, D> v;
    T mass;
    T inverse_support;

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.v...), f(self.mass...), f(self.inverse_support...);
    }
};

/// The same in memory, at half a step from the state, with the position that the pair loop
/// subtracts.
template <class real, int D>
struct MotionRecord : MotionPoint<real, D> {
    std::array<Coordinate<real>, D> x;
};

/// A pair (i, j) with r_ij = x_i - x_j.
template <class T, int D>
struct Pair {
    Vec<T, D> r_ij;
    T r;
};

}  // namespace doseki
