// The pair sums and the point physics as device code: thread i meets one j after another, in the order
// of its list. Compiled as a check that the shared sources stay fit for a device; no back end yet.

#include <cstddef>

#include "pair_sums.hpp"
#include "physics/equation_of_state.hpp"
#include "physics/stress.hpp"
#include "physics/timestep.hpp"

namespace doseki {

/// Lists by rows: the neighbours of i are entries[starts[i]] to entries[starts[i + 1]].
struct DeviceLists {
    const std::uint32_t* starts;
    const std::uint32_t* entries;
};

template <class real, int D>
__device__ Pair<real, D> pair_between(const MotionRecord<real, D>& i, const MotionRecord<real, D>& j, real unit) {
    Pair<real, D> pair;
    for (int a = 0; a < D; ++a) pair.r_ij[a] = static_cast<real>(i.x[a] - j.x[a]) * unit;
    pair.r = sqrt(max(dot(pair.r_ij, pair.r_ij), std::numeric_limits<real>::min()));
    return pair;
}

template <class real, int D>
__global__ void sum_velocity_gradient(const MotionRecord<real, D>* motion, DeviceLists lists, real unit,
                                      std::uint32_t count, Mat<real, D>* gradients) {
    const std::uint32_t p = blockIdx.x * blockDim.x + threadIdx.x;
    if (p >= count) return;
    const auto i = motion_point<real>(motion[p]);
    Mat<real, D> gradient{};
    for (std::uint32_t k = lists.starts[p]; k < lists.starts[p + 1]; ++k) {
        const auto& record = motion[lists.entries[k]];
        VelocityGradientSum<GradientOf::own_h, D>::add(gradient, pair_between(motion[p], record, unit), i,
                                                       motion_point<real>(record));
    }
    gradients[p] = gradient;
}

template <class real, int D>
__global__ void sum_momentum(const MotionRecord<real, D>* motion, const StressRecord<real, D>* stress,
                             DeviceLists moving, DeviceLists fixed, MomentumOptions<real> options, real unit,
                             std::uint32_t count, MomentumSums<real, D>* results) {
    using Sum = MomentumSum<GradientOf::mean_h, real, D>;
    const std::uint32_t p = blockIdx.x * blockDim.x + threadIdx.x;
    if (p >= count) return;
    const auto i = stress_point<real>(motion[p], stress[p]);
    MomentumSums<real, D> sums;
    for (std::uint32_t k = moving.starts[p]; k < moving.starts[p + 1]; ++k) {
        const std::uint32_t j = moving.entries[k];
        Sum::add(sums, options, pair_between(motion[p], motion[j], unit), i, stress_point<real>(motion[j], stress[j]));
    }
    Sum::moving_done(sums);
    for (std::uint32_t k = fixed.starts[p]; k < fixed.starts[p + 1]; ++k) {
        const std::uint32_t j = fixed.entries[k];
        Sum::add_fixed(sums, options, pair_between(motion[p], motion[j], unit), i,
                       stress_point<real>(motion[j], stress[j]));
    }
    results[p] = sums;
}

/// Every function of the point physics, once: values that the compiler may not drop.
template <class T, int D>
struct PointPhysics {
    Mat<T, D> L;
    Deviator<T, D> S;
    T rho, rho0, c0, shear_modulus, nu, h;
    Deviator<T, D> rate, newtonian;
    Sym<T, D> stress;
    T balsara, energy, kernel, dt;
};

template <class T, int D>
__global__ void point_physics(PointPhysics<T, D>* points, std::uint32_t count) {
    const std::uint32_t p = blockIdx.x * blockDim.x + threadIdx.x;
    if (p >= count) return;
    PointPhysics<T, D>& point = points[p];
    const auto state = BirchMurnaghan<T>::at(point.rho, point.rho0, point.c0);
    point.rate = elastic_stress_rate(point.L, point.S, point.shear_modulus);
    point.newtonian = newtonian_stress(point.L, point.rho, point.nu);
    point.stress = stress_over_rho_squared(state.pressure, point.S, point.rho);
    point.balsara = balsara_switch(point.L, state.sound_speed, point.h);
    point.energy = state.bulk_energy + shear_energy(point.S, point.shear_modulus, point.rho);
    point.kernel = WendlandC6<D>::value(point.h, T(1) / point.h);
    point.dt = timestep(point.h, state.sound_speed, point.c0, T(1), T(1));
}

#define DOSEKI_INSTANTIATE(real, D)                                                                         \
    template __global__ void sum_velocity_gradient(const MotionRecord<real, D>*, DeviceLists, real,         \
                                                   std::uint32_t, Mat<real, D>*);                           \
    template __global__ void sum_momentum(const MotionRecord<real, D>*, const StressRecord<real, D>*,       \
                                          DeviceLists, DeviceLists, MomentumOptions<real>, real,            \
                                          std::uint32_t, MomentumSums<real, D>*);                           \
    template __global__ void point_physics(PointPhysics<real, D>*, std::uint32_t);

DOSEKI_INSTANTIATE(double, 2)
DOSEKI_INSTANTIATE(double, 3)
DOSEKI_INSTANTIATE(float, 2)
DOSEKI_INSTANTIATE(float, 3)

}  // namespace doseki
