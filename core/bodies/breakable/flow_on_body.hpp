#pragma once
#include <algorithm>
#include <cmath>

#include "base/array.hpp"
#include "bodies/breakable/sections.hpp"

namespace doseki {

/// What the fluid does to a body that may break, while it is rigid, Eq. (181).
struct FlowOnBody {
    Array<PlacedForce> forces;
    double sum = 0.0;  // of the sizes of these forces [N], 2-D: [N/m]
    // Without the pressure that is the same all around: half of the sum, and the largest pressure
    // [Pa].
    double squeeze = 0.0, pressure = 0.0;

    /// `area` points outwards [m^2], 2-D: [m].
    void add(const PlacedForce& push, const Vec3& area) {
        forces.push_back(push), areas_.push_back(area);
        sum += norm(push.force);
        pressing_ -= dot(push.force, area), square_ += dot(area, area);
    }
    /// Call once all forces are in. A uniform pressure, found by least squares, pulls at nothing; a
    /// jet presses on one side alone. Points at corners have small areas, and no less force.
    void finish() {
        const double uniform = square_ > 0.0 ? pressing_ / square_ : 0.0;
        const double mean_area =
            forces.empty() ? 0.0 : std::sqrt(square_ / static_cast<double>(forces.size()));
        double beyond = 0.0;
        for (std::size_t k = 0; k < forces.size(); ++k) {
            const double force = norm(forces[k].force + uniform * areas_[k]),
                         area = std::max(mean_area, norm(areas_[k]));
            beyond += force;
            if (area > 0.0) pressure = std::max(pressure, force / area);
        }
        squeeze = 0.5 * std::min(sum, beyond);
    }

private:
    Array<Vec3> areas_;
    double pressing_ = 0.0, square_ = 0.0;
};

}  // namespace doseki
