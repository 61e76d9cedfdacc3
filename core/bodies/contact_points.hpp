#pragma once
#include <compare>
#include <cstdint>
#include <utility>

#include "base/array.hpp"
#include "bodies/contact_law.hpp"
#include "bodies/contact_surface.hpp"
#include "bodies/surface.hpp"

namespace doseki {

/// Points at which bodies touch others, each a ball: a whole body, a sample of the surface of a
/// solid one or (2-D) of a deformable one (radius 0), or (3-D) a surface particle of a deformable
/// one. Bodies are numbered over all kinds.
template <int D>
struct ContactPoints {
    Array<Vec<double, D>> position, velocity;  // of the centre
    Array<Vec3> spin;
    Array<double> radius;
    Array<double> mass, diameter;  // of the body; overlaps are compared with the diameter
    Array<double> share;           // see ContactSide
    Array<std::int32_t> body, material;
    Array<std::uint8_t> fixed, removed, deformable, dust;
    Array<std::int32_t> surface;  // of which it is a sample, in ContactBodies; -1: of none
    // What the contacts do to them; torque about their own centre.
    Array<Vec<double, D>> force;
    Array<Vec3> torque;

    std::size_t size() const { return radius.size(); }

    /// How far from the point bodies that may touch it are looked for.
    double reach(std::size_t k) const { return surface[k] >= 0 ? 0.5 * diameter[k] : radius[k]; }
    /// Adds a point of a body, as a side of a contact has it.
    void add(std::int32_t of_body, const ContactSide& side) {
        position.push_back({}), velocity.push_back({}), spin.push_back({});
        force.push_back({}), torque.push_back({});
        radius.push_back(side.radius), mass.push_back(side.mass);
        diameter.push_back(side.diameter);
        body.push_back(of_body), material.push_back(side.material);
        fixed.push_back(side.fixed), removed.push_back(0), deformable.push_back(side.deformable);
        share.push_back(side.share), dust.push_back(side.dust), surface.push_back(-1);
    }

    ContactSide side(std::size_t k) const {
        return {material[k],        radius[k], mass[k],  diameter[k], fixed[k] != 0,
                deformable[k] != 0, false,     share[k], dust[k] != 0};
    }
};

/// A rigid body with a surface that contact points of others may touch.
template <int D>
struct ContactSolid {
    const ContactSurface<D>* surface = nullptr;
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

/// Two contact points, or a contact point and shape number -1 - b: the solids, then the surfaces.
struct ContactPair {
    std::int32_t a, b;

    auto operator<=>(const ContactPair&) const = default;
    bool with_shape() const { return b < 0; }
    std::size_t shape() const { return static_cast<std::size_t>(-1 - b); }
    std::size_t first() const { return static_cast<std::size_t>(a); }
    std::size_t second() const { return static_cast<std::size_t>(b); }
};

/// All that may touch.
template <int D>
struct ContactBodies {
    ContactPoints<D> points;
    Array<ContactSolid<D>> solids;
    Array<Surface<D>> surfaces;

    /// The two bodies of a pair.
    std::pair<std::int32_t, std::int32_t> bodies(const ContactPair& pair) const {
        const std::int32_t first = points.body[pair.first()];
        if (!pair.with_shape()) return {first, points.body[pair.second()]};
        const Surface<D>* of = surface(pair);
        return {first, of ? of->body : solids[pair.shape()].body};
    }
    ContactPair pair_with_surface(std::int32_t point, std::int32_t surface) const {
        return {point, -1 - static_cast<std::int32_t>(solids.size()) - surface};
    }
    /// That of the pair; none where it is one of other things.
    const ContactSolid<D>* solid(const ContactPair& pair) const {
        if (!pair.with_shape() || pair.shape() >= solids.size()) return nullptr;
        return &solids[pair.shape()];
    }
    const Surface<D>* surface(const ContactPair& pair) const {
        if (!pair.with_shape() || pair.shape() < solids.size()) return nullptr;
        return &surfaces[pair.shape() - solids.size()];
    }
    Surface<D>* surface(const ContactPair& pair) {
        return const_cast<Surface<D>*>(std::as_const(*this).surface(pair));
    }
};

}  // namespace doseki
