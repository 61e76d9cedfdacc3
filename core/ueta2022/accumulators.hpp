#pragma once
// What the ueta2022 scheme sums over pairs, and what one pair adds: numbers in, numbers out, so
// that one source serves packs on a processor and one thread for each particle on a device.

#include "physics/kernel/wendland_c6.hpp"
#include "physics/momentum.hpp"
#include "physics/velocity_gradient.hpp"
#include "ueta2022/records.hpp"

namespace doseki {

/// Where a kernel gradient is taken: with the h of i alone, as Eq. (9) is printed, or as the mean
/// over h_i and h_j, as Eq. (12) is.
enum class GradientOf { own_h, mean_h };

template <GradientOf of, int D, class T>
DOSEKI_FN T gradient_factor(const T& r, const MotionPoint<T, D>& i, const MotionPoint<T, D>& j) {
    const T own = WendlandC6<D>::gradient_factor(r, i.inverse_support);
    if constexpr (of == GradientOf::own_h)
        return own;
    else
        return number<T>(0.5) * (own + WendlandC6<D>::gradient_factor(r, j.inverse_support));
}

template <class real>
struct MomentumOptions {
    real alpha;
    bool fixed_limits_dt;  // false: in Eq. (18) a fixed j has at most the sound speed of i
};

template <class T, int D>
struct MomentumAccumulators {
    Vec<T, D> acceleration{};
    T av_power{};  // per mass of i
    T max_v_sig{};

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.acceleration...), f(self.av_power...), f(self.max_v_sig...);
    }
};

/// Eqs. (12)-(16), with the largest signal velocity for Eq. (18) and the power that the artificial
/// viscosity takes out of the moving particles. `spared`: the part of the signal velocity that does
/// not limit the timestep.
template <GradientOf of, class T, class real, int D>
DOSEKI_FN void add_momentum(MomentumAccumulators<T, D>& sums, const MomentumOptions<real>& options,
                            const Pair<T, D>& pair, const MomentumPoint<T, D>& i,
                            const MomentumPoint<T, D>& j, const T& spared) {
    const T F = gradient_factor<of, D>(pair.r, i, j);
    const T v_dot_r = dot(i.v - j.v, pair.r_ij);
    const T w_ij = approach_speed(v_dot_r, pair.r);
    const T v_sig = signal_velocity(i.c, j.c, w_ij);
    const T switched = number<T>(0.5) * (i.balsara + j.balsara);
    const T Pi_ij = switched * artificial_viscosity(T(options.alpha), v_sig, w_ij, i.rho, j.rho);
    add_acceleration(sums.acceleration, j.mass, i.stress + j.stress, Pi_ij, F, pair.r_ij);
    sums.av_power += (j.mass * F) * (Pi_ij * v_dot_r);
    sums.max_v_sig = max(sums.max_v_sig, select(F < T(0), v_sig - spared, T(0)));
}

}  // namespace doseki
