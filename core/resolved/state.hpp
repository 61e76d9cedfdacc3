#pragma once
#include "base/array.hpp"
#include "model/material.hpp"
#include "model/options.hpp"
#include "model/particles.hpp"
#include "model/scheme_work.hpp"
#include "model/step_summary.hpp"

namespace doseki {

/// What the resolved scheme keeps of particles beside the common fields. Gradients and the
/// free-surface indicator are those of the last sums, which the next ones read.
template <int D>
struct ResolvedState : Particles<D> {
    ResolvedState(const Array<Material>&, const Options<D>& options)
        : has_rough_beds(options.flow.has_rough_walls()),
          has_voellmy_beds(options.flow.has_voellmy_walls()) {
        this->wall.in_use = true;
    }

    FluidField<Vec<double, D>> pressure_gradient;  // [Pa/m]
    FluidField<Mat<double, D>> velocity_gradient;  // [1/s]
    /// Inverse of the moment of kernel gradients; zero before a particle has been summed over.
    FluidField<Sym<double, D>> inverse_moment;
    FluidField<Vec<double, D>> shift;     // velocity relative to the fluid [m/s]
    FluidField<double> surface;           // free-surface indicator
    FluidField<double> surface_around;    // the largest of the neighbours
    FluidField<double> parted;            // 1: a void that has not closed, Eq. (144)
    FluidField<double> least_pressure;    // of the outermost particles, Eq. (163) [Pa]
    FluidField<double> in_film;           // share that is part of a film, Eq. (156)
    FluidField<double> mixing_length;     // [m]
    FluidField<double> mean_pressure;     // over a time, where friction depends on it [Pa]
    FluidField<double> damping_pressure;  // see physics/viscosity.hpp [Pa]
    bool has_rough_beds;                  // without, the field below stays empty
    /// Of the law of a rough bed, as far as it adds to viscosity: slope times height [m/s].
    WallField<Vec<double, D>> bed_shear;
    bool has_voellmy_beds;  // without, the fields below stay empty
    /// Of wall particles of Voellmy's beds: stretch of the spring that holds what does not slide.
    WallField<Vec<double, D>> bed_slip;  // [m]
    WallField<double> bed_load;          // normal stress on them, over a time [Pa]

    template <class F>
    void for_each_field(F&& f) {
        this->for_each_common_field(f);
        f("pressure_gradient", pressure_gradient), f("velocity_gradient", velocity_gradient);
        f("inverse_moment", inverse_moment), f("shift", shift), f("surface", surface);
        f("surface_around", surface_around), f("parted", parted);
        f("least_pressure", least_pressure), f("in_film", in_film);
        f("mixing_length", mixing_length), f("mean_pressure", mean_pressure);
        f("damping_pressure", damping_pressure);
        if (has_rough_beds) f("bed_shear", bed_shear);
        if (has_voellmy_beds) f("bed_slip", bed_slip), f("bed_load", bed_load);
    }

    /// Stresses of a fluid are not part of its state.
    Deviator<double, D> stress(std::size_t) const { return {}; }
    Deviator<double, D> stress_rate(std::size_t) const { return {}; }

    /// It counts as one of the surface, which takes no tension, until it has been summed over.
    void enter(std::size_t p) override { surface[p] = 1.0; }
    /// Its density goes a whole step at once, see Resolved.
    DOSEKI_DEVICE_FN void kick(std::size_t, double) {}
    /// With which a particle moves.
    DOSEKI_DEVICE_FN Vec<double, D> transport_velocity(std::size_t p) const {
        return this->velocity[p] + shift[p];
    }

    /// The density of a wall particle means nothing.
    bool has_density(std::size_t p) const { return !this->is_wall(p); }
    /// Not finite where any field is not that a step starts from.
    double sum_of_fields(std::size_t p) const { return this->sum_of_common_fields(p); }
};

/// What an evaluation learns of the fluid.
template <int D>
struct FlowSummary : StepSummary {
    SchemeWork<D> work;

    DOSEKI_DEVICE_FN void add(const FlowSummary& other) {
        StepSummary::add(other);
        work.add(other.work);
    }
};

}  // namespace doseki
