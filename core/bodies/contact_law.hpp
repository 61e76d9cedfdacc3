#pragma once
#include <cstdint>

#include "base/array.hpp"
#include "bodies/rotation.hpp"
#include "model/contact_properties.hpp"
#include "model/options.hpp"
#include "physics/contact.hpp"

namespace doseki {

/// What one of two bodies that touch brings into their contact.
struct ContactSide {
    std::int32_t material;
    double radius;          // of curvature where it touches; of a facet: none
    double mass, diameter;  // of the body
    bool fixed, deformable;
    bool flat;           // touched on a facet
    double share = 1.0;  // of the spring of a point of a deformable body
};

/// Springs of one contact: stretch of friction, then of rolling, and the overlap up to which it
/// does not press, Eq. (115); zero while apart.
using ContactSprings = Vec<double, 7>;
inline constexpr int rest_overlap = 6;

/// Force and moment on the first of two bodies that touch.
struct ContactAction {
    Vec3 force, moment;
};

/// How the bodies of one pair move against each other: velocity and spin of the first minus those
/// of the second, at the point of contact.
struct RelativeMotion {
    Vec3 velocity, spin;
};

/// The law of one pair, eqs. (42) to (50).
struct ContactLaw {
    bool hertz;        // otherwise a linear spring
    bool rigid;        // both bodies are
    double stiffness;  // k, or E* of Hertz
    double mass;       // m*
    double radius;     // R*; 0: does not roll
    double diameter;   // of the smaller body
    double zeta;       // damping ratio
    double friction;   // coefficients
    double rolling;
    double tangential;  // stiffness of friction over the normal one
    double steps;       // time steps in a collision

    double curvature() const { return radius > 0.0 ? radius : 0.5 * diameter; }

    /// That resolves a collision at this speed, and is stable where two bodies touch at `points`
    /// points at once, whose springs and dashpots add up.
    double timestep(double speed, double points) const;

    /// Energy of the springs, without that of rolling, where the overlap beyond that of rest is
    /// `pressed`.
    double stored(const ContactSprings& springs, double pressed) const;

    /// n points away from the first body. Overlaps below that of rest do not press, and take it
    /// with them, Eq. (115).
    ContactAction act(ContactSprings& springs, double overlap, const Vec3& n,
                      const RelativeMotion& motion, double dt) const;

private:
    NormalSpring normal_spring(double overlap) const;
};

/// Makes the laws of pairs from the materials that touch.
template <int D>
class ContactLaws {
public:
    ContactLaws(const ContactOptions& options, Array<ContactProperties> materials);

    ContactLaw between(const ContactSide& a, const ContactSide& b) const;
    double speed() const { return options_.speed; }
    /// How many materials it knows.
    std::size_t materials() const { return materials_.size(); }

private:
    /// Points of deformable bodies are only kept apart, by a penalty: a spring this many times as
    /// stiff as the materials, without damping, resolved by this many steps.
    static constexpr double penalty_factor = 2.0, penalty_steps = 5.0;

    bool hertz() const { return D == 3 && options_.hertz; }
    double stiffness(const ContactLaw& law, const ContactProperties& a,
                     const ContactProperties& b) const;

    ContactOptions options_;
    Array<ContactProperties> materials_;
    Array<double> damping_;  // ratio by pair of materials
};

}  // namespace doseki
