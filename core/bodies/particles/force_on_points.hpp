#pragma once
#include <span>

#include "model/particles.hpp"

namespace doseki {

/// The force of the fluid on each particle of bodies of a kind, for the point that it is.
template <int D>
struct ForceOnPoint {
    const Particles<D>& particles;
    BodyKind kind;
    std::span<Vec<double, D>> force;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        if (particles.is_point_of(p, kind)) force[particles.point(p)] = particles.wall.force[p];
    }
};

}  // namespace doseki
