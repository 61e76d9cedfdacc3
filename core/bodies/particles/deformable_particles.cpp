// The particles of deformable bodies, where all particles are.

#include "base/bulk.hpp"
#include "bodies/deformable/deformable_bodies.hpp"
#include "physics/wall.hpp"

namespace doseki {
namespace {

/// The square of how far a particle went. While a body deforms it has no edges: water that strikes
/// these would shake the points there.
template <int D>
struct PlaceShown {
    Particles<D>& particles;
    std::span<const ShownPoint<D>> points;
    Domain<D> domain;
    double dt;

    DOSEKI_DEVICE_FN double operator()(std::size_t p) const {
        if (!particles.is_point_of(p, BodyKind::deformable)) return 0.0;
        const ShownPoint<D>& point = points[particles.point(p)];
        const Vec<double, D> step = nearest_image(domain, point.place - particles.position[p]);
        particles.position[p] = particles.position[p] + step;
        particles.wall.bend[p] =
            turned_bend(particles.wall.bend[p], particles.wall.normal[p], point.normal);
        particles.wall.normal[p] = point.normal, particles.wall.depth[p] = point.depth;
        particles.wall.area[p] = point.area, particles.wall.edge_normals[p] = {};
        particles.acceleration[p] = point.acceleration;
        if (dt > 0.0) particles.velocity[p] = (1.0 / dt) * step;
        return dot(step, step);
    }
};

template <int D>
struct MoveShown {
    Particles<D>& particles;
    std::span<const ShownPoint<D>> points;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        if (particles.is_point_of(p, BodyKind::deformable))
            particles.velocity[p] = points[particles.point(p)].velocity;
    }
};

}  // namespace

template <int D>
void DeformableBodies<D>::gather(const Particles<D>& particles, const Ranks& ranks) {
    if (!any_deforms()) return;
    flow_.assign(size(), {});
    bulk::for_each(particles.size(), FlowOnPoints<D>{particles, BodyKind::deformable, flow_});
    ranks.sum(numbers_of(flow_));
    for_each_particle(size(), [&](std::size_t k) { flow_force_[k] = flow_[k].force; });
    if (have_faces()) wet();
    find_sudden_forces();
}

template <int D>
void DeformableBodies<D>::wet() {
    Array<Unwetted> found;
    for (const double before : unwetted_) found.push_back(Unwetted(before));
    auto of = [&](std::uint32_t k) -> Unwetted& {
        return found[static_cast<std::size_t>(solids_.body(k))];
    };
    const Array<std::uint32_t>& points = solids_.stepped().points();
    for (const std::uint32_t k : points) of(k).press(flow_[k].pressure);
    for (const std::uint32_t k : points) {
        const Vec<double, D>& area = faces_.area[k];
        of(k).see(dot(area, area), flow_[k].wetted, flow_[k].pressure);
    }
    for (std::size_t body = 0; body < found.size(); ++body) unwetted_[body] = found[body].now();
}

template <int D>
double DeformableBodies<D>::place(Particles<D>& particles, const Domain<D>& domain, double dt) {
    if (empty()) return 0.0;
    shown_.resize(size());
    solids_.stepped().for_each([&](std::size_t k) {
        ShownPoint<D>& point = shown_[k];
        point.place = solids_.x[k], point.normal = normal(k), point.depth = faces_.depth[k];
        point.area = seen_area(k);
        point.acceleration = acceleration_[k];
    });
    const PlaceShown<D> place{particles, shown_, domain, dt};
    return std::sqrt(bulk::reduce(particles.size(), 0.0, maximum, place));
}

template <int D>
void DeformableBodies<D>::set_velocities(Particles<D>& particles, double ahead) {
    if (empty()) return;
    shown_.resize(size());
    solids_.stepped().for_each([&](std::size_t k) {
        shown_[k].velocity = solids_.clamped(k) ? Vec<double, D>{}
                                                : solids_.v[k] + (ahead / solids_.mass(k)) *
                                                                     (flow_force_[k] - sudden_[k]);
    });
    bulk::for_each(particles.size(), MoveShown<D>{particles, shown_});
}

template void DeformableBodies<2>::gather(const Particles<2>&, const Ranks&);
template void DeformableBodies<2>::wet();
template double DeformableBodies<2>::place(Particles<2>&, const Domain<2>&, double);
template void DeformableBodies<2>::set_velocities(Particles<2>&, double);
template void DeformableBodies<3>::gather(const Particles<3>&, const Ranks&);
template void DeformableBodies<3>::wet();
template double DeformableBodies<3>::place(Particles<3>&, const Domain<3>&, double);
template void DeformableBodies<3>::set_velocities(Particles<3>&, double);

}  // namespace doseki
