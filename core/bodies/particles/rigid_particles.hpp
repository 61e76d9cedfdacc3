#pragma once
#include <numeric>

#include "base/array.hpp"
#include "base/error.hpp"
#include "base/matrix.hpp"
#include "bodies/loads/flow_on_points.hpp"
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
        auto back = [&R](const Vec<double, D>& v) { return rotated_back(R, v); };
        particles.set_point(p, BodyKind::rigid, points_.size());
        points_.push_back({static_cast<double>(k),
                           back(nearest_image(domain, particles.position[p] - state.centre)),
                           back(particles.wall.normal[p]), back(particles.wall.area[p]),
                           each_row(particles.wall.edge_normals[p], back)});
    }
    /// Adds a point of a body that is not turned, and returns its number.
    std::size_t add(std::size_t body, const Vec<double, D>& offset, const Vec<double, D>& normal,
                    const Vec<double, D>& area = {}, const Mat<double, D>& edge_normals = {}) {
        points_.push_back({static_cast<double>(body), offset, normal, area, edge_normals});
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
    void gather(const Particles<D>& particles, RigidBodies<D>& bodies, const Ranks& ranks);
    /// Calls f(body, point, force) for the points on which the fluid pushed when gather() was last
    /// called.
    template <class F>
    void for_each_push(const F& f) const {
        for (std::size_t q = 0; q < flow_.size(); ++q)
            if (const Vec<double, D>& force = flow_[q].force; dot(force, force) > 0.0)
                f(points_[q].index(), points_[q], force);
    }
    /// Puts particles where their bodies are (eq. 53), with the velocity that has taken them there
    /// in `dt`; returns the largest distance that one went.
    double place(Particles<D>& particles, const RigidBodies<D>& bodies, const Domain<D>& domain,
                 double dt) const;
    /// Gives them the velocity that they have when the fluid will have acted for `ahead` more.
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
    void sort_by_body(std::size_t bodies);

    Array<RigidBodyPoint<D>> points_;
    Array<FlowOnPoint<D>> flow_;
    Array<std::size_t> of_body_, first_of_body_;  // points by body, in rising order
};

template <int D>
void RigidParticles<D>::sort_by_body(std::size_t bodies) {
    if (of_body_.size() == points_.size() && first_of_body_.size() == bodies + 1) return;
    first_of_body_.assign(bodies + 1, 0), of_body_.resize(points_.size());
    for (const RigidBodyPoint<D>& point : points_) ++first_of_body_[point.index() + 1];
    std::partial_sum(first_of_body_.begin(), first_of_body_.end(), first_of_body_.begin());
    Array<std::size_t> next = first_of_body_;
    for (std::size_t q = 0; q < points_.size(); ++q) of_body_[next[points_[q].index()]++] = q;
}

// Compiled once: rigid_particles.cpp.
extern template class RigidParticles<2>;
extern template class RigidParticles<3>;

}  // namespace doseki
