#pragma once
// What the parts of the resolved scheme share: materials, options, and what follows from them once.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/array.hpp"
#include "model/material.hpp"
#include "model/material_laws.hpp"
#include "model/options.hpp"
#include "physics/free_surface.hpp"
#include "physics/kernel/wendland_c2.hpp"
#include "physics/kernel/wendland_c6.hpp"
#include "resolved/accumulators.hpp"
#include "resolved/state.hpp"

namespace doseki {

/// Relaxation times [h/c] of the integrated density towards the summation density: the least, in
/// flow, and the greatest, at rest.
inline constexpr double density_relaxation = 100.0, density_relaxation_at_rest = 1000.0;

/// The rate at which viscosity damps the motion in which neighbours go against each other, over the
/// sum of its coefficients at one particle, and what the largest of these adds to it: 1.33 of the
/// sum on a square lattice, 1.15 on a cubic one. Of two particles that nearly meet it is twice
/// their own coefficient and once the others.
inline constexpr double roughest_over_own = 1.4, nearest_over_own = 0.6;
/// The same for a form along the line of the pair, over its factor: rows that go against each other
/// in turns feel more of it than the mean over directions, 1/D. By dimension.
inline constexpr std::array rough_share{0.0, 0.0, 0.7, 0.5};

/// The time over which Voellmy's friction takes the mean of the normal stress on a bed, over the
/// time that sound takes through the depth of which that stress is the weight.
inline constexpr double bed_load_crossings = 1.5;

/// Densities below which a fluid expands no further: what tears apart leaves a void, not water
/// under tension.
struct MinDensity {
    double in_flow;
    double where_vented;  // at bodies that move: where they part, air or, in 2-D, water comes in
                          // from the third dimension; and at edges of walls near a free surface

    DOSEKI_DEVICE_FN double at(bool vented) const { return vented ? where_vented : in_flow; }
    static MinDensity of(const Material& fluid) {
        auto density_at = [&fluid](double pressure) {
            const double rho0 = fluid.rho0;
            return density_of(*fluid.laws, pressure, least_relative_density * rho0, rho0);
        };
        return {density_at(fluid.cavitation_pressure),
                density_at(std::max(fluid.cavitation_pressure, -fluid.air_entry_suction))};
    }
};

/// What the liquids of a run ask for together, as any of them may meet.
struct Liquids {
    static constexpr double none = std::numeric_limits<double>::infinity();

    double c = 0.0, suction = 0.0;           // the greatest
    double lightest = none, stiffest = 0.0;  // density, and rho c^2 [Pa]
    double thinnest = none, thickest = 0.0;  // viscosity without motion [Pa s]
    PairViscosity viscosity{};               // of pairs, as laws ask for it

    void add(const Material& liquid) {
        const double rho = liquid.rho0, mu = doseki::viscosity(*liquid.laws, {0.0, 0.0, rho});
        c = std::max(c, liquid.c0), suction = std::max(suction, liquid.air_entry_suction);
        lightest = std::min(lightest, rho),
        stiffest = std::max(stiffest, rho * liquid.c0 * liquid.c0);
        thinnest = std::min(thinnest, mu), thickest = std::max(thickest, mu);
        viscosity = std::max(viscosity, viscosity_of_pairs(*liquid.laws));
    }
    /// Stress is continuous between liquids of different viscosity, and the mean of the two is not
    /// the viscosity of a layer of both.
    PairViscosity of_pairs() const {
        const bool differ = viscosity == PairViscosity::mean && thinnest < thickest;
        return differ ? PairViscosity::harmonic : viscosity;
    }
    /// The greatest C_CFL with which a light particle among heavy ones does not swing ever more:
    /// what pushes it back is as stiff as they are. On lattices 2.2 is stable yet, and 2.5 is not.
    double greatest_cfl() const {
        constexpr double stable = 2.0;
        return stiffest > 0.0 ? stable * c * std::sqrt(lightest / stiffest) : none;
    }
};

template <int D>
struct ResolvedModel {
    Array<Material> materials;
    Array<MinDensity> min_density;  // of each material that is a fluid
    Options<D> options;
    FlowConstants constants{};
    double lattice_concentration = 1.0, own_concentration = 0.0;  // of that, a particle's own
    double own_gradient_factor = 0.0;                             // of a particle with itself
    FullCover full_cover;
    FlatArea flat_area;
    PairArea pair_area;
    NarrowGap narrow_gap;
    std::array<double, D + 1> spacing_power{1.0};  // dp^k

    ResolvedModel(Array<Material> given, const Options<D>& opts)
        : materials(std::move(given)), options(opts) {
        Liquids liquids;
        for (const Material& material : materials) {
            const bool fluid = material.law == Law::fluid;
            min_density.push_back(fluid ? MinDensity::of(material) : MinDensity{});
            if (fluid) liquids.add(material);
        }
        constants.c = liquids.c, constants.suction = liquids.suction;
        constants.viscosity = liquids.of_pairs();
        options.cflnumber = std::min(options.cflnumber, liquids.greatest_cfl());
        const FlowOptions& flow = options.flow;
        constants.dp = flow.dp;
        for (int k = 1; k <= D; ++k) spacing_power[k] = spacing_power[k - 1] * flow.dp;
        const double support = kernel_support() * options.eta * flow.dp;
        const auto lattice = flow.wide_kernel ? lattice_sums<WendlandC6<D>, D>(flow.dp, support)
                                              : lattice_sums<WendlandC2<D>, D>(flow.dp, support);
        lattice_concentration = lattice.concentration;
        own_concentration = lattice.own_share;
        full_cover = flow.wide_kernel ? FullCover::of<WendlandC6<D>, D>(flow.dp, support)
                                      : FullCover::of<WendlandC2<D>, D>(flow.dp, support);
        narrow_gap = flow.wide_kernel ? NarrowGap::of<WendlandC6<D>, D>(flow.dp, support)
                                      : NarrowGap::of<WendlandC2<D>, D>(flow.dp, support);
        const double scale = constants.gradient_scale = 1.0 / lattice.moment;
        flat_area = flow.wide_kernel ? FlatArea::of<WendlandC6<D>, D>(flow.dp, support, scale)
                                     : FlatArea::of<WendlandC2<D>, D>(flow.dp, support, scale);
        pair_area = flow.wide_kernel ? PairArea::of<WendlandC6<D>>(support, scale)
                                     : PairArea::of<WendlandC2<D>>(support, scale);
        own_gradient_factor = flow.wide_kernel ? own_factor<WendlandC6<D>>(constants, support)
                                               : own_factor<WendlandC2<D>>(constants, support);
        constants.exchange = 1.0 / (lattice.concentration - lattice.own_share);
        constants.form = ViscousForm<double>::of(flow.viscosity, D);
        const double directions =
            constants.form.along_jump + rough_share[D] * constants.form.along_pair;
        constants.roughest = 2.0 * roughest_over_own * directions;
        constants.nearest = 2.0 * nearest_over_own * directions;
    }

    template <class Kernel>
    static double own_factor(const FlowConstants& constants, double support) {
        return gradient_factor<Kernel>(constants, 1.0 / support, 0.0);
    }

    DOSEKI_DEVICE_FN double kernel_support() const {
        return options.flow.wide_kernel ? WendlandC6<D>::support : WendlandC2<D>::support;
    }
    DOSEKI_DEVICE_FN const Material& material(const Tag& tag) const {
        return materials[tag.material];
    }
    DOSEKI_DEVICE_FN const WallCondition& wall_condition(const Tag& tag) const {
        return options.flow.walls[static_cast<std::size_t>(tag.body)];
    }
    bool has_bed_friction() const {
        return std::any_of(options.flow.walls.begin(), options.flow.walls.end(),
                           [](const WallCondition& wall) { return wall.has_friction(); });
    }

    /// Tension holds inside. A free surface takes none, so that the particles along it take what
    /// lies between it and them, and what has parted there takes none at all.
    DOSEKI_DEVICE_FN static double without_surface_tension(double p, const ResolvedState<D>& state,
                                                           std::size_t i) {
        if (state.parted[i] > 0.0) return std::max(0.0, p);
        return state.surface[i] > FreeSurfaceIndicator::surface
                   ? std::max(state.least_pressure[i], p)
                   : p;
    }

    /// rho l^2 |D| of Smagorinsky, or of Prandtl's mixing length, over rho [m^2/s].
    DOSEKI_DEVICE_FN double eddy_viscosity(const ResolvedState<D>& state, std::size_t p) const {
        const FlowOptions& flow = options.flow;
        if (flow.turbulence == Turbulence::none) return 0.0;
        const double l = flow.turbulence == Turbulence::mixing_length ? state.mixing_length[p]
                                                                      : flow.smagorinsky * flow.dp;
        return l * l * strain_rate(state.velocity_gradient[p]);
    }
    /// Of a liquid, and of the eddies that are not resolved [Pa s].
    DOSEKI_DEVICE_FN double viscosity(const ResolvedState<D>& state, std::size_t p) const {
        const double rho = state.density[p], rate = strain_rate(state.velocity_gradient[p]);
        const ShearState<double> shear{rate, state.mean_pressure[p], rho};
        return doseki::viscosity(*material(state.tag[p]).laws, shear) +
               rho * eddy_viscosity(state, p);
    }
};

}  // namespace doseki
