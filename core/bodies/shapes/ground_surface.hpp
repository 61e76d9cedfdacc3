#pragma once
#include <limits>
#include <memory>
#include <utility>

#include "bodies/contact_surface.hpp"
#include "boundaries/height_field.hpp"

namespace doseki {

/// The ground of a terrain, as bodies touch it.
template <int D>
class GroundSurface final : public ContactSurface<D> {
public:
    explicit GroundSurface(std::shared_ptr<const HeightField<D>> field)
        : field_(std::move(field)) {}

    double radius() const override { return std::numeric_limits<double>::infinity(); }

    SurfacePoints<D> touched_by(const Vec<double, D>& x, double radius) const override {
        SurfacePoints<D> points;
        const auto found = field_->nearest(x);
        if (found.distance < radius) points.add({found.distance, found.normal});
        return points;
    }

private:
    std::shared_ptr<const HeightField<D>> field_;
};

}  // namespace doseki
