#pragma once
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "base/array.hpp"
#include "bodies/breakable/sections.hpp"
#include "bodies/deformable/deformable_bodies.hpp"
#include "bodies/fragments/rigid_motion.hpp"
#include "bodies/rigid_bodies.hpp"
#include "physics/fracture/impact.hpp"

namespace doseki {

/// Diameter of a disc or ball as large as so many points.
template <int D>
double diameter_of(const DeformableBody& body, std::size_t points) {
    const double count = static_cast<double>(points);
    return body.spacing * (D == 2 ? std::sqrt(4.0 * count / std::numbers::pi)
                                  : std::cbrt(6.0 * count / std::numbers::pi));
}

/// One of `breakable` kinematics: the rigid body that it is while nothing strikes it, and the
/// deformable one that it is while something does. Only one of them takes part in steps. What has
/// come off, and what has lost parts, has no rigid one until it has come to rest within itself.
template <int D>
struct BreakableBody {
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

    std::size_t rigid, deformable;
    Vec<double, D> centre;  // of the rigid one where the points of the other are at rest
    Quaternion orientation;
    double deforms_for = 0.0;                // since it was made deformable [s]
    double loudness = 0.0;                   // energy of its vibration lately [J], 2-D: [J/m]
    double strength = 0.0;                   // tension at which the first crack begins [Pa]
    double bears = 0.0;                      // the same with the cracks that it has
    double impedance = 0.0, diameter = 0.0;  // see Touch
    double bar_impedance = 0.0;              // see blow_tension
    Vec<double, D> middle{};                 // of its points at rest
    Sections sections{};                     // about it

    bool has_rigid() const { return rigid != none; }
    /// Whether it is deformable now, and not all dust.
    bool deforms(const DeformableBodies<D>& bodies) const {
        return diameter > 0.0 && !bodies.solids().is_rigid(deformable);
    }
    /// How the rigid one has turned from where the points of the other are at rest.
    Mat<double, 3> turned(const RigidBodies<D>& bodies) const {
        return bodies.orientation(rigid).matrix() * transposed(orientation.matrix());
    }
    /// Time in which a wave goes through it once [s].
    double crossing(const DeformableBodies<D>& bodies) const {
        return diameter / bodies.solids().material(deformable).wave_speed();
    }
    /// Tension of bending by what loads its points, and of their spin; `motion` is theirs.
    double bent(const TotalLagrangian<D>& solids, const RigidMotion<D>& motion) const {
        const Mat<double, 3> turn = motion.orientation.matrix();
        Array<PlacedForce> forces;
        for (const std::uint32_t p : solids.points_of(deformable))
            forces.push_back({in_space(solids.rest_position(p) - middle),
                              rotated_back(turn, in_space(solids.load[p]))});
        return sections.tension(forces, rotated_back(turn, motion.spin));
    }
    /// Tension of bending by what it meets at this speed, as heavy as `other` [kg], 2-D: [kg/m];
    /// none of a compact one.
    double blown(double speed, double density, double other) const {
        if (!sections.is_long()) return 0.0;
        const double share = 1.0 / (1.0 + density * sections.cube() / other);
        return blow_tension(speed, bar_impedance, sections.fibre(), share);
    }
    /// The same where others hold it, by what has twice this energy for each kilogram of it.
    double caught(double blow) const {
        return caught_tension(blow, bar_impedance, sections.fibre(), sections.is_long());
    }
    /// Time for which it remembers how it vibrated [s].
    double lately(const DeformableBodies<D>& bodies) const { return 5.0 * crossing(bodies); }
};

}  // namespace doseki
