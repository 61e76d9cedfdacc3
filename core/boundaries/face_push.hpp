#pragma once
#include <algorithm>

#include "base/vec.hpp"

namespace doseki {

/// The plane of a face, with the flow in front of it.
template <int D>
struct FacePlane {
    Vec<double, D> origin{}, normal{};  // a point of it; the unit normal, into the flow

    double depth(const Vec<double, D>& x) const { return -dot(x - origin, normal); }
};

/// What fluid particles give to a wall particle against the normal of a face [N], 2-D: [N/m].
template <int D>
struct FacePush {
    double all = 0.0, front = 0.0;  // of all fluid; of that in front of the plane
    Vec<double, D> lever{};         // sum of the latter times the way to that fluid

    /// From the wall particle to the middle of what pushes it, along the direction e.
    double way(const Vec<double, D>& e, double farthest) const {
        return front == 0.0 ? 0.0 : std::clamp(dot(lever, e) / front, -farthest, farthest);
    }
};

}  // namespace doseki
