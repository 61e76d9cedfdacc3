// Steps of deformable bodies, where all particles are.

#include "bodies/deformable/internal_forces.hpp"

namespace doseki {
namespace {

/// The square of its speed.
template <int D>
struct DriftPoint {
    SolidSpans<D> solids;
    std::span<const std::uint32_t> which;
    double dt;

    DOSEKI_DEVICE_FN double operator()(std::size_t n) const {
        const std::uint32_t p = which[n];
        solids.x[p] = solids.x[p] + dt * solids.v[p];
        return dot(solids.v[p], solids.v[p]);
    }
};

template <int D>
struct PushPointBy {
    SolidSpans<D> solids;
    std::span<const std::uint32_t> which;
    std::span<const Vec<double, D>> force;
    double dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        const std::uint32_t p = which[n];
        if (!solids.clamped[p]) solids.v[p] = solids.v[p] + (dt / solids.mass(p)) * force[p];
    }
};

template <int D>
struct FollowForce {
    std::span<Vec<double, D>> steady;
    std::span<const std::uint32_t> which;
    std::span<const Vec<double, D>> force;
    double share;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        Vec<double, D>& mean = steady[which[n]];
        const bool is_first = !(dot(mean, mean) > 0.0);
        mean = mean + (is_first ? 1.0 : share) * (force[which[n]] - mean);
    }
};

/// On the way that is gone in a step.
template <int D>
struct WorkOfDamping {
    SolidSpans<D> solids;
    std::span<const std::uint32_t> which;
    double dt;

    DOSEKI_DEVICE_FN double operator()(std::size_t n) const {
        const std::uint32_t p = which[n];
        return dot(solids.damping_force[p], dt * solids.v[p] + (0.5 * dt * dt) * solids.a[p]);
    }
};

/// What load and gravity gave.
template <int D>
struct PushPoint {
    SolidSpans<D> solids;
    std::span<const std::uint32_t> which;
    Vec<double, D> gravity;
    double dt;

    DOSEKI_DEVICE_FN BodyStep<D> operator()(std::size_t n) const {
        const std::uint32_t p = which[n];
        const Vec<double, D> way = dt * solids.v[p] + (0.5 * dt * dt) * solids.a[p];
        solids.v[p] = solids.v[p] + dt * solids.a[p];
        if (solids.clamped[p]) return {};
        const Vec<double, D> weight = (solids.body_of(p).rho0 * solids.place[p].volume) * gravity;
        return {dt * (solids.load[p] + weight), dot(weight, way), dot(solids.load[p], way), 0.0};
    }
};

}  // namespace

template <int D>
void TotalLagrangian<D>::push_by(std::span<const Vec<double, D>> force, double dt) {
    const std::span<const std::uint32_t> which = stepped_.points();
    bulk::for_each(which.size(), PushPointBy<D>{spans(), which, force, dt});
}

template <int D>
void TotalLagrangian<D>::follow(std::span<const Vec<double, D>> force, double share) {
    const std::span<const std::uint32_t> which = stepped_.points();
    bulk::for_each(which.size(), FollowForce<D>{steady, which, force, share});
}

template <int D>
double TotalLagrangian<D>::drift(double dt) {
    const std::span<const std::uint32_t> which = stepped_.points();
    return dt * sqrt(bulk::reduce(which.size(), 0.0, maximum, DriftPoint<D>{spans(), which, dt}));
}

/// Of bodies without bonds, see sum_internal_forces.
template <int D>
template <class F>
void TotalLagrangian<D>::sum_whole_forces(double half_dt, const F& take) {
    using Where = WhereParticlesAre;
    predict<Where>(half_dt);
    sum_over_pairs<Where>(DeformationTerm<D>{records()}, UpdatePoint<D>{spans()});
    if (springs_damp_) sum_over_pairs<Where>(SpringTerm<D>{records()}, DampSprings<D>{spans()});
    sum_over_pairs<Where>(InternalForceTerm<D>{records()}, take);
}

/// Damping sees the velocities that the last accelerations predict for the middle of the step; its
/// work is that of its force on the way that is gone.
template <int D>
BodyStep<D> TotalLagrangian<D>::push_points(double dt, const Vec<double, D>& gravity) {
    const std::span<const std::uint32_t> which = stepped_.points();
    damping_work_ -=
        bulk::reduce(which.size(), 0.0, std::plus<>(), WorkOfDamping<D>{spans(), which, dt});
    return bulk::reduce(which.size(), BodyStep<D>{}, std::plus<>(),
                        PushPoint<D>{spans(), which, gravity, dt});
}

template void TotalLagrangian<2>::push_by(std::span<const Vec<double, 2>>, double);
template void TotalLagrangian<3>::push_by(std::span<const Vec<double, 3>>, double);
template void TotalLagrangian<2>::follow(std::span<const Vec<double, 2>>, double);
template void TotalLagrangian<3>::follow(std::span<const Vec<double, 3>>, double);
template double TotalLagrangian<2>::drift(double);
template double TotalLagrangian<3>::drift(double);
template void TotalLagrangian<2>::sum_whole_forces(double, const AcceleratePoint<2>&);
template void TotalLagrangian<3>::sum_whole_forces(double, const AcceleratePoint<3>&);
template void TotalLagrangian<2>::sum_whole_forces(double, const InternalAcceleration<2>&);
template void TotalLagrangian<3>::sum_whole_forces(double, const InternalAcceleration<3>&);
template BodyStep<2> TotalLagrangian<2>::push_points(double, const Vec<double, 2>&);
template BodyStep<3> TotalLagrangian<3>::push_points(double, const Vec<double, 3>&);

}  // namespace doseki
