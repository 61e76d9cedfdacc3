#pragma once
// The sums of one fluid particle taken apart: the same sums again, with parts of them left out.

#include <span>

#include "base/array.hpp"
#include "model/force_terms.hpp"
#include "pairs/backend.hpp"
#include "resolved/interactions.hpp"
#include "resolved/model.hpp"
#include "resolved/timestep.hpp"

namespace doseki {

/// What the sums over fluid particles read.
template <int D, class real, class Backend>
struct FluidPass {
    const typename Backend::template Lists<D>& lists;
    CoordinateFrame<real, D> frame;
    FlowRecords<real, D> records;
    const ResolvedModel<D>& model;

    /// The sums of particle p over these records, with the walls of its list or without.
    template <class Kernel>
    ForceAccumulators<double, D> sums_of(std::size_t p, const FlowRecords<real, D>& given,
                                         bool walls) const {
        const std::size_t cluster = p / static_cast<std::size_t>(Backend::width);
        const auto all = lists.clusters()[cluster];
        const Array<typename Backend::template Lists<D>::List> list{walls ? all
                                                                          : all.without_fixed()};
        const PairsOf<Backend, D> pairs{list, records.motion, frame, {.first_cluster = cluster}};
        return sums_of_particle<Backend>(lists, pairs,
                                         ForceTerm<Kernel, real, D>{given, model.constants}, p);
    }

    /// Terms of Eq. (27) for particle p: pressure, viscosity and what shifting makes neighbours
    /// exchange among fluids, and what walls do; and those of Eq. (41).
    template <class Kernel>
    ForceTerms<D> pair_terms(const ResolvedState<D>& state, std::size_t p) const {
        Array<FluidRecord<real, D>> changed(records.fluid_fields.begin(),
                                            records.fluid_fields.end());
        const auto record = converted<FluidFields<double, D>>(records.fluid_fields[p]);
        const auto force = [&](const ForceAccumulators<double, D>& sums) {
            return (1.0 / record.rho) * (pressure_force(sums, record) + 2.0 * sums.force);
        };
        const auto fluid_force = [&] {
            FlowRecords<real, D> given = records;
            given.fluid_fields = changed;
            return force(sums_of<Kernel>(p, given, false));
        };
        const auto all = sums_of<Kernel>(p, records, true);
        const Vec<double, D> fluid = fluid_force();
        for (FluidRecord<real, D>& other : changed) other.carried = {};
        const Vec<double, D> unshifted = fluid_force();
        for (FluidRecord<real, D>& other : changed) other.mu = 0;
        const Vec<double, D> pressure = fluid_force();
        ForceTerms<D> terms;
        terms.acceleration = {
            {"pressure", pressure},
            {"viscosity", unshifted - pressure},
            {"shifting", fluid - unshifted},
            {"walls", force(all) + (1.0 / record.rho) * all.traction - fluid},
        };
        const auto limits = FlowTimestep<D>::of(model, state, all, record, p);
        terms.timestep = {{"the sound speed", limits.acoustic()},
                          {"the acceleration", limits.forced()},
                          {"the viscosity", limits.viscous()}};
        return terms;
    }
};

/// The same with what acts beside pairs.
template <int D, class real, class Backend>
ForceTerms<D> force_terms(const FluidPass<D, real, Backend>& pass, const ResolvedState<D>& state,
                          std::size_t p) {
    const Options<D>& options = pass.model.options;
    ForceTerms<D> terms = options.flow.wide_kernel
                              ? pass.template pair_terms<WendlandC6<D>>(state, p)
                              : pass.template pair_terms<WendlandC2<D>>(state, p);
    const double attraction = options.attraction * options.attraction;
    terms.acceleration.emplace_back("gravity", options.gravity);
    if (attraction > 0.0)
        terms.acceleration.emplace_back("attraction", -attraction * state.position[p]);
    return terms;
}

}  // namespace doseki
