#pragma once
// A fluid particle and a wall particle: which face it meets, how it moves against it, and what
// pressure and friction make of that.

#include "model/particles.hpp"
#include "physics/free_surface.hpp"
#include "physics/riemann.hpp"
#include "physics/wall.hpp"
#include "resolved/records.hpp"

namespace doseki {

/// A wall as a fluid particle sees it from one of its particles.
template <class T, int D>
struct FacedWall {
    Vec<T, D> normal;
    T depth;        // of the wall particle below the surface [m]
    T g_normal;     // see wall_excess_pressure
    T in_front;     // 1: of one face or more
    T beyond_edge;  // 1: of several
};

/// Normal, depth and part of gravity are those of the face that the fluid particle is in front of.
/// Beyond an edge, in front of several, the way out leads between them from the edge. What is in
/// front of none takes the line between the two, and no gravity. What lies on a face counts as in
/// front of it, or rounding would choose.
template <class T, int D>
DOSEKI_FN FacedWall<T, D> facing(const WallPoint<T, D>& w, const Vec<T, D>& r_iw, const T& r) {
    const T on_face = number<T>(1 - 1e-4);
    const Vec<T, D> height = w.faces * r_iw;
    Vec<T, D> front, out;
    T count(0);
    for (int k = 0; k < D; ++k) {
        const T above = height[k] - on_face * w.depths[k];
        front[k] = select(above > T(0), T(1), T(0));
        out[k] = front[k] * above, count += front[k];
    }
    const Mat<T, D> normals = transposed(w.faces);
    FacedWall<T, D> seen;
    seen.in_front = min(count, T(1));
    seen.beyond_edge = select(count > T(1), T(1), T(0));
    const T alone = seen.in_front - seen.beyond_edge, none = (T(1) - seen.in_front) / r;
    const Vec<T, D> from_edge = normals * out, of_face = normals * front;
    const T distance = sqrt(dot(from_edge, from_edge) + least_number<T>());
    const T unit = seen.beyond_edge / distance;
    for (int a = 0; a < D; ++a)
        seen.normal[a] = alone * of_face[a] + unit * from_edge[a] + none * r_iw[a];
    seen.depth = select(seen.beyond_edge > T(0), dot(r_iw, from_edge) / distance - distance,
                        select(alone > T(0), dot(front, w.depths), w.depths[0]));
    seen.g_normal = alone * dot(front, w.g_normal) + unit * dot(out, w.g_normal);
    return seen;
}

/// How a fluid particle i moves against a wall particle w, the wall standing for fluid of mirrored
/// velocity.
template <class T, int D>
struct WallContact {
    FacedWall<T, D> seen;
    Vec<T, D> at_foot;      // normal n' of the wall where i is in front of it
    Vec<T, D> corrected_r;  // B_i r_iw
    T pushes;               // 0: at an edge that the fluid goes off past
    T r_dot_n, corrected_r_dot_n;
    T height;       // of i above the surface of the wall
    T no_slip;      // share of it that holds here
    T from_centre;  // along n', of a ball that moves; of others 0
    // Against w:
    T approach;                  // (v_i - v_w).(-n)
    Vec<T, D> v_i_w, past_edge;  // v_i - v_w, and its part along the face
    // Against the wall as its body moves where i is, Eq. (164): what turns with it is at rest.
    Vec<T, D> v_iw, sliding;
};

/// The normals of a ball that moves meet in its centre: pressure has no moment about it. The bend
/// of a wall particle is that of circles half a spacing above the surface.
template <class T, int D>
DOSEKI_FN void meet_in_centre(WallContact<T, D>& contact, const FlowConstants& constants,
                              const Vec<T, D>& r_iw, const WallPoint<T, D>& w) {
    const Vec<T, D> normal = row(w.faces, 0);
    const T radius = select(w.inverse_density > T(0), radius_of_ball<T, D>(w.bend, normal), T(0));
    if (!any(radius > T(0))) return;
    const T is_ball = select(radius > T(0), T(1), T(0));
    const T height = dot(normal, r_iw) - w.depths[0] - number<T>(0.5 * constants.dp);
    const Vec<T, D> arm = (radius + height) * normal + radius * (w.bend * r_iw);
    contact.from_centre = is_ball * sqrt(dot(arm, arm));
    const T inverse = is_ball / max(contact.from_centre, T(1) - is_ball);
    contact.at_foot = (T(1) - is_ball) * contact.at_foot + inverse * arm;
}

template <class T, int D>
DOSEKI_FN WallContact<T, D> wall_contact(const FlowConstants& constants, const Vec<T, D>& r_iw,
                                         const T& r, const FluidPoint<T, D>& i,
                                         const WallPoint<T, D>& w) {
    WallContact<T, D> contact;
    const FacedWall<T, D> seen = contact.seen = facing(w, r_iw, r);
    contact.v_i_w = i.v - w.v;
    contact.r_dot_n = dot(r_iw, seen.normal), contact.height = contact.r_dot_n - seen.depth;
    contact.approach = -dot(contact.v_i_w, seen.normal);
    // An edge pushes what comes to it. It does not pull what goes off a face past it.
    contact.pushes = select(contact.approach < T(0), T(1) - seen.beyond_edge, T(1));
    contact.approach = contact.pushes * contact.approach;
    contact.past_edge = contact.v_i_w + contact.approach * seen.normal;
    contact.corrected_r = i.correction * r_iw;
    contact.corrected_r_dot_n = dot(contact.corrected_r, seen.normal);
    contact.no_slip =
        w.no_slip * no_slip_factor(seen.depth, contact.height, number<T>(0.25 * constants.dp));
    contact.at_foot = normal_at_foot(seen.normal, w.bend * (seen.in_front * r_iw));
    contact.from_centre = T(0);
    meet_in_centre(contact, constants, r_iw, w);
    contact.v_iw = contact.v_i_w - turned_by<T, D>(w.spin, r_iw);
    contact.sliding =
        contact.v_iw - (contact.pushes * dot(contact.v_iw, contact.at_foot)) * contact.at_foot;
    return contact;
}

/// Pressure and viscous stress between the two.
template <class T, int D>
struct WallForces {
    Vec<T, D> pressure, viscous;  // on i over V_i
    T excess;                     // of the pressure at w over p_i
    T power;                      // dissipated, over V_i
    T made;                       // by pressure beyond what approach does to the density, over V_i
    T viscous_rate;               // see ForceAccumulators
};

template <class T, int D>
DOSEKI_FN WallForces<T, D> wall_forces(const FlowConstants& constants,
                                       const WallContact<T, D>& contact, const Vec<T, D>& r_iw,
                                       const T& r, const T& F, const FluidPoint<T, D>& i,
                                       const WallPoint<T, D>& w) {
    WallForces<T, D> forces;
    const FacedWall<T, D>& seen = contact.seen;
    const T c = number<T>(constants.c);
    // Air comes in on free surfaces and at bodies that move: walls pull no harder than pores do.
    const T vented =
        select(i.surface > number<T>(FreeSurfaceIndicator::surface), T(1), w.inverse_density);
    const T least =
        select(vented > T(0), min(T(0), number<T>(-constants.suction) - i.p), T(-c * c) * i.rho);
    const T solved = approach_pressure(T(-2) * contact.pushes * dot(contact.v_iw, contact.at_foot),
                                       i.rho, c, smooth_approach(i.resolved_strain, r));
    const T extra = max(solved, least);
    const Vec<T, D> across = contact.r_dot_n * contact.at_foot;
    // The line to what is in front of no face is no normal: across it as well the fluid goes on.
    forces.excess = wall_excess_pressure(i.p, i.rho, i.pressure_gradient, seen.g_normal,
                                         seen.in_front * seen.normal, contact.r_dot_n, r_iw);
    const T p = i.p + number<T>(0.5) * forces.excess;
    const T scale = T(-2) * w.volume * F, mu_wall = i.mu * contact.no_slip;
    forces.pressure = (scale * p) * contact.corrected_r;
    // A wall bears the viscous stress across it. Where fluid sticks to it there is none.
    const T mu_across =
        number<T>(2 * constants.form.transposed) * (T(1) - w.no_slip) * seen.in_front * i.mu;
    const Vec<T, D> sheared = mu_wall * contact.sliding +
                              (mu_across * dot(contact.at_foot, i.strain * r_iw)) * contact.at_foot;
    forces.viscous = scale * (extra * across - sheared);
    forces.power = scale * (dot(sheared, contact.v_iw) - extra * dot(across, contact.v_iw));
    // The fluid and a light body take the same impulse, and the body goes and turns faster by it.
    constexpr double of_body = D == 2 ? 3.5 : 4.5;
    forces.viscous_rate =
        scale * (mu_wall + mu_across) * max(T(1), number<T>(of_body) * i.rho * w.inverse_density);
    // The velocity that it works against: a ball that spins is no obstacle to pressure.
    const Vec<T, D> v_pressed =
        contact.v_iw + turned_by<T, D>(w.spin, contact.from_centre * contact.at_foot);
    forces.made = dot(forces.pressure, v_pressed) +
                  scale * i.p * contact.approach * contact.corrected_r_dot_n;
    return forces;
}

}  // namespace doseki
