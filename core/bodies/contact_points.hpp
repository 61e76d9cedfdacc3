#pragma once
#include <compare>
#include <cstdint>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "base/matrix.hpp"
#include "bodies/contact_law.hpp"
#include "bodies/shapes/contact_surface.hpp"
#include "bodies/surface/in_space.hpp"
#include "bodies/surface/surface.hpp"
#include "model/domain.hpp"

namespace doseki {

template <class T>
using Span = std::span<T>;

/// Points at which bodies touch others, each a ball: a whole body, a sample of the surface of a
/// solid one or (2-D) of a deformable one (radius 0), or (3-D) a surface particle of a deformable
/// one. Bodies are numbered over all kinds. A row of numbers is an Array or, as loops over many
/// refer to it, a Span.
template <int D, template <class> class Row>
struct RowsOfContactPoints {
    Row<Vec<double, D>> position, velocity;  // of the centre
    Row<Vec3> spin;
    Row<double> radius;
    Row<double> mass, diameter;  // of the body; overlaps are compared with the diameter
    Row<double> share;           // see ContactSide
    Row<std::int32_t> body, material;
    Row<std::uint8_t> fixed, removed, deformable, dust;
    Row<std::int32_t> surface;   // of which it is a sample, in ContactBodies; -1: of none
    Row<Vec<double, D>> offset;  // of rigid bodies, in the frame of the body
    Row<std::int32_t> solid;     // the body, in ContactBodies; -1: none
    Row<std::uint8_t> corner;    // whether it is one of a convex body
    Row<std::uint8_t> hidden;    // whether the surface goes on there in other bodies, see Seams
    // Normal of the surface that a sample is of, in that frame and in space; zero: unknown.
    Row<Vec<double, D>> own_outward, outward;
    // What the contacts do to them; torque about their own centre.
    Row<Vec<double, D>> force;
    Row<Vec3> torque;

    template <class F, class... Self>
    static void members(F&& f, Self&... self) {
        f(self.position...), f(self.velocity...), f(self.spin...), f(self.radius...);
        f(self.mass...), f(self.diameter...), f(self.share...), f(self.body...);
        f(self.material...), f(self.fixed...), f(self.removed...), f(self.deformable...);
        f(self.dust...), f(self.surface...), f(self.offset...), f(self.solid...);
        f(self.corner...), f(self.hidden...), f(self.own_outward...), f(self.outward...);
        f(self.force...), f(self.torque...);
    }
};

template <int D>
using ContactPointSpans = RowsOfContactPoints<D, Span>;

template <int D>
struct ContactPoints : RowsOfContactPoints<D, Array> {
    std::size_t size() const { return this->radius.size(); }

    /// How far from the point bodies that may touch it are looked for.
    double reach(std::size_t k) const {
        return this->surface[k] >= 0 ? 0.5 * this->diameter[k] : this->radius[k];
    }
    /// Adds a point of a body, as a side of a contact has it.
    void add(std::int32_t of_body, const ContactSide& side, const Vec<double, D>& at = {},
             const Vec<double, D>& outward_there = {}) {
        this->members([](auto& row) { row.emplace_back(); }, *this);
        this->radius.back() = side.radius, this->mass.back() = side.mass;
        this->diameter.back() = side.diameter, this->offset.back() = at;
        this->own_outward.back() = outward_there;
        this->body.back() = of_body, this->material.back() = side.material;
        this->fixed.back() = side.fixed, this->deformable.back() = side.deformable;
        this->share.back() = side.share, this->dust.back() = side.dust;
        this->surface.back() = this->solid.back() = -1;
    }

    ContactSide side(std::size_t k) const {
        return {this->material[k],   this->radius[k],          this->mass[k], this->diameter[k],
                this->fixed[k] != 0, this->deformable[k] != 0, false,         this->share[k],
                this->dust[k] != 0};
    }
    ContactPointSpans<D> spans() {
        ContactPointSpans<D> spans;
        this->members([](auto& span, auto& row) { span = row; }, spans, *this);
        return spans;
    }
};

/// A plane face of a fixed body that goes on in others which stand together with it: those with one
/// number of `surface` make one.
template <int D>
struct WallFace {
    std::int32_t solid = -1, surface = -1;
    Vec<double, D> normal{};  // in the frame of the body
    double height = 0.0;      // of the plane above its centre
};

/// A rigid body with a surface that contact points of others may touch.
template <int D>
struct ContactSolid {
    const ContactSurface<D>* surface = nullptr;
    std::int32_t body = 0, material = 0;
    double mass = 0.0, diameter = 0.0;
    Mat<double, 3> inverse_inertia{};  // in its own frame; zero of what is fixed
    bool fixed = false, removed = false;
    std::int32_t wall = -1;                    // fixed ones that hang together have one number
    std::size_t first_face = 0, end_face = 0;  // of those that go on in others
    Vec<double, D> middle{};  // in its own frame, of one that is fixed and may span a period
    Vec<double, D> centre{}, velocity{};
    Mat<double, 3> rotation{};
    Vec3 spin{};
    Vec<double, D> force{};  // on it
    Vec3 torque{};           // about its centre

    /// Where x is, from its centre: by the image nearest to its middle, of which one that spans a
    /// period has half a period on either side. The centre of mass may be elsewhere.
    DOSEKI_DEVICE_FN Vec<double, D> place_of(const Vec<double, D>& x,
                                             const Domain<D>& domain) const {
        return image_near(domain, x - centre, rotated(rotation, middle));
    }

    ContactSide side() const { return {material, 0.0, mass, diameter, fixed, false, true}; }
    /// What a push along n makes of its speed there, over the push: the inverse of the mass that
    /// a contact moves [1/kg]. `arm` is from its centre.
    DOSEKI_DEVICE_FN double mobility(const Vec<double, D>& arm, const Vec<double, D>& n) const {
        if (fixed) return 0.0;
        const Vec3 moment = rotated_back(rotation, cross(in_space(arm), in_space(n)));
        return 1.0 / mass + dot(moment, inverse_inertia * moment);
    }
};

/// Two contact points, or a contact point and shape number -1 - b: the solids, then the surfaces.
struct ContactPair {
    std::int32_t a, b;

    auto operator<=>(const ContactPair&) const = default;
    DOSEKI_DEVICE_FN bool is(const ContactPair& other) const {
        return a == other.a && b == other.b;
    }
    DOSEKI_DEVICE_FN bool with_shape() const { return b < 0; }
    DOSEKI_DEVICE_FN std::size_t shape() const { return static_cast<std::size_t>(-1 - b); }
    DOSEKI_DEVICE_FN std::size_t first() const { return static_cast<std::size_t>(a); }
    DOSEKI_DEVICE_FN std::size_t second() const { return static_cast<std::size_t>(b); }
};

/// The solid of a pair; none where it is one of other things.
template <class Bodies>
DOSEKI_DEVICE_FN auto solid_of(Bodies& bodies, const ContactPair& pair) {
    const bool is_solid = pair.with_shape() && pair.shape() < bodies.solids.size();
    return is_solid ? &bodies.solids[pair.shape()] : nullptr;
}
/// Its surface of a deformable body.
template <class Bodies>
DOSEKI_DEVICE_FN auto surface_of(Bodies& bodies, const ContactPair& pair) {
    const bool is_surface = pair.with_shape() && pair.shape() >= bodies.solids.size();
    return is_surface ? &bodies.surfaces[pair.shape() - bodies.solids.size()] : nullptr;
}

/// All that may touch, as loops over contacts refer to it.
template <int D>
struct ContactBodySpans {
    ContactPointSpans<D> points;
    std::span<ContactSolid<D>> solids;
    std::span<Surface<D>> surfaces;
    std::span<const WallFace<D>> faces;

    DOSEKI_DEVICE_FN ContactSolid<D>* solid(const ContactPair& pair) const {
        return solid_of(*this, pair);
    }
    DOSEKI_DEVICE_FN Surface<D>* surface(const ContactPair& pair) const {
        return surface_of(*this, pair);
    }
};

/// All that may touch.
template <int D>
struct ContactBodies {
    ContactPoints<D> points;
    Array<ContactSolid<D>> solids;
    Array<Surface<D>> surfaces;
    Array<WallFace<D>> faces;  // by their solids

    ContactBodySpans<D> spans() { return {points.spans(), solids, surfaces, faces}; }

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
    const ContactSolid<D>* solid(const ContactPair& pair) const { return solid_of(*this, pair); }
    const Surface<D>* surface(const ContactPair& pair) const { return surface_of(*this, pair); }
};

}  // namespace doseki
