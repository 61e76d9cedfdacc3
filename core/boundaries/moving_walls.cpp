// The particles of walls that move, where all particles are.

#include "boundaries/moving_walls.hpp"

#include "base/bulk.hpp"
#include "base/matrix.hpp"
#include "physics/wall.hpp"

namespace doseki {
namespace {

/// From t to t + dt, with the velocity of the way; the square of how far a particle went.
template <int D>
struct MoveWall {
    Particles<D>& particles;
    MotionsOfBodies<D> motions;
    double t, dt;

    DOSEKI_DEVICE_FN double operator()(std::size_t p) const {
        const WallMotion<D>* motion = motions.of(particles.tag[p]);
        if (!motion || !motion->moves(t)) return 0.0;
        const Vec<double, D> step =
            motion->moved(particles.position[p], t, dt) - particles.position[p];
        for (int a = 0; a < D; ++a) particles.position[p][a] += step[a];
        particles.velocity[p] = (1.0 / dt) * step;
        if (particles.wall.in_use) turn_normals(p, *motion);
        return dot(step, step);
    }

private:
    struct Turned {
        const WallMotion<D>& motion;
        double dt;
        DOSEKI_DEVICE_FN Vec<double, D> operator()(const Vec<double, D>& face) const {
            return face + motion.turning(face, dt);
        }
    };
    DOSEKI_DEVICE_FN void turn_normals(std::size_t p, const WallMotion<D>& motion) const {
        const Turned turned{motion, dt};
        Vec<double, D>& normal = particles.wall.normal[p];
        const Vec<double, D> now = turned(normal);
        particles.wall.bend[p] = turned_bend(particles.wall.bend[p], normal, now);
        normal = now;
        particles.wall.spin[p] = motion.turn_at(t);
        particles.wall.edge_normals[p] = each_row(particles.wall.edge_normals[p], turned);
    }
};

template <int D>
struct VelocityOfWall {
    Particles<D>& particles;
    MotionsOfBodies<D> motions;
    double t;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        const WallMotion<D>* motion = motions.of(particles.tag[p]);
        if (!motion) return;
        particles.velocity[p] = motion->velocity_at(particles.position[p], t);
        particles.acceleration[p] = motion->acceleration_at(particles.position[p], t);
        if (particles.wall.in_use) particles.wall.spin[p] = motion->turn_at(t);
    }
};

}  // namespace

template <int D>
double MovingWalls<D>::move(Particles<D>& particles, double t, double dt) const {
    if (!any_moves(t)) return 0.0;
    const MoveWall<D> move{particles, motions(), t, dt};
    return std::sqrt(bulk::reduce(particles.size(), 0.0, maximum, move));
}

template <int D>
void MovingWalls<D>::set_velocities(Particles<D>& particles, double t) const {
    if (motions_.empty()) return;
    bulk::for_each(particles.size(), VelocityOfWall<D>{particles, motions(), t});
}

template class MovingWalls<2>;
template class MovingWalls<3>;

}  // namespace doseki
