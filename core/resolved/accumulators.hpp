#pragma once
// What the resolved scheme sums over pairs, and what one pair adds: numbers in, numbers out, so
// that one source serves packs on a processor and one thread for each particle on a device.

#include "physics/free_surface.hpp"
#include "physics/riemann.hpp"
#include "resolved/wall_pair.hpp"

namespace doseki {

/// What a fluid particle i sums over its neighbours for its density, half a step before its forces;
/// gradients are those of the plain kernel.
template <class T, int D>
struct ContinuityAccumulators {
    T density_rate{};                  // over rho_i
    T sliding_rate{}, sliding_size{};  // see edge_rate
    T power{};                         // that pairs dissipate, over V_i
    Mat<T, D> velocity_gradient;
    Sym<T, D> moment;
    Vec<T, D> concentration_gradient, surface_gradient;
    T concentration{};  // sum of rest volumes times W
    T wall_share{};     // of walls in it
    Vec<T, D> wall_gradient;
    T film_share{}, film_pressure{};  // of what other faces cover of them, see WallState
    Largest<T> surface;               // of the neighbours' free-surface indicators
    Largest<T> at_body;               // above 0: one that moves is in reach

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.density_rate...), f(self.sliding_rate...), f(self.sliding_size...);
        f(self.power...), f(self.velocity_gradient...), f(self.moment...);
        f(self.concentration_gradient...), f(self.surface_gradient...);
        f(self.concentration...), f(self.wall_share...), f(self.wall_gradient...);
        f(self.film_share...), f(self.film_pressure...), f(self.surface...), f(self.at_body...);
    }
};

/// And for its forces.
template <class T, int D>
struct ForceAccumulators {
    Vec<T, D> force;          // of viscosity, dissipation and shifting, over V_i/2
    Vec<T, D> traction;       // of beds with friction, over V_i
    T power{};                // that pairs dissipate, over V_i
    T made_power{};           // that shifting and walls make, over V_i
    T viscous_rate{};         // at which viscosity damps the roughest motion, times rho_i
    Largest<T> viscous_pair;  // coefficient of one pair in it
    Vec<T, D> pressure_gradient, concentration_gradient;
    Vec<T, D> corrected_gradient;  // of concentration, with the corrections of the neighbours
    T concentration{}, squares{};  // of fluid: sums of rest volumes times W, and of their squares

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.force...), f(self.traction...), f(self.power...), f(self.made_power...);
        f(self.viscous_rate...), f(self.viscous_pair...);
        f(self.pressure_gradient...), f(self.concentration_gradient...);
        f(self.corrected_gradient...), f(self.concentration...), f(self.squares...);
    }
};

/// Over the fluid around a wall particle, with weights V W but for the force.
template <class T, int D>
struct WallAccumulators {
    Vec<T, D> force;    // of the fluid
    Turn<T, D> moment;  // of it about the wall particle: it acts where the fluid is, Eq. (164)
    T weight{}, height{}, pressure{}, density{}, viscosity{};
    Vec<T, D> velocity;  // against the wall
    Vec<T, D> area;      // that it sees of the fluid, outwards, over the wall particle's volume
    // Over the faces of other bodies around its own:
    Vec<T, D> film_force, face_velocity, to_face;
    Vec<T, D> facing, facing_height;  // how much they are in front of each face at an edge, and
                                      // the same times their height above it
    T cover{}, film_pressure{}, film_density{};

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.force...), f(self.moment...), f(self.weight...), f(self.height...);
        f(self.pressure...), f(self.density...), f(self.viscosity...);
        f(self.velocity...), f(self.area...), f(self.film_force...);
        f(self.face_velocity...), f(self.to_face...), f(self.facing...), f(self.facing_height...);
        f(self.cover...), f(self.film_pressure...), f(self.film_density...);
    }
};

/// What the fluid around a wall particle gives to it against the normal of a face, see FacePush.
template <class T, int D>
struct FaceAccumulators {
    T all{}, front{};
    Vec<T, D> lever;

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.all...), f(self.front...), f(self.lever...);
    }
};

/// Force of pressure on a fluid particle i over V_i: -sum_j V_j (p_i B_j + p_j B_i) grad W, with
/// B_i and 2 p* in front of walls (reverse kernel gradient correction: Zhang, Adams and Hu,
/// arXiv:2406.02576). Pairs conserve momentum, and an arrangement of particles under pressure
/// resists no shear, as it does with B = 1: its stress is that of p times the moment of gradients.
template <int D>
DOSEKI_DEVICE_FN Vec<double, D> pressure_force(const ForceAccumulators<double, D>& sums,
                                               const FluidFields<double, D>& i) {
    const Vec<double, D> of_neighbours = sums.pressure_gradient + i.p * sums.concentration_gradient;
    return -1.0 * (i.correction * of_neighbours + i.p * sums.corrected_gradient);
}

/// The gradient factor F of Eq. (26) of a pair: grad W = F r_ij.
template <class Kernel, class T>
DOSEKI_FN T gradient_factor(const FlowConstants& constants, const T& inverse_support, const T& r) {
    return number<T>(constants.gradient_scale) * Kernel::gradient_factor(r, inverse_support);
}

/// What every neighbour, fluid or wall, adds to the gradients.
template <class T, int D>
DOSEKI_FN void add_gradients(ContinuityAccumulators<T, D>& sums, const Vec<T, D>& r_ij, const T& VF,
                             const Vec<T, D>& v_ij) {
    for (int a = 0; a < D; ++a) {
        const T gradient = VF * r_ij[a];
        sums.concentration_gradient[a] += gradient;
        for (int b = 0; b < D; ++b) sums.velocity_gradient(b, a) -= v_ij[b] * gradient;
        for (int b = a; b < D; ++b) sums.moment(a, b) -= gradient * r_ij[b];
    }
}

template <class T, int D>
DOSEKI_FN void add_gradients(ForceAccumulators<T, D>& sums, const Vec<T, D>& r_ij, const T& VF,
                             const T& p_ij, const Vec<T, D>& corrected_r) {
    for (int a = 0; a < D; ++a) {
        const T gradient = VF * r_ij[a];
        sums.concentration_gradient[a] += gradient;
        sums.pressure_gradient[a] -= p_ij * gradient;
        sums.corrected_gradient[a] += VF * corrected_r[a];
    }
}

/// What a fluid particle j adds to the density of a fluid particle i.
template <class Kernel, class T, int D>
DOSEKI_FN void add_fluid(ContinuityAccumulators<T, D>& sums, const FlowConstants& constants,
                         const T& inverse_support, const Pair<T, D>& pair,
                         const FluidPoint<T, D>& i, const FluidPoint<T, D>& j) {
    const T half = number<T>(0.5), c = number<T>(constants.c);
    const T VF = j.volume * gradient_factor<Kernel>(constants, inverse_support, pair.r);
    const Vec<T, D> v_ij = i.v - j.v;
    const T jump = pressure_jump(i.p, j.p, i.pressure_gradient, j.pressure_gradient, pair.r_ij);
    const T levelled = half * jump * (pair.r / (half * (i.rho + j.rho) * c));
    sums.density_rate += VF * (dot(v_ij, j.correction * pair.r_ij) + levelled);
    sums.power -= VF * half * levelled * (i.p - j.p);
    add_gradients(sums, pair.r_ij, VF, v_ij);
    const T surface = j.surface - i.surface;
    for (int a = 0; a < D; ++a) sums.surface_gradient[a] += surface * (VF * pair.r_ij[a]);
    sums.concentration += j.rest_volume * Kernel::value(pair.r, inverse_support);
    sums.surface.take(select(VF < T(0), j.surface, T(0)));
}

/// What it adds to its force.
template <class Kernel, class T, int D>
DOSEKI_FN void add_fluid(ForceAccumulators<T, D>& sums, const FlowConstants& constants,
                         const T& inverse_support, const Pair<T, D>& pair,
                         const FluidPoint<T, D>& i, const FluidPoint<T, D>& j) {
    const T half = number<T>(0.5), c = number<T>(constants.c);
    const T VF = j.volume * gradient_factor<Kernel>(constants, inverse_support, pair.r);
    const Vec<T, D> v_ij = i.v - j.v;
    const T v_dot_r = dot(v_ij, pair.r_ij), rho = half * (i.rho + j.rho);
    const Vec<T, D> strained = half * ((i.strain + j.strain) * pair.r_ij);
    const T smooth = dot(strained, pair.r_ij), inverse_r = T(1) / pair.r;
    const T resolved = min(i.resolved_strain, j.resolved_strain);
    const T extra = approach_pressure((smooth - v_dot_r) * inverse_r, rho, c,
                                      smooth_approach(resolved, pair.r));
    const T mu = pair_viscosity(i.mu, j.mu, i.strain, j.strain, constants.viscosity);
    const ViscousForm<T> form{number<T>(constants.form.along_jump),
                              number<T>(constants.form.transposed),
                              number<T>(constants.form.along_pair)};
    const Vec<T, D> transposed =
        strained - turned_by<T, D>(half * (i.turning + j.turning), pair.r_ij);
    const Vec<T, D> viscous =
        viscous_direction(form, v_ij, transposed, v_dot_r, inverse_r, pair.r_ij);
    const T W = Kernel::value(pair.r, inverse_support);
    const T exchange = half * number<T>(constants.exchange) * rho * j.volume * W;
    for (int a = 0; a < D; ++a) {
        const T exchanged = exchange * (i.carried[a] - j.carried[a]);
        sums.force[a] += exchanged - VF * (extra * pair.r_ij[a] - mu * viscous[a]);
        sums.made_power += exchanged * v_ij[a];
    }
    sums.power -= VF * (mu * dot(viscous, v_ij) - extra * v_dot_r);
    const T damping = T(-1) * VF * mu, itself = number<T>(1e-6 * constants.dp);
    sums.viscous_rate += number<T>(constants.roughest) * damping;
    sums.viscous_pair.take(select(pair.r > itself, damping, T(0)));
    const T share = j.rest_volume * W;
    sums.concentration += share, sums.squares += share * share;
    add_gradients(sums, pair.r_ij, VF, i.p - j.p, j.correction * pair.r_ij);
}

/// What a wall particle w adds to the density of a fluid particle i.
template <class Kernel, class T, int D>
DOSEKI_FN void add_wall(ContinuityAccumulators<T, D>& sums, const FlowConstants& constants,
                        const T& inverse_support, const Pair<T, D>& pair, const FluidPoint<T, D>& i,
                        const WallPoint<T, D>& w) {
    const T VF = w.volume * gradient_factor<Kernel>(constants, inverse_support, pair.r);
    const auto contact = wall_contact(constants, pair.r_ij, pair.r, i, w);
    sums.density_rate -= T(2) * VF * contact.approach * contact.corrected_r_dot_n;
    sums.sliding_rate += T(2) * VF * dot(contact.past_edge, contact.corrected_r);
    sums.sliding_size += T(-2) * VF * pair.r * sqrt(dot(contact.v_i_w, contact.v_i_w));
    const T resolved = resolved_shear(i.mu, i.rho, sqrt(dot(contact.sliding, contact.sliding)),
                                      number<T>(constants.dp));
    // v_i less the velocity that the fluid goes on to at w. What sticks to a wall turns with it.
    const T steep = (T(1) - resolved * w.no_slip) * contact.seen.in_front * contact.r_dot_n /
                    max(contact.height, number<T>(0.25 * constants.dp));
    const Vec<T, D> jump = (resolved * contact.no_slip) * contact.sliding + steep * w.shear +
                           T(2) * (contact.v_iw - contact.sliding) +
                           (resolved * w.no_slip) * turned_by<T, D>(w.spin, pair.r_ij);
    add_gradients(sums, pair.r_ij, VF, jump);
    const T share = w.volume * Kernel::value(pair.r, inverse_support), film = share * w.film_cover;
    sums.wall_share += share;
    sums.film_share += film, sums.film_pressure += film * w.pressure;
    for (int a = 0; a < D; ++a) sums.wall_gradient[a] += VF * pair.r_ij[a];
    sums.at_body.take(select(VF < T(0), w.inverse_density, T(0)));
}

/// What it adds to its force.
template <class Kernel, class T, int D>
DOSEKI_FN void add_wall(ForceAccumulators<T, D>& sums, const FlowConstants& constants,
                        const T& inverse_support, const Pair<T, D>& pair, const FluidPoint<T, D>& i,
                        const WallPoint<T, D>& w) {
    const T F = gradient_factor<Kernel>(constants, inverse_support, pair.r);
    const T W = Kernel::value(pair.r, inverse_support);
    const auto contact = wall_contact(constants, pair.r_ij, pair.r, i, w);
    const auto forces = wall_forces(constants, contact, pair.r_ij, pair.r, F, i, w);
    const T half = number<T>(0.5);
    for (int a = 0; a < D; ++a) {
        sums.force[a] += half * forces.viscous[a];
        sums.traction[a] += W * w.traction[a];
    }
    sums.power += forces.power;
    sums.made_power += forces.made;
    sums.viscous_rate += forces.viscous_rate;
    add_gradients(sums, pair.r_ij, w.volume * F, -forces.excess, contact.corrected_r);
}

/// What a fluid particle j adds to a wall particle w. `pair` points from the fluid particle j
/// to the wall particle w.
template <class Kernel, class T, int D>
DOSEKI_FN void add_fluid_to_wall(WallAccumulators<T, D>& sums, const FlowConstants& constants,
                                 const T& inverse_support, const Pair<T, D>& pair,
                                 const WallPoint<T, D>& w, const FluidPoint<T, D>& j) {
    const T F = gradient_factor<Kernel>(constants, inverse_support, pair.r),
            W = Kernel::value(pair.r, inverse_support);
    const Vec<T, D> r_jw = T(-1) * pair.r_ij;
    const auto contact = wall_contact(constants, r_jw, pair.r, j, w);
    const auto forces = wall_forces(constants, contact, r_jw, pair.r, F, j, w);
    const T share = (T(1) - j.in_film) * j.volume * W;
    const Vec<T, D> force = T(-1) * j.volume * (forces.pressure + forces.viscous);
    // About w, and of a ball about its centre, where pressure has none.
    const T others = select(contact.from_centre > T(0), T(0), T(1));
    const Vec<T, D> lever = contact.from_centre * contact.at_foot + others * r_jw;
    const Vec<T, D> turning = T(-1) * j.volume * (forces.viscous + others * forces.pressure);
    const Turn<T, D> moment = moment_of(lever, turning);
    for (std::size_t a = 0; a < moment.component.size(); ++a) sums.moment[a] += moment[a];
    for (int a = 0; a < D; ++a) {
        sums.force[a] += force[a];
        sums.velocity[a] += share * contact.v_iw[a];
        sums.area[a] -= T(2) * j.volume * F * contact.corrected_r[a];
    }
    sums.weight += share;
    sums.density += share * j.rho;
    sums.viscosity += share * j.mu;
    sums.height += share * contact.height;
    sums.pressure += share * (j.p + forces.excess);
}

/// What part of a particle, as wide as a spacing, is above a plane.
template <class T>
DOSEKI_FN T part_above(const T& height, double dp) {
    return min(T(1), max(T(0), height * number<T>(1.0 / dp) + number<T>(0.5)));
}

/// How much of a fluid particle pushes on the plane with the normal n, `below` above w: all of what
/// is in front of it. Past an edge, above another face of w, what is near the plane counts by its
/// part in front.
template <class T, int D>
DOSEKI_FN T share_in_front(const FacedPoint<T, D>& w, const Vec<T, D>& n, const Vec<T, D>& r_jw,
                           double dp) {
    const T half = number<T>(0.5);
    T beside(0);
    for (int k = 0; k < D; ++k) {
        const Vec<T, D> face = row(w.wall.faces, k);
        const T is_face = select(dot(face, face) > half, T(1), T(0)),
                is_other = select(dot(face, n) < half, is_face, T(0));
        beside = max(beside, is_other * part_above(dot(face, r_jw) - w.wall.depths[k], dp));
    }
    const T height = dot(n, r_jw) - w.below, front = part_above(height, dp);
    return front + select(height > T(0), (T(1) - front) * (T(1) - beside), T(0));
}

/// What it adds of that to the push on a face.
template <class Kernel, class T, int D>
DOSEKI_FN void add_fluid_to_face(FaceAccumulators<T, D>& sums, const FlowConstants& constants,
                                 const Vec<double, D>& normal, const T& inverse_support,
                                 const Pair<T, D>& pair, const FacedPoint<T, D>& w,
                                 const FluidPoint<T, D>& j) {
    const T F = gradient_factor<Kernel>(constants, inverse_support, pair.r);
    const Vec<T, D> r_jw = T(-1) * pair.r_ij;
    const auto contact = wall_contact(constants, r_jw, pair.r, j, w.wall);
    const auto forces = wall_forces(constants, contact, r_jw, pair.r, F, j, w.wall);
    Vec<T, D> n;
    for (int a = 0; a < D; ++a) n[a] = number<T>(normal[a]);
    const T push = j.volume * dot(n, forces.pressure + forces.viscous),
            front = share_in_front(w, n, r_jw, constants.dp) * push;
    sums.all += push, sums.front += front;
    for (int a = 0; a < D; ++a) sums.lever[a] += front * r_jw[a];
}

/// Whether a wall particle is at an edge: another face than its own, which is not that of the other
/// side, is in its support.
template <class T, int D>
DOSEKI_FN auto is_at_edge(const WallFields<T, D>& w, const T& inverse_support) {
    const Vec<T, D> first = row(w.faces, 0), second = row(w.faces, 1);
    const T half = number<T>(0.5);
    return dot(second, second) > half && dot(first, second) > -half &&
           w.depths[1] * inverse_support < T(1);
}

/// How much a particle at `to` from w is in front of its face k, within 45 degrees, in squares of
/// the support.
template <class T, int D>
DOSEKI_FN T in_front_of(const WallFields<T, D>& w, int k, const Vec<T, D>& to,
                        const T& inverse_support) {
    const T height = max(T(0), dot(row(w.faces, k), to));
    return max(T(0), number<T>(2) * height * height - dot(to, to)) * inverse_support *
           inverse_support;
}

/// How much everything is in front of a face beyond that: nothing else may bear the film there.
constexpr double in_front_of_none = 1e-4;

/// The force of the film of w that a particle at `to` from it bears, with this share of w. At an
/// edge, along each face, it is by what is in front of that face and, in the plane, by what is in
/// front of the other one: in space a card has no registers left for that.
template <class T, int D>
DOSEKI_FN Vec<T, D> film_force_on(const WallFields<T, D>& w, const Vec<T, D>& to, const T& share,
                                  const T& inverse_support) {
    Vec<T, D> of_faces, force;
    for (int k = 0; k < D; ++k) {
        const T in_front = in_front_of<T, D>(w, k, to, inverse_support);
        T along = w.film_traction[k] * (in_front + number<T>(in_front_of_none));
        if constexpr (D == 2)
            along += w.film_aside[k] * in_front_of<T, D>(w, 1 - k, to, inverse_support);
        of_faces = of_faces + along * row(w.faces, k);
    }
    const auto at_edge = is_at_edge<T, D>(w, inverse_support);
    for (int a = 0; a < D; ++a) force[a] = share * select(at_edge, of_faces[a], w.film_traction[a]);
    return force;
}

/// What a face v of another body adds to a face w: the pressure of the film between them, and their
/// share in the force of that film, which is the opposite for v.
template <class Kernel, class T, int D>
DOSEKI_FN void add_face(WallAccumulators<T, D>& sums, const Vec<double, D>& gravity,
                        const T& inverse_support, const Pair<T, D>& pair, const WallPoint<T, D>& w,
                        const WallPoint<T, D>& v) {
    const T none = number<T>(Face::none), body = number<T>(Face::first_body);
    const T own = max(w.face, -w.face), other = max(v.face, -v.face);
    const T W = select(own != other && own != none && other != none,
                       Kernel::value(pair.r, inverse_support), T(0));
    const T share = select(v.face > none, v.volume * W, T(0)),
            of_other = select(w.face > none, w.volume * W, T(0));
    T head = v.pressure;
    for (int a = 0; a < D; ++a) {
        head += v.film_density * number<T>(gravity[a]) * pair.r_ij[a];
        sums.face_velocity[a] += share * v.v[a];
        sums.to_face[a] -= share * pair.r_ij[a];
    }
    const Vec<T, D> to_v = T(-1) * pair.r_ij;
    for (int k = 0; k < D; ++k) {
        const T facing = share * in_front_of<T, D>(w, k, to_v, inverse_support);
        sums.facing[k] += facing;
        sums.facing_height[k] += facing * dot(row(w.faces, k), to_v);
    }
    sums.cover += share;
    sums.film_pressure += share * head;
    sums.film_density += share * v.film_density;
    // Two bodies that move have the force of one film each.
    const T both = select(own >= body && other >= body, number<T>(0.5), T(1));
    sums.film_force =
        sums.film_force + both * (film_force_on<T, D>(w, to_v, share, inverse_support) -
                                  film_force_on<T, D>(v, pair.r_ij, of_other, inverse_support));
}

}  // namespace doseki
