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
    void add(const SurfacePoint<D>& point) {
        if (count_ < most) points_[count_++] = point;
    }
    std::size_t size() const { return count_; }
    bool empty() const { return count_ == 0; }
    const SurfacePoint<D>& operator[](std::size_t k) const { return points_[k]; }
    const SurfacePoint<D>* begin() const { return points_.data(); }
    const SurfacePoint<D>* end() const { return points_.data() + count_; }

private:
    std::array<SurfacePoint<D>, most> points_{};
    std::size_t count_ = 0;
};

/// A surface that contact points of bodies may touch, in its own frame: the outline of a convex
/// body, a mesh of triangles, the ground. All that contacts ask of it is here. Answers depend on
/// the arguments alone, whatever thread asks.
template <int D>
class ContactSurface {
public:
    virtual ~ContactSurface() = default;

    /// Of a ball about the origin that holds the surface [m]; infinite where none does.
    virtual double radius() const = 0;

    /// How many places a ball may touch at once: 1 of what is convex or smooth, at most
    /// SurfacePoints::most of what has hollows.
    virtual std::size_t most_touched() const { return 1; }

    /// The places that a ball of this radius about x touches: those where the distance of x is
    /// below it. In a hollow each of its sides is one, and no two of them lie on one convex part. A
    /// point (radius 0) touches where it is inside, one place at most.
    virtual SurfacePoints<D> touched_by(const Vec<double, D>& x, double radius) const = 0;

    /// Whether there is any such place.
    virtual bool is_touched_by(const Vec<double, D>& x, double radius) const {
        return !touched_by(x, radius).empty();
    }
};

}  // namespace doseki
