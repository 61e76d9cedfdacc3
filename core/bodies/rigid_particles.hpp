#pragma once
#include <algorithm>
#include <cmath>

#include "base/array.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "bodies/rigid_bodies.hpp"
#include "model/domain.hpp"
#include "model/particles.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// The particles of rigid bodies, which the fluid meets as it meets a wall: they bring the force of
/// the fluid to the bodies and go where these are.
template <int D>
class RigidParticles {
public:
    /// Makes particle p, where it is now and with the normal that it has, a point of body k.
    void bind(Particles<D>& particles, std::size_t p, const RigidBodies<D>& bodies, std::size_t k,
              const Domain<D>& domain) {
        const RigidBodyState<D>& state = bodies.state(k);
        const Mat<double, 3> R = state.orientation.matrix();
        particles.set_point(p, BodyKind::rigid, points_.size());
        points_.push_back(
            {static_cast<double>(k),
             rotated_back(R, nearest_image(domain, particles.position[p] - state.centre)),
             rotated_back(R, particles.wall.normal[p]), rotated_back(R, particles.wall.area[p])});
    }
    /// Adds a point of a body that is not turned, and returns its number.
    std::size_t add(std::size_t body, const Vec<double, D>& offset, const Vec<double, D>& normal) {
        points_.push_back({static_cast<double>(body), offset, normal, {}});
        return points_.size() - 1;
    }
    bool has(const Particles<D>& particles, std::size_t p) const {
        return particles.is_point_of(p, BodyKind::rigid);
    }
    /// Index of the body of particle p; -1: none.
    std::int32_t body_of(const Particles<D>& particles, std::size_t p) const {
        return has(particles, p) ? static_cast<std::int32_t>(point_of(particles, p).index()) : -1;
    }

    /// Hands the force of the fluid on to the bodies. All ranks have all bodies: each point is a
    /// particle of one of them, so that the sums are those of one rank, to the bit.
    void gather(const Particles<D>& particles, RigidBodies<D>& bodies, const Ranks& ranks) const;
    /// Puts particles where their bodies are (eq. 53); returns the largest distance that one went.
    double place(Particles<D>& particles, const RigidBodies<D>& bodies,
                 const Domain<D>& domain) const;
    /// Gives particles the velocity that they have when the fluid will have acted for `ahead` more.
    void set_velocities(Particles<D>& particles, const RigidBodies<D>& bodies, double ahead) const;

    void serialise(Archive& archive) { archive("body_points", points_); }
    std::size_t size() const { return points_.size(); }
    /// Throws std::invalid_argument unless the points are those of so many bodies.
    void expect_points_of(std::size_t bodies) const {
        for (const RigidBodyPoint<D>& point : points_)
            expect_fit(point.body >= 0.0 && point.body < static_cast<double>(bodies),
                       "body_points");
    }

private:
    const RigidBodyPoint<D>& point_of(const Particles<D>& particles, std::size_t p) const {
        return points_[particles.point(p)];
    }

    Array<RigidBodyPoint<D>> points_;
};

template <int D>
void RigidParticles<D>::gather(const Particles<D>& particles, RigidBodies<D>& bodies,
                               const Ranks& ranks) const {
    Array<Vec<double, D>> force(points_.size());
    for_each_particle(particles.size(), [&](std::size_t p) {
        if (has(particles, p)) force[particles.point(p)] = particles.wall.force[p];
    });
    ranks.sum(numbers_of(force));
    for (std::size_t k = 0; k < bodies.size(); ++k)
        bodies.state(k).flow_force = {}, bodies.state(k).flow_torque = {};
    const auto R = bodies.rotations();
    for (std::size_t q = 0; q < points_.size(); ++q) {
        const std::size_t k = points_[q].index();
        RigidBodyState<D>& state = bodies.state(k);
        state.flow_force = state.flow_force + force[q];
        state.flow_torque = state.flow_torque +
                            cross(in_space(rotated(R[k], points_[q].offset)), in_space(force[q]));
    }
}

template <int D>
double RigidParticles<D>::place(Particles<D>& particles, const RigidBodies<D>& bodies,
                                const Domain<D>& domain) const {
    const auto R = bodies.rotations();
    const auto w = bodies.spins(0.0);
    auto move = [&](std::size_t p) {
        if (!has(particles, p)) return 0.0;
        const RigidBodyPoint<D>& point = point_of(particles, p);
        const std::size_t k = point.index();
        const RigidBodyState<D>& state = bodies.state(k);
        const Vec<double, D> lever = rotated(R[k], point.offset);
        const Vec<double, D> step =
            nearest_image(domain, state.centre + lever - particles.position[p]);
        particles.position[p] = particles.position[p] + step;
        particles.wall.normal[p] = rotated(R[k], point.normal);
        particles.wall.area[p] = rotated(R[k], point.area);
        particles.acceleration[p] = state.acceleration + turning_velocity(state.spin_rate, lever) +
                                    turning_velocity(w[k], turning_velocity(w[k], lever));
        return dot(step, step);
    };
    return std::sqrt(reduce(particles.size(), 0.0, maximum, move));
}

template <int D>
void RigidParticles<D>::set_velocities(Particles<D>& particles, const RigidBodies<D>& bodies,
                                       double ahead) const {
    const auto R = bodies.rotations();
    const auto w = bodies.spins(ahead);
    for_each_particle(particles.size(), [&](std::size_t p) {
        if (!has(particles, p)) return;
        const RigidBodyPoint<D>& point = point_of(particles, p);
        const std::size_t k = point.index();
        const RigidBodyState<D>& state = bodies.state(k);
        particles.velocity[p] = state.velocity + (ahead / bodies.body(k).mass) * state.flow_force +
                                turning_velocity(w[k], rotated(R[k], point.offset));
    });
}

// Compiled once: bodies.cpp.
extern template class RigidParticles<2>;
extern template class RigidParticles<3>;

}  // namespace doseki
