#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "base/array.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "bodies/rigid_body.hpp"

namespace doseki {

/// A grain that a few points of a deformable body become, Eq. (123): a ball with their mass,
/// momentum, angular momentum and force of the fluid; fixed where one of them is clamped.
template <int D>
struct DustGrain {
    RigidBody<D> body;
    RigidBodyState<D> state;
    double largest;  // radius of the ball of their volume [m]
    Array<std::uint32_t> points;
};

template <int D>
DustGrain<D> dust_grain(const TotalLagrangian<D>& solids, std::span<const std::uint32_t> points) {
    DustGrain<D> grain{};
    grain.points.assign(points.begin(), points.end());
    RigidBody<D>& body = grain.body;
    RigidBodyState<D>& state = grain.state;
    double volume = 0.0;
    for (const std::uint32_t p : points) {
        const double m = solids.mass(p);
        body.fixed |= solids.clamped(p);
        body.mass += m, volume += solids.volume(p);
        state.centre = state.centre + m * solids.x[p];
        state.velocity = state.velocity + m * solids.v[p];
        state.flow_force = state.flow_force + solids.steady[p];
    }
    state.centre = (1.0 / body.mass) * state.centre;
    state.velocity = (1.0 / body.mass) * state.velocity;
    for (const std::uint32_t p : points) {
        const double m = solids.mass(p), spacing = solids.body_of(p).spacing;
        const Vec3 r = in_space(solids.x[p] - state.centre);
        const Vec3 v = in_space(solids.v[p] - state.velocity);
        state.angular_momentum = state.angular_momentum + m * cross(r, v);
        state.flow_torque = state.flow_torque + cross(r, in_space(solids.steady[p]));
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                body.inertia(a, b) +=
                    m * ((a == b ? dot(r, r) + spacing * spacing / 6.0 : 0.0) - r[a] * r[b]);
    }
    if (body.fixed) state.velocity = {}, state.angular_momentum = {};
    grain.largest =
        D == 2 ? std::sqrt(volume / std::numbers::pi) : std::cbrt(0.75 * volume / std::numbers::pi);
    return grain;
}

}  // namespace doseki
