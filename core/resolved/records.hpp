#pragma once
#include "pairs/records.hpp"
#include "physics/rheology/pair_viscosity.hpp"
#include "physics/viscosity.hpp"

namespace doseki {

struct FlowConstants {
    double c, dp;           // sound speed of the fluid [m/s], spacing [m]
    double gradient_scale;  // of kernel gradients, so that their moment on a lattice is 1
    double exchange;        // 1 / (sum of V W over the neighbours on a lattice)
    ViscousForm<double> form;
    // Rates of fluid pairs and of the strongest over that of Morris' form, Eq. (154).
    double roughest = 0.0, nearest = 0.0;
    double suction = 0.0;  // that water at bodies bears, Eq. (85) [Pa]
    PairViscosity viscosity{};
};

/// What the sums of the resolved scheme need of a fluid particle beside its motion: W of them, or
/// one in memory.
template <class T, int D>
struct FluidFields {
    Vec<T, D> pressure_gradient;
    Sym<T, D> strain;       // symmetric part of the velocity gradient
    Turn<T, D> turning;     // the rest of it: half of the vorticity
    Sym<T, D> correction;   // of kernel gradients, see kernel_correction
    Vec<T, D> carried;      // L dv, what shifting makes of the velocity
    T volume, rest_volume;  // m/rho, m/rho0
    T rho, p;               // p: with what damps sound
    T mu;                   // molecular and eddy viscosity [Pa s]
    T surface;              // free-surface indicator of the last step
    T resolved_strain;      // rate, as far as viscosity resolves it, Eq. (145) [1/s]
    T in_film;              // share of it that is part of a film between faces, Eq. (156)

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.pressure_gradient...), f(self.strain...), f(self.turning...), f(self.correction...);
        f(self.carried...), f(self.volume...), f(self.rest_volume...), f(self.rho...), f(self.p...),
            f(self.mu...), f(self.surface...), f(self.resolved_strain...), f(self.in_film...);
    }
};

/// What they need of a wall particle.
template <class T, int D>
struct WallFields {
    Mat<T, D> faces;     // normals into the fluid, in rows: of one face, near edges of several
    Vec<T, D> depths;    // below these faces [m]
    Vec<T, D> g_normal;  // of each, see wall_excess_pressure
    Sym<T, D> bend;      // of the surface, see WallState
    Vec<T, D> traction;  // friction of a bed on a fluid particle over V_i W
    Vec<T, D> shear;     // see ResolvedState::bed_shear
    T volume;
    T no_slip;          // 1: fluid sticks to it; 0: what friction there is comes from the wall pass
    T inverse_density;  // of a body that moves, else 0
    Turn<T, D> spin;    // of its body [rad/s]
    // Of the film between faces, see WallState:
    T face, pressure, film_density, film_cover;
    Vec<T, D> film_traction, film_aside;

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.faces...), f(self.depths...), f(self.g_normal...), f(self.bend...);
        f(self.traction...), f(self.shear...), f(self.volume...), f(self.no_slip...),
            f(self.inverse_density...), f(self.spin...), f(self.face...);
        f(self.pressure...), f(self.film_density...), f(self.film_cover...),
            f(self.film_traction...), f(self.film_aside...);
    }
};

template <class real, int D>
using FluidRecord = FluidFields<real, D>;
template <class real, int D>
using WallRecord = WallFields<real, D>;

/// Particle i or j of a pair.
template <class T, int D>
struct FluidPoint : MotionPoint<T, D>, FluidFields<T, D> {};
template <class T, int D>
struct WallPoint : MotionPoint<T, D>, WallFields<T, D> {};

/// How far a wall particle is below the plane of a face [m].
template <class T>
struct FaceDepth {
    T below;

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.below...);
    }
};
template <class T, int D>
struct FacedPoint {
    WallPoint<T, D> wall;
    T below;
};

}  // namespace doseki
