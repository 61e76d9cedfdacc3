// The pair terms and the point physics as device code: thread i meets one j after another, in the
// order of its list. Compiled as a check that the shared sources stay fit for a device; there is no
// device back end (pairs/backend.hpp) yet.

#include <cstddef>

#include "physics/equation_of_state.hpp"
#include "physics/rheology.hpp"
#include "physics/stress.hpp"
#include "physics/timestep.hpp"
#include "physics/viscosity.hpp"
#include "ueta2022/interactions.hpp"

namespace doseki {

/// Lists by rows: the neighbours of i are entries[starts[i]] to entries[starts[i + 1]].
struct DeviceLists {
    const std::uint32_t* starts;
    const std::uint32_t* entries;
};

template <class real, int D>
__device__ Pair<real, D> pair_between(const MotionRecord<real, D>& i,
                                      const MotionRecord<real, D>& j, real unit) {
    Pair<real, D> pair;
    for (int a = 0; a < D; ++a) pair.r_ij[a] = static_cast<real>(i.x[a] - j.x[a]) * unit;
    pair.r = sqrt(max(dot(pair.r_ij, pair.r_ij), std::numeric_limits<real>::min()));
    return pair;
}

/// What the pair loop does for one particle, with any term.
template <class Term>
__device__ auto sum_over_lists(const Term& term, DeviceLists moving, DeviceLists fixed,
                               typename Term::Real unit, std::uint32_t p) {
    using real = typename Term::Real;
    const auto i = term.load(OneRow<real>{p});
    typename Term::template Accumulators<real> sums{};
    for (std::uint32_t k = moving.starts[p]; k < moving.starts[p + 1]; ++k) {
        const std::uint32_t j = moving.entries[k];
        term.add(sums, pair_between(term.motion[p], term.motion[j], unit), i,
                 term.load_moving(OneRow<real>{j}));
    }
    if constexpr (requires { term.after_moving(sums); }) term.after_moving(sums);
    for (std::uint32_t k = fixed.starts[p]; k < fixed.starts[p + 1]; ++k) {
        const std::uint32_t j = fixed.entries[k];
        term.add_fixed(sums, pair_between(term.motion[p], term.motion[j], unit), i,
                       term.load_fixed(OneRow<real>{j}));
    }
    return sums;
}

template <class real, int D>
__global__ void sum_velocity_gradient(VelocityGradientTerm<GradientOf::own_h, real, D> term,
                                      DeviceLists moving, DeviceLists fixed, real unit,
                                      std::uint32_t count, Mat<real, D>* results) {
    const std::uint32_t p = blockIdx.x * blockDim.x + threadIdx.x;
    if (p < count) results[p] = sum_over_lists(term, moving, fixed, unit, p);
}

template <class real, int D>
__global__ void sum_momentum(MomentumTerm<GradientOf::mean_h, real, D> term, DeviceLists moving,
                             DeviceLists fixed, real unit, std::uint32_t count,
                             MomentumAccumulators<real, D>* results) {
    const std::uint32_t p = blockIdx.x * blockDim.x + threadIdx.x;
    if (p < count) results[p] = sum_over_lists(term, moving, fixed, unit, p);
}

/// Every function of the point physics, once: values that the compiler may not drop.
template <class T, int D>
struct PointPhysics {
    Mat<T, D> L;
    Deviator<T, D> S;
    EquationOfState<T> eos;
    Rheology<T> rheology;
    T rho, c0, shear_modulus, h;
    Deviator<T, D> rate, viscous;
    Sym<T, D> stress;
    T balsara, energy, kernel, dt;
};

template <class T, int D>
__global__ void point_physics(PointPhysics<T, D>* points, std::uint32_t count) {
    const std::uint32_t p = blockIdx.x * blockDim.x + threadIdx.x;
    if (p >= count) return;
    PointPhysics<T, D>& point = points[p];
    const auto state = thermodynamic_state(point.eos, point.rho);
    point.rate = elastic_stress_rate(point.L, point.S, point.shear_modulus);
    const ShearState<T> shear{strain_rate(point.L), state.pressure, point.rho};
    point.viscous = viscous_stress(point.L, viscosity(point.rheology, shear));
    point.stress = stress_over_rho_squared(state.pressure, point.S, point.rho);
    point.balsara = balsara_switch(point.L, state.sound_speed, point.h);
    point.energy = state.bulk_energy + shear_energy(point.S, point.shear_modulus, point.rho);
    point.kernel = WendlandC6<D>::value(point.h, T(1) / point.h);
    point.dt = timestep(point.h, state.sound_speed, point.c0, T(1), T(1));
}

#define DOSEKI_INSTANTIATE(real, D)                                                               \
    template __global__ void sum_velocity_gradient(                                               \
        VelocityGradientTerm<GradientOf::own_h, real, D>, DeviceLists, DeviceLists, real,         \
        std::uint32_t, Mat<real, D>*);                                                            \
    template __global__ void sum_momentum(MomentumTerm<GradientOf::mean_h, real, D>, DeviceLists, \
                                          DeviceLists, real, std::uint32_t,                       \
                                          MomentumAccumulators<real, D>*);                        \
    template __global__ void point_physics(PointPhysics<real, D>*, std::uint32_t);

DOSEKI_INSTANTIATE(double, 2)
DOSEKI_INSTANTIATE(double, 3)
DOSEKI_INSTANTIATE(float, 2)
DOSEKI_INSTANTIATE(float, 3)

}  // namespace doseki
