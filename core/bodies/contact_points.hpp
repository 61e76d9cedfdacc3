#pragma once
#include <cstdint>
#include <vector>

#include "bodies/contact_law.hpp"
#include "bodies/shape.hpp"

namespace doseki {

/// Points at which bodies touch others, each a ball: a whole body, a sample of the surface of a
/// convex one (radius 0), or a surface particle of a deformable one. Bodies are numbered over all
/// kinds.
template <int D>
struct ContactPoints {
    std::vector<Vec<double, D>> position, velocity;  // of the centre
    std::vector<Vec3> spin;
    std::vector<double> radius;
    std::vector<double> mass, diameter;  // of the body; overlaps are compared with the diameter
    std::vector<std::int32_t> body, material;
    std::vector<std::uint8_t> fixed, removed, deformable;
    // What the contacts do to them; torque about their own centre.
    std::vector<Vec<double, D>> force;
    std::vector<Vec3> torque;

    std::size_t size() const { return radius.size(); }

    /// Adds a point of a body, as a side of a contact has it.
    void add(std::int32_t of_body, const ContactSide& side) {
        position.push_back({}), velocity.push_back({}), spin.push_back({});
        force.push_back({}), torque.push_back({});
        radius.push_back(side.radius), mass.push_back(side.mass);
        diameter.push_back(side.diameter);
        body.push_back(of_body), material.push_back(side.material);
        fixed.push_back(side.fixed), removed.push_back(0), deformable.push_back(side.deformable);
    }

    ContactSide side(std::size_t k) const {
        return {material[k],   radius[k],          mass[k], diameter[k],
                fixed[k] != 0, deformable[k] != 0, false};
    }
};

/// A convex body that contact points of others may touch.
template <int D>
struct ConvexBody {
    const Shape<D>* shape = nullptr;
    std::int32_t body = 0, material = 0;
    double mass = 0.0, diameter = 0.0;
    bool fixed = false, removed = false;
    Vec<double, D> centre{}, velocity{};
    Mat<double, 3> rotation{};
    Vec3 spin{};
    Vec<double, D> force{};  // on it
    Vec3 torque{};           // about its centre

    ContactSide side() const { return {material, 0.0, mass, diameter, fixed, false, true}; }
};

/// All that may touch.
template <int D>
struct ContactBodies {
    ContactPoints<D> points;
    std::vector<ConvexBody<D>> convex;
};

}  // namespace doseki
