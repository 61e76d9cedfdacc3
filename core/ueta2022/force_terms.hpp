#pragma once
// The momentum sum of one particle taken apart: the same sum again, with parts of it left out.

#include <span>

#include "model/force_terms.hpp"
#include "model/options.hpp"
#include "pairs/backend.hpp"
#include "physics/timestep.hpp"
#include "ueta2022/interactions.hpp"

namespace doseki {

/// What the momentum sum reads.
template <int D, class real, class Backend>
struct MomentumPass {
    const typename Backend::template Lists<D>& lists;
    std::span<const MotionRecord<real, D>> motion;
    CoordinateFrame<real, D> frame;
    const Options<D>& options;

    /// The sums of particle p, with these stresses and alpha.
    MomentumAccumulators<double, D> sums_of(std::size_t p,
                                            std::span<const StressRecord<real, D>> stress,
                                            double alpha) const {
        const MomentumOptions<real> constants{static_cast<real>(alpha), options.fixed_limits_dt};
        const std::size_t cluster = p / static_cast<std::size_t>(Backend::width);
        const PairsOf<Backend, D> pairs{
            lists.clusters().subspan(cluster, 1), motion, frame, {.first_cluster = cluster}};
        return sums_of_particle<Backend>(
            lists, pairs, MomentumTerm<GradientOf::mean_h, real, D>{motion, stress, constants}, p);
    }
};

/// Eqs. (12) and (18) of particle p, of smoothing length h. `pressure`: the stress records with the
/// isotropic part of the stress alone.
template <int D, class real, class Backend>
ForceTerms<D> force_terms(const MomentumPass<D, real, Backend>& pass,
                          std::span<const StressRecord<real, D>> stress,
                          std::span<const StressRecord<real, D>> pressure, std::size_t p,
                          double h) {
    const Options<D>& options = pass.options;
    const auto all = pass.sums_of(p, stress, options.alpha);
    const auto inviscid = pass.sums_of(p, stress, 0.0);
    const auto isotropic = pass.sums_of(p, pressure, 0.0);
    ForceTerms<D> terms;
    terms.acceleration = {
        {"pressure", isotropic.acceleration},
        {"deviatoric_stress", inviscid.acceleration - isotropic.acceleration},
        {"artificial_viscosity", all.acceleration - inviscid.acceleration},
        {"gravity", options.gravity},
    };
    const Vec<double, D> a = terms.total_acceleration();
    const double v_sig = max(all.max_v_sig, 2.0 * static_cast<double>(stress[p].c));
    terms.timestep = {
        {"the signal velocity", acoustic_timestep(h, v_sig, options.cflnumber)},
        {"the acceleration", force_timestep(h, sqrt(dot(a, a)), options.cfl_force)},
    };
    return terms;
}

}  // namespace doseki
