#pragma once
#include "records.hpp"

namespace doseki {

/// What the sums of the resolved scheme need of a fluid particle beside its motion.
template <int D>
struct FluidRecord {
    std::array<double, D> pressure_gradient;
    std::array<double, Sym<double, D>::size> strain;  // symmetric part of the velocity gradient
    double volume, rest_volume;                       // m/rho, m/rho0
    double rho, p;
    double mu;       // molecular and eddy viscosity [Pa s]
    double surface;  // of the last step, see SurfaceMeasure
};

/// What they need of a wall particle.
template <int D>
struct WallRecord {
    std::array<double, D> normal;    // into the fluid
    std::array<double, D> traction;  // force of a rough bed on a fluid particle over V_i W
    double volume;
    double depth;     // below the surface of the wall [m]
    double g_normal;  // see wall_excess_pressure
    double stick;     // 1: no slip, 0: the wall pass has the friction
};

template <class T, int D>
struct FluidPoint {
    Vec<T, D> v, pressure_gradient;
    Sym<T, D> strain;
    T volume, rest_volume, rho, p, mu, surface;
};

template <class T, int D>
struct WallPoint {
    Vec<T, D> v, normal, traction;
    T volume, depth, g_normal, stick;
};

/// `get(k -> value of record k)` makes a T of a member: of one record, or lane by lane.
template <class T, int D, class Get>
DOSEKI_FN FluidPoint<T, D> fluid_point(const MotionRecord<double, D>* motion,
                                       const FluidRecord<D>* fluid, const Get& get) {
    FluidPoint<T, D> point;
    for (int a = 0; a < D; ++a) {
        point.v[a] = get([=](std::uint32_t p) { return motion[p].v[a]; });
        point.pressure_gradient[a] =
            get([=](std::uint32_t p) { return fluid[p].pressure_gradient[a]; });
    }
    for (int k = 0; k < Sym<T, D>::size; ++k)
        point.strain.element[k] = get([=](std::uint32_t p) { return fluid[p].strain[k]; });
    point.volume = get([=](std::uint32_t p) { return fluid[p].volume; });
    point.rest_volume = get([=](std::uint32_t p) { return fluid[p].rest_volume; });
    point.rho = get([=](std::uint32_t p) { return fluid[p].rho; });
    point.p = get([=](std::uint32_t p) { return fluid[p].p; });
    point.mu = get([=](std::uint32_t p) { return fluid[p].mu; });
    point.surface = get([=](std::uint32_t p) { return fluid[p].surface; });
    return point;
}

/// `first`: index of the first wall particle, whose record is the first of `wall`.
template <class T, int D, class Get>
DOSEKI_FN WallPoint<T, D> wall_point(const MotionRecord<double, D>* motion,
                                     const WallRecord<D>* wall, std::uint32_t first,
                                     const Get& get) {
    WallPoint<T, D> point;
    for (int a = 0; a < D; ++a) {
        point.v[a] = get([=](std::uint32_t p) { return motion[p].v[a]; });
        point.normal[a] = get([=](std::uint32_t p) { return wall[p - first].normal[a]; });
        point.traction[a] = get([=](std::uint32_t p) { return wall[p - first].traction[a]; });
    }
    point.volume = get([=](std::uint32_t p) { return wall[p - first].volume; });
    point.depth = get([=](std::uint32_t p) { return wall[p - first].depth; });
    point.g_normal = get([=](std::uint32_t p) { return wall[p - first].g_normal; });
    point.stick = get([=](std::uint32_t p) { return wall[p - first].stick; });
    return point;
}

}  // namespace doseki
