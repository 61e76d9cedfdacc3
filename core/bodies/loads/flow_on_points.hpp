#pragma once
#include <span>

#include "base/array.hpp"
#include "model/particles.hpp"

namespace doseki {

/// What the fluid does to a point of a body: force, its moment about the point, and what Eq. (152)
/// takes, the pressure and the share of its area that water sees.
template <int D>
struct FlowOnPoint {
    Vec<double, D> force{};
    Turn<double, D> moment{};
    double pressure = 0.0, wetted = 0.0;
};

/// As numbers, which ranks add up.
template <int D>
std::span<double> numbers_of(Array<FlowOnPoint<D>>& points) {
    static_assert(sizeof(FlowOnPoint<D>) % sizeof(double) == 0);
    if (points.empty()) return {};
    return {&points.data()->force[0], sizeof(FlowOnPoint<D>) / sizeof(double) * points.size()};
}

/// That on each particle of bodies of a kind, for the point that it is.
template <int D>
struct FlowOnPoints {
    const Particles<D>& particles;
    BodyKind kind;
    std::span<FlowOnPoint<D>> flow;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        const WallState<D>& wall = particles.wall;
        if (particles.is_point_of(p, kind))
            flow[particles.point(p)] = {wall.force[p], wall.moment[p], wall.pressure[p],
                                        wall.wetted[p]};
    }
};

/// Eq. (152): the share of its area that water around a body does not see. All points of the body
/// first tell how they are pressed, then what is seen of them. What is near the surface of the
/// water, or only splashed on, sees less of it for that reason.
class Unwetted {
public:
    DOSEKI_DEVICE_FN explicit Unwetted(double before) : before_(before) {}

    DOSEKI_DEVICE_FN void press(double pressure) { highest_ = max(highest_, pressure); }
    /// `square`: of the area of the point.
    DOSEKI_DEVICE_FN void see(double square, double wetted, double pressure) {
        const double share = (1.0 - before_) * wetted;
        all_ += square;
        if (share < least || !(pressure > deep * highest_)) return;
        seen_ += square * share, wet_ += square;
    }
    DOSEKI_DEVICE_FN double now() const {
        if (!(wet_ > 0.0)) return before_;
        const double share = 1.0 - before_;
        return max(-0.1, 1.0 - (share + wet_ / (wet_ + steps * all_) * (seen_ / wet_ - share)));
    }

private:
    static constexpr double deep = 0.5;    // of the highest pressure, that counts
    static constexpr double least = 0.6;   // of its area, that a point in water has
    static constexpr double steps = 10.0;  // over which the share goes to what is seen

    double before_, highest_ = 0.0, seen_ = 0.0, wet_ = 0.0, all_ = 0.0;
};

}  // namespace doseki
