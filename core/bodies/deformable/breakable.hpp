#pragma once
// Bodies that are rigid until something strikes them: how their points begin to move on their own,
// and how they stop.

#include "bodies/deformable/advance.hpp"
#include "bodies/elastic/advance_bonds.hpp"
#include "bodies/fragments/rigid_motion.hpp"

namespace doseki {

/// Eq. (140).
template <int D>
void TotalLagrangian<D>::make_deformable(std::size_t body, const RigidPlacement<D>& placement) {
    const Array<std::uint32_t> points = points_of(body);
    for (const std::uint32_t p : points)
        x[p] = placement.centre +
               rotated(placement.turn, rest_position(p) + held_shape_[p] - placement.rest_centre);
    const RigidMotion<D> still = rigid_motion<D>(*this, points);
    const Vec3 own =
        placement.angular_momentum +
        still.mass * cross(in_space(placement.centre - still.centre), in_space(placement.velocity));
    const Vec3 spin = inverse(still.inertia, 0.0) * own;
    for (const std::uint32_t p : points) {
        v[p] = placement.velocity + turning_velocity(spin, x[p] - still.centre);
        a[p] = load[p] = steady[p] = {};
    }
    rigid_[body] = 0, held_energy_[body] = 0.0;
    choose_stepped();
    for (const std::uint32_t p : points) acted_[p].x = x[p];
    find_acted();
}

/// The shape is held in the frame at rest, Eq. (141).
template <int D>
void TotalLagrangian<D>::make_rigid(std::size_t body, const RigidMotion<D>& motion,
                                    double kinetic) {
    const Array<std::uint32_t> points = points_of(body);
    const Mat<double, 3> turn = motion.orientation.matrix();
    const ElasticEnergy before = elastic_energy();
    const double moved = kinetic_energy();
    for (const std::uint32_t p : points) {
        held_shape_[p] =
            rotated_back(turn, x[p] - motion.centre) - (rest_position(p) - motion.rest_centre);
        v[p] = a[p] = {};
    }
    rigid_[body] = 1;
    bonds_.stop(points);
    choose_stepped();
    const ElasticEnergy after = elastic_energy();
    held_energy_[body] = before.sum() - after.sum();
    damping_work_ += moved - kinetic_energy() - kinetic;
}

template <int D>
double TotalLagrangian<D>::take_out(std::size_t body) {
    const Array<std::uint32_t> points = points_of(body);
    const ElasticEnergy before = elastic_energy();
    for (const std::uint32_t p : points) v[p] = a[p] = {};
    rigid_[body] = left;
    choose_stepped();
    return before.sum() - elastic_energy().sum();
}

template <int D>
bool TotalLagrangian<D>::is_clamped(std::size_t body) const {
    return std::ranges::any_of(points_of(body), [this](std::uint32_t p) { return clamped(p); });
}

template <int D>
double TotalLagrangian<D>::strength(std::size_t body) const {
    auto point = [this](std::size_t p) { return bond_point(p); };
    auto of = [this](std::size_t p) -> const DeformableBody& { return body_of(p); };
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t p : points_of(body)) least = min(least, bonds_.strength(p, point, of));
    return least;
}

template <int D>
double TotalLagrangian<D>::least_intactness(std::size_t body) const {
    auto is_of_it = [&](std::uint32_t j) {
        return !gone(j) && body_[j] == static_cast<std::int32_t>(body);
    };
    double least = 1.0;
    for (const std::uint32_t p : points_of(body))
        least = min(least, bonds_.least_intactness(p, is_of_it));
    return least;
}

/// Where the point of a particle is now, however often its body has changed since it was bound.
/// Points that are gone are deformable ones, from where dust takes them: see bind_dust.
template <int D>
void DeformableBodies<D>::rebind(Particles<D>& particles, std::size_t p,
                                 const Array<std::int32_t>& of_rigid) const {
    std::size_t k = particles.point(p);
    if (!has(particles, p)) {
        if (!particles.is_point_of(p, BodyKind::rigid) || k >= of_rigid.size() || of_rigid[k] < 0)
            return;
        k = static_cast<std::size_t>(of_rigid[k]);
    }
    if (!solids_.gone(k) && solids_.is_rigid(static_cast<std::size_t>(solids_.body(k))))
        particles.set_point(p, BodyKind::rigid, static_cast<std::size_t>(rigid_point_[k]));
    else
        particles.set_point(p, BodyKind::deformable, k);
    particles.wall.depth[p] = faces_.depth[k], particles.wall.face[p] = faces_.face[k];
}

}  // namespace doseki
