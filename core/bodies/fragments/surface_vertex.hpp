#pragma once
#include <cstdint>

#include "base/vec.hpp"

namespace doseki {

/// A vertex of a surface: which point carries it along, and its place at rest from there.
template <int D>
struct SurfaceVertex {
    std::uint32_t point;
    Vec<double, D> offset;
    std::uint8_t crease;
    double radius = 0.0;      // 3-D: of the ball that it is [m]; 0: of a surface
    std::uint64_t key = 0;    // what it is, see VertexKey; 3-D: the point
    std::uint32_t curve = 0;  // 2-D: which of the closed curves of its body it is on
    // 3-D: normal at rest, and the area for which it stands, over the square of the spacing; 0: of
    // a ball.
    Vec<double, D> outward{};
    double share = 0.0;
};

}  // namespace doseki
