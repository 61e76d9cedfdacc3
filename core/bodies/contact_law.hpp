#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

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
    bool dust = false;   // a few points that came off one

    /// Of what touches: a deformable body does so with its points.
    double width() const { return deformable ? diameter : 2.0 * radius; }
};

/// Springs of one contact: stretch of friction, then of rolling, the overlap up to which it does
/// not press, Eq. (115), and the speed of approach, the normal force and the overlap that pressed
/// in the step before; zero while apart.
using ContactSprings = Vec<double, 10>;
inline constexpr int rest_overlap = 6, approach_before = 7, force_before = 8, pressed_before = 9;

/// Force and moment on the first of two bodies that touch.
struct ContactAction {
    Vec3 force, moment;
};

/// How the bodies of one pair move against each other: velocity and spin of the first minus those
/// of the second, at the point of contact.
struct RelativeMotion {
    Vec3 velocity, spin;
};

/// Springs and dashpots over those of one contact of the whole masses of two bodies.
struct Together {
    double springs = 1.0, dashpots = 1.0;
};

/// The law of one pair, eqs. (42) to (50).
struct ContactLaw {
    bool hertz;        // otherwise a linear spring
    bool rigid;        // both bodies are
    bool dust;         // one of them is
    double stiffness;  // k, or E* of Hertz
    double mass;       // m*
    double radius;     // R*; 0: does not roll
    double diameter;   // of the smaller body
    double zeta;       // damping ratio
    double friction;   // coefficients
    double rolling;
    double tangential;  // stiffness of friction over the normal one
    double steps;       // time steps in a collision

    DOSEKI_DEVICE_FN double curvature() const { return radius > 0.0 ? radius : 0.5 * diameter; }

    /// That resolves a collision at this speed, and is stable where several springs and dashpots
    /// push together.
    double timestep(double speed, const Together& together) const;

    /// Energy of the springs, without that of rolling, where the overlap beyond that of rest is
    /// `pressed`.
    DOSEKI_DEVICE_FN double stored(const ContactSprings& springs, double pressed) const;

    /// n points away from the first body, and the dashpot brakes a mass of `braked`. Overlaps below
    /// that of rest do not press, and take it with them, Eq. (115).
    DOSEKI_DEVICE_FN ContactAction act(ContactSprings& springs, double overlap, const Vec3& n,
                                       const RelativeMotion& motion, double braked,
                                       double dt) const;
    /// At an overlap beyond that of rest.
    DOSEKI_DEVICE_FN NormalSpring normal_spring(double overlap) const;
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
    /// stiff as the materials, without damping.
    static constexpr double penalty_factor = 2.0;
    /// That resolve a contact of something as small as these points.
    static constexpr double few_steps = 5.0;

    bool hertz() const { return D == 3 && options_.hertz; }
    double stiffness(const ContactLaw& law, const ContactProperties& a,
                     const ContactProperties& b) const;
    double soft_stiffness(const ContactLaw& law) const;
    double material_stiffness(const ContactLaw& law, double E) const;

    ContactOptions options_;
    Array<ContactProperties> materials_;
    Array<double> damping_;  // ratio by pair of materials
};

/// A spring along the surface turns with it.
DOSEKI_DEVICE_FN inline Vec3 turned_with(const Vec3& n, const ContactSprings& springs, int first) {
    Vec3 stretch;
    for (int c = 0; c < 3; ++c) stretch[c] = springs[first + c];
    const double before = norm(stretch);
    stretch = stretch - dot(stretch, n) * n;
    const double after = norm(stretch);
    return after > 0.0 ? (before / after) * stretch : stretch;
}

inline double ContactLaw::timestep(double speed, const Together& together) const {
    const CollisionEstimate collision = hertz ? hertz_collision(stiffness, curvature(), mass, speed)
                                              : linear_collision(stiffness, mass, speed);
    constexpr double frequency = 4.0;  // of one spring, over the time of a collision, at most
    const double fastest =
        frequency * std::max(2.0 * zeta * together.dashpots, std::sqrt(together.springs));
    return collision.time / std::max(steps, fastest);
}

DOSEKI_DEVICE_FN inline NormalSpring ContactLaw::normal_spring(double overlap) const {
    return hertz ? hertz_spring(stiffness, curvature(), overlap)
                 : linear_spring(stiffness, overlap);
}

DOSEKI_DEVICE_FN inline double ContactLaw::stored(const ContactSprings& springs,
                                                  double pressed) const {
    const NormalSpring spring = normal_spring(pressed);
    double square = 0.0;
    for (int c = 0; c < 3; ++c) square += springs[c] * springs[c];
    return (hertz ? 0.4 : 0.5) * spring.force * pressed +
           0.5 * tangential * spring.stiffness * square;
}

/// Eq. (159): the normal force with the speed of approach in the middle of a step. What has begun
/// within the last step has been there for a part of the step around now.
DOSEKI_DEVICE_FN inline double force_in_middle(const NormalSpring& spring, double damping,
                                               double approach, double pressed, double braked,
                                               const ContactSprings& springs, double dt) {
    if (damping == 0.0) return spring.force;
    const double slowing = 0.5 * dt * damping / braked;
    double others = 0.0, speed = approach;
    if (pressed < approach * dt)
        speed = 0.5 * approach + pressed / dt;
    else if (springs[force_before] > 0.0)
        others = springs[force_before] - braked / dt * (springs[approach_before] - approach);
    return normal_force({spring.force + slowing * others, 0.0}, damping, speed) / (1.0 + slowing);
}

DOSEKI_DEVICE_FN inline ContactAction ContactLaw::act(ContactSprings& springs, double overlap,
                                                      const Vec3& n, const RelativeMotion& motion,
                                                      double braked, double dt) const {
    const double approach = dot(motion.velocity, n);
    springs[rest_overlap] = min(springs[rest_overlap], overlap);
    const double pressed = overlap - springs[rest_overlap];
    const NormalSpring spring = normal_spring(pressed);
    const double damping = contact_damping(hertz, zeta, spring.stiffness, braked);
    const double normal = force_in_middle(spring, damping, approach, pressed, braked, springs, dt);
    springs[approach_before] = approach, springs[force_before] = normal;
    springs[pressed_before] = pressed;
    const double along = tangential * spring.stiffness, dashpot = tangential * damping;
    Vec3 slid = turned_with(n, springs, 0), rolled = turned_with(n, springs, 3);
    ContactAction result{sliding_spring(slid, motion.velocity - approach * n, dt, along, dashpot,
                                        friction * normal) -
                             normal * n,
                         {}};
    if (radius > 0.0 && rolling > 0.0)
        result.moment = radius * cross(n, sliding_spring(rolled, radius * cross(motion.spin, n), dt,
                                                         along, dashpot, rolling * normal));
    for (int c = 0; c < 3; ++c) springs[c] = slid[c], springs[3 + c] = rolled[c];
    return result;
}

template <int D>
ContactLaws<D>::ContactLaws(const ContactOptions& options, Array<ContactProperties> materials)
    : options_(options), materials_(std::move(materials)) {
    for (const ContactProperties& a : materials_)
        for (const ContactProperties& b : materials_)
            damping_.push_back(damping_ratio(0.5 * (a.restitution + b.restitution), hertz()));
}

template <int D>
ContactLaw ContactLaws<D>::between(const ContactSide& a, const ContactSide& b) const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const auto first = static_cast<std::size_t>(a.material),
               second = static_cast<std::size_t>(b.material);
    const ContactProperties &u = materials_[first], &v = materials_[second];
    const bool penalty = a.deformable || b.deformable;
    ContactLaw law{};
    law.rigid = !penalty, law.dust = a.dust || b.dust;
    law.hertz = hertz() && !penalty;
    law.mass = !a.fixed && !b.fixed ? a.mass * b.mass / (a.mass + b.mass)
               : a.fixed            ? b.mass
                                    : a.mass;
    law.diameter = std::min(a.fixed ? infinite : a.diameter, b.fixed ? infinite : b.diameter);
    law.radius = b.flat ? a.radius : a.radius * b.radius / (a.radius + b.radius);
    law.zeta = damping_[first * materials_.size() + second];
    law.friction = 0.5 * (u.friction + v.friction);
    law.rolling = 0.5 * (u.rolling_friction + v.rolling_friction);
    law.steps = penalty || law.dust ? few_steps : options_.steps;
    if (penalty) {
        const double width = b.flat ? a.width() : std::min(a.width(), b.width());
        law.stiffness =
            penalty_factor * contact_modulus(u, v) * (a.share * b.share * (D == 3 ? width : 1.0));
        law.zeta = law.rolling = 0.0;
    } else
        law.stiffness = stiffness(law, u, v);
    // Linear: equal times of both springs for balls. Hertz: Mindlin's 4 G*/E*.
    const double nu = 0.5 * (u.poisson_ratio + v.poisson_ratio);
    law.tangential = hertz() ? 2.0 * (1.0 - nu) / (2.0 - nu) : 2.0 / 7.0;
    return law;
}

/// E* of a Hertz contact, k of a linear one: that of the material, or eq. (47) where that is
/// softer.
template <int D>
double ContactLaws<D>::stiffness(const ContactLaw& law, const ContactProperties& a,
                                 const ContactProperties& b) const {
    const double of_material = material_stiffness(law, contact_modulus(a, b));
    return options_.softened ? std::min(soft_stiffness(law), of_material) : of_material;
}

template <int D>
double ContactLaws<D>::soft_stiffness(const ContactLaw& law) const {
    const double v = options_.speed, overlap = options_.overlap * law.diameter;
    if (hertz())
        return 15.0 / 16.0 * law.mass * v * v /
               (std::sqrt(law.curvature()) * std::pow(overlap, 2.5));
    return law.mass * v * v / (overlap * overlap);
}

template <int D>
double ContactLaws<D>::material_stiffness(const ContactLaw& law, double E) const {
    if (hertz()) return E;
    if constexpr (D == 2) return 0.25 * std::numbers::pi * E;  // of a line contact, per length
    const double v = options_.speed,
                 same = hertz_collision(E, law.curvature(), law.mass, v).overlap;
    return law.mass * v * v / (same * same);
}

}  // namespace doseki
