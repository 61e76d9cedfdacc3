#pragma once
#include <limits>
#include <memory>
#include <utility>

#include "bodies/shapes/surface_points.hpp"
#include "boundaries/height_field.hpp"

namespace doseki {

/// The ground of a terrain, as bodies touch it.
template <int D>
class GroundSurface {
public:
    static constexpr std::size_t most_touched = 1;

    /// The field lies where a device reaches it.
    explicit GroundSurface(std::shared_ptr<const HeightField<D>> field)
        : owner_(std::move(field)), field_(owner_.get()) {}

    DOSEKI_DEVICE_FN double radius() const { return std::numeric_limits<double>::infinity(); }

    DOSEKI_DEVICE_FN SurfacePoints<D> touched_by(const Vec<double, D>& x, double radius,
                                                 const Vec<double, D>& = {}) const {
        SurfacePoints<D> points;
        const auto found = field_->nearest(x);
        if (found.distance < radius) points.add({found.distance, found.normal});
        return points;
    }
    DOSEKI_DEVICE_FN bool is_touched_by(const Vec<double, D>& x, double radius) const {
        return !touched_by(x, radius).empty();
    }

private:
    std::shared_ptr<const HeightField<D>> owner_;
    const HeightField<D>* field_;
};

}  // namespace doseki
