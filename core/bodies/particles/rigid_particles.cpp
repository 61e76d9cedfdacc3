// The particles of rigid bodies, where all particles are.

#include "bodies/particles/rigid_particles.hpp"

#include "base/bulk.hpp"
#include "physics/wall.hpp"

namespace doseki {
namespace {

/// How bodies stand and move, as their particles see it.
template <int D>
struct Bearing {
    Mat<double, 3> rotation;
    Vec<double, D> centre, velocity, acceleration;
    Vec3 spin, spin_ahead, spin_rate;
    double wetted;  // share of its area
};

template <int D>
struct FindBearing {
    RigidBodiesSeen<D> rigid;
    std::span<Bearing<D>> found;
    double ahead;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        const RigidBodyState<D>& state = rigid.states[k];
        found[k] = {state.orientation.matrix(),
                    state.centre,
                    rigid.velocity(k, ahead),
                    state.acceleration,
                    rigid.spin(k),
                    rigid.spin(k, ahead),
                    state.spin_rate,
                    1.0 - state.unwetted};
    }
};

/// `velocity` and `spin_ahead` are those when the fluid will have acted for `ahead` more.
template <int D>
Array<Bearing<D>> bearings(const RigidBodies<D>& bodies, double ahead) {
    Array<Bearing<D>> found(bodies.size());
    bulk::for_each(bodies.size(), FindBearing<D>{bodies.seen(), found, ahead});
    return found;
}

/// A particle, if it is one of a rigid body: its point, and how its body stands.
template <int D>
struct BoundParticles {
    Particles<D>& particles;
    std::span<const RigidBodyPoint<D>> points;
    std::span<const Bearing<D>> bearing;

    DOSEKI_DEVICE_FN bool has(std::size_t p) const {
        return particles.is_point_of(p, BodyKind::rigid);
    }
    DOSEKI_DEVICE_FN const RigidBodyPoint<D>& point(std::size_t p) const {
        return points[particles.point(p)];
    }
};

/// Eq. (53); the square of how far a particle went.
template <int D>
struct PlaceBound {
    BoundParticles<D> bound;
    Domain<D> domain;
    double dt;

    DOSEKI_DEVICE_FN double operator()(std::size_t p) const {
        if (!bound.has(p)) return 0.0;
        Particles<D>& particles = bound.particles;
        const RigidBodyPoint<D>& point = bound.point(p);
        const Bearing<D>& body = bound.bearing[point.index()];
        const Mat<double, 3>& R = body.rotation;
        const Vec<double, D> lever = rotated(R, point.offset);
        const Vec<double, D> step =
            nearest_image(domain, body.centre + lever - particles.position[p]);
        particles.position[p] = particles.position[p] + step;
        const Vec<double, D> normal = rotated(R, point.normal);
        particles.wall.bend[p] =
            turned_bend(particles.wall.bend[p], particles.wall.normal[p], normal);
        particles.wall.normal[p] = normal;
        particles.wall.area[p] = body.wetted * rotated(R, point.area);
        particles.wall.edge_normals[p] = each_row(point.edge_normals, RotatedBy{R});
        particles.acceleration[p] = body.acceleration + turning_velocity(body.spin_rate, lever) +
                                    turning_velocity(body.spin, turning_velocity(body.spin, lever));
        if (dt > 0.0) particles.velocity[p] = (1.0 / dt) * step;
        particles.wall.spin[p] = turn_of<D>(body.spin);
        return dot(step, step);
    }

private:
    struct RotatedBy {
        const Mat<double, 3>& R;
        DOSEKI_DEVICE_FN Vec<double, D> operator()(const Vec<double, D>& n) const {
            return rotated(R, n);
        }
    };
};

template <int D>
struct MoveBound {
    BoundParticles<D> bound;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        if (!bound.has(p)) return;
        const RigidBodyPoint<D>& point = bound.point(p);
        const Bearing<D>& body = bound.bearing[point.index()];
        bound.particles.velocity[p] =
            body.velocity + turning_velocity(body.spin_ahead, rotated(body.rotation, point.offset));
        bound.particles.wall.spin[p] = turn_of<D>(body.spin_ahead);
    }
};

/// The sum over the points of a body, in rising order, whatever threads there are.
template <int D>
struct SumOfBody {
    std::span<const std::size_t> first, order;
    std::span<const RigidBodyPoint<D>> points;
    std::span<const FlowOnPoint<D>> flow;
    std::span<RigidBodyState<D>> states;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        RigidBodyState<D>& state = states[k];
        const Mat<double, 3> rotation = state.orientation.matrix();
        Vec<double, D> sum{};
        Vec3 moment{};
        for (std::size_t n = first[k]; n < first[k + 1]; ++n) {
            const FlowOnPoint<D>& push = flow[order[n]];
            const Vec<double, D> lever = rotated(rotation, points[order[n]].offset);
            sum = sum + push.force;
            moment =
                moment + cross(in_space(lever), in_space(push.force)) + about_axes<D>(push.moment);
        }
        state.flow_force = sum, state.flow_torque = moment;
        wet(k);
    }

private:
    DOSEKI_DEVICE_FN void wet(std::size_t k) const {
        Unwetted unwetted(states[k].unwetted);
        for (std::size_t n = first[k]; n < first[k + 1]; ++n)
            unwetted.press(flow[order[n]].pressure);
        for (std::size_t n = first[k]; n < first[k + 1]; ++n) {
            const Vec<double, D>& area = points[order[n]].area;
            unwetted.see(dot(area, area), flow[order[n]].wetted, flow[order[n]].pressure);
        }
        states[k].unwetted = unwetted.now();
    }
};

}  // namespace

template <int D>
void RigidParticles<D>::gather(const Particles<D>& particles, RigidBodies<D>& bodies,
                               const Ranks& ranks) {
    flow_.assign(points_.size(), {});
    bulk::for_each(particles.size(), FlowOnPoints<D>{particles, BodyKind::rigid, flow_});
    ranks.sum(numbers_of(flow_));
    sort_by_body(bodies.size());
    bulk::for_each(bodies.size(),
                   SumOfBody<D>{first_of_body_, of_body_, points_, flow_, bodies.moved().states});
}

template <int D>
double RigidParticles<D>::place(Particles<D>& particles, const RigidBodies<D>& bodies,
                                const Domain<D>& domain, double dt) const {
    const Array<Bearing<D>> bearing = bearings(bodies, 0.0);
    const PlaceBound<D> place{{particles, points_, bearing}, domain, dt};
    return std::sqrt(bulk::reduce(particles.size(), 0.0, maximum, place));
}

template <int D>
void RigidParticles<D>::set_velocities(Particles<D>& particles, const RigidBodies<D>& bodies,
                                       double ahead) const {
    const Array<Bearing<D>> bearing = bearings(bodies, ahead);
    bulk::for_each(particles.size(), MoveBound<D>{{particles, points_, bearing}});
}

template class RigidParticles<2>;
template class RigidParticles<3>;

}  // namespace doseki
