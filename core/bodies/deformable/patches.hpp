#pragma once
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "base/matrix.hpp"
#include "bodies/rotation.hpp"

namespace doseki {

/// Points of a body next to each other. A point alone has no spin and takes no moment; a patch has
/// the spin of the rigid motion nearest to that of its points, and takes a moment as the forces
/// whose power is the moment times that spin.
template <int D>
class Patch {
public:
    explicit Patch(Array<std::uint32_t> points) : points_(std::move(points)) {}

    /// Of velocities v at positions x, both of all points [1/s].
    Vec3 spin(std::span<const Vec<double, D>> x, std::span<const Vec<double, D>> v) const {
        const Vec<double, D> middle = centre(x);
        Vec3 momentum{};
        for (const std::uint32_t p : points_)
            momentum = momentum + cross(in_space(x[p] - middle), in_space(v[p]));
        return inverse_inertia(x, middle) * momentum;
    }

    /// Adds forces of this moment and no sum to those of all points.
    void add_moment(const Vec3& moment, std::span<const Vec<double, D>> x,
                    std::span<Vec<double, D>> force) const {
        const Vec<double, D> middle = centre(x);
        const Vec3 turn = inverse_inertia(x, middle) * moment;
        for (const std::uint32_t p : points_)
            force[p] = force[p] + turning_velocity(turn, x[p] - middle);
    }

private:
    Vec<double, D> centre(std::span<const Vec<double, D>> x) const {
        Vec<double, D> sum{};
        for (const std::uint32_t p : points_) sum = sum + x[p];
        return (1.0 / static_cast<double>(points_.size())) * sum;
    }
    /// Of points of mass 1 about their centre; zero where they do not span the space.
    Mat<double, 3> inverse_inertia(std::span<const Vec<double, D>> x,
                                   const Vec<double, D>& middle) const {
        Mat<double, 3> inertia{};
        for (const std::uint32_t p : points_) {
            const Vec3 r = in_space(x[p] - middle);
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b)
                    inertia(a, b) += (a == b ? dot(r, r) : 0.0) - r[a] * r[b];
        }
        return inverse(inertia, 0.0);
    }

    Array<std::uint32_t> points_;
};

}  // namespace doseki
