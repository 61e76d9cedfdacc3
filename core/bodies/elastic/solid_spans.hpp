#pragma once
#include <cmath>
#include <span>

#include "base/matrix.hpp"
#include "bodies/elastic/elastic_law.hpp"
#include "bodies/elastic/interactions.hpp"
#include "physics/hyperelastic/strain.hpp"

namespace doseki {

/// The points of deformable bodies, as loops over them refer to them; see TotalLagrangian.
template <int D>
struct SolidSpans {
    std::span<const DeformableBody> bodies;
    std::span<const std::int32_t> body;
    std::span<const std::uint8_t> clamped;
    std::span<const Mat<double, D>> correction;
    std::span<Mat<double, D>> deformation;
    std::span<MotionRecord<double, D>> motion;
    std::span<ElasticPlaceRecord<D>> place;
    std::span<ElasticRecord<D>> solid;
    std::span<Vec<double, D>> x, v, a, damping_force;
    std::span<const Vec<double, D>> load, steady;

    DOSEKI_DEVICE_FN const DeformableBody& body_of(std::size_t p) const {
        return bodies[static_cast<std::size_t>(body[p])];
    }
    DOSEKI_DEVICE_FN double volume(std::size_t p) const { return std::pow(body_of(p).spacing, D); }
    DOSEKI_DEVICE_FN double mass(std::size_t p) const { return body_of(p).rho0 * volume(p); }

    /// Places, and velocities predicted half_dt ahead, as the sums see them.
    DOSEKI_DEVICE_FN void predict(std::size_t p, double half_dt) const {
        place[p].x = x[p];
        motion[p].v = v[p] + half_dt * a[p];
    }
    /// Between the sums: strain and stress of one point, as the second sum needs them.
    DOSEKI_DEVICE_FN void update(std::size_t p,
                                 const DeformationAccumulators<double, D>& sums) const;
    /// The damper sees misfits from a frame that turns with them: rigid motions do no work in it,
    /// and its torque vanishes.
    DOSEKI_DEVICE_FN void damp_springs(std::size_t p, const MisfitMoments<double, D>& sums) const {
        ElasticRecord<D>& point = solid[p];
        const Mat<double, D> spin = misfit_spin(sums), rate = point.F_rate - spin * point.F;
        point.Q = less_springs(point.Q, point.kappa_rate, rate);
        point.Q_damping = less_springs(point.Q_damping, point.kappa_rate, rate);
        point.spin = point.kappa_rate * spin;
    }
    /// `force`: per volume at rest.
    DOSEKI_DEVICE_FN void accelerate(std::size_t p, const InternalForce<double, D>& force,
                                     const Vec<double, D>& gravity) const {
        damping_force[p] = place[p].volume * force.damping;
        if (clamped[p])
            a[p] = {};
        else
            a[p] = (1.0 / body_of(p).rho0) * force.all + (1.0 / mass(p)) * (load[p] + steady[p]) +
                   gravity;
    }
};

template <int D>
DOSEKI_DEVICE_FN void SolidSpans<D>::update(std::size_t p,
                                            const DeformationAccumulators<double, D>& sums) const {
    const DeformableBody& own = body_of(p);
    const Mat<double, D>& B = correction[p];
    deformation[p] = sums.place * B;
    const Mat<double, D> rate = sums.velocity * B;
    const Mat<double, D> damping = kelvin_voigt(deformation[p], rate, own.viscosity());
    const Mat<double, D> P = own.stress(deformation[p]) + damping;
    solid[p].Q_damping = damping * transposed(B);
    solid[p].Q = less_springs(P * transposed(B), solid[p].kappa, deformation[p]);
    solid[p].F = deformation[p], solid[p].F_rate = rate;
}

}  // namespace doseki
