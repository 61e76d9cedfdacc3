#pragma once
#include <array>
#include <cstddef>

#include "bodies/rotation.hpp"

namespace doseki {

/// Signed distance and normal of a surface, as seen from a point.
template <int D>
struct SurfacePoint {
    double distance;        // of the point, negative inside [m]
    Vec<double, D> normal;  // unit vector out of what the surface encloses
};

/// The few places of a surface that one ball touches, the nearest first.
template <int D>
class SurfacePoints {
public:
    static constexpr std::size_t most = 4;

    /// Beyond `most` nothing is added.
    DOSEKI_DEVICE_FN void add(const SurfacePoint<D>& point) {
        if (count_ < most) points_[count_++] = point;
    }
    DOSEKI_DEVICE_FN std::size_t size() const { return count_; }
    DOSEKI_DEVICE_FN bool empty() const { return count_ == 0; }
    DOSEKI_DEVICE_FN const SurfacePoint<D>& operator[](std::size_t k) const { return points_[k]; }
    DOSEKI_DEVICE_FN const SurfacePoint<D>* begin() const { return points_.data(); }
    DOSEKI_DEVICE_FN const SurfacePoint<D>* end() const { return points_.data() + count_; }

private:
    std::array<SurfacePoint<D>, most> points_{};
    std::size_t count_ = 0;
};

}  // namespace doseki
