#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "bodies/elastic/principal.hpp"
#include "bodies/fragments/rigid_motion.hpp"

namespace doseki {

/// What the fluid does to a free deformable body beyond the mean, and beyond what moves it as a
/// whole: forces without a sum and a moment, Eq. (173). As kicks they would ring a body that swings
/// by itself within few steps, so that they act through a step.
template <int D>
class SuddenForces {
public:
    SuddenForces(const TotalLagrangian<D>& solids, std::span<const Vec<double, D>> force)
        : solids_(solids), force_(force) {}

    /// Sets those of the points of each body that swings within some steps `dt`.
    void split(double dt, std::span<Vec<double, D>> sudden) const {
        std::fill(sudden.begin(), sudden.end(), Vec<double, D>{});
        for (const Array<std::uint32_t>& points : stepped_points(solids_)) {
            if (points.empty() || is_held(points)) continue;
            const RigidMotion<D> motion = rigid_motion<D>(solids_, points);
            if (dt * swing(motion, solids_.body_of(points.front())) > least_swing)
                split(points, motion, sudden);
        }
    }

private:
    static constexpr double least_swing = 0.3;  // angle in a step: twenty steps to a period
    static constexpr double steady = 0.05;      // of the mean; less than that may kick

    bool is_held(const Array<std::uint32_t>& points) const {
        return std::ranges::any_of(points, [this](std::uint32_t p) { return solids_.clamped(p); });
    }

    /// Of the first bending of a free bar of the body's moments of inertia: 22.4 sqrt(E I/(rho A))
    /// / L^2 [rad/s].
    static double swing(const RigidMotion<D>& motion, const DeformableBody& body) {
        const double trace = motion.inertia(0, 0) + motion.inertia(1, 1) + motion.inertia(2, 2);
        Sym<double, D> moments, others;
        double size = 0.0;
        for (int a = 0; a < D; ++a)
            for (int b = a; b < D; ++b) {
                moments(a, b) = ((a == b ? 0.5 * trace : 0.0) - motion.inertia(a, b)) / motion.mass;
                others(a, b) = -moments(a, b);
                size += a == b ? moments(a, b) : 0.0;
            }
        for (int a = 0; a < D; ++a) others(a, a) += size;
        const double longest = largest_principal(moments).value,
                     thinnest = size - largest_principal(others).value;
        if (!(thinnest > 0.0)) return 0.0;
        const double sound = std::sqrt(body.young_modulus() / body.rho0);
        return 22.4 / 12.0 * sound * std::sqrt(thinnest) / longest;
    }

    void split(const Array<std::uint32_t>& points, const RigidMotion<D>& motion,
               std::span<Vec<double, D>> sudden) const {
        Vec<double, D> sum{};
        Vec3 moment{};
        for (const std::uint32_t p : points) {
            sudden[p] = force_[p] - solids_.steady[p], sum = sum + sudden[p];
            moment = moment + cross(arm(motion, p), in_space(sudden[p]));
        }
        const Vec<double, D> pull = (1.0 / motion.mass) * sum;
        const Vec3 turn = inverse(motion.inertia, 0.0) * moment;
        double changes = 0.0, mean = 0.0;
        for (const std::uint32_t p : points) {
            const double m = solids_.mass(p);
            const Vec<double, D> along = turning_velocity(turn, solids_.x[p] - motion.centre);
            sudden[p] = sudden[p] - m * (pull + along);
            changes += dot(sudden[p], sudden[p]) / m;
            mean += dot(solids_.steady[p], solids_.steady[p]) / m;
        }
        const double share = changes > 0.0 ? 1.0 - steady * std::sqrt(mean / changes) : 0.0;
        for (const std::uint32_t p : points) sudden[p] = std::max(0.0, share) * sudden[p];
    }

    Vec3 arm(const RigidMotion<D>& motion, std::uint32_t p) const {
        return in_space(solids_.x[p] - motion.centre);
    }

    const TotalLagrangian<D>& solids_;
    std::span<const Vec<double, D>> force_;
};

}  // namespace doseki
