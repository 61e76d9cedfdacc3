#pragma once
// What the ueta2022 scheme does for each particle: before its sums, between them and after them.

#include <cmath>
#include <cstdint>
#include <span>

#include "model/step_summary.hpp"
#include "physics/stress.hpp"
#include "physics/timestep.hpp"
#include "ueta2022/accumulators.hpp"
#include "ueta2022/model.hpp"
#include "ueta2022/state.hpp"

namespace doseki {

/// Fills the record of a particle with what its state will be after `half_dt`; whether its
/// smoothing length is h0.
template <class real, int D>
struct MotionPacker {
    const Ueta2022Model<D>& model;
    Ueta2022State<D>& particles;
    std::span<MotionRecord<real, D>> motion;
    CoordinateFrame<real, D> frame;
    double half_dt, h0;

    DOSEKI_DEVICE_FN bool operator()(std::size_t p) const {
        MotionRecord<real, D>& record = motion[p];
        for (int a = 0; a < D; ++a) {
            record.x[a] = frame.coordinate(particles.position[p][a], a);
            record.v[a] = static_cast<real>(particles.velocity[p][a] +
                                            half_dt * particles.acceleration[p][a]);
        }
        const double rho = particles.density[p] + half_dt * particles.density_rate[p];
        double& h = particles.smoothing_length[p];
        if (model.options.h_mode == SmoothingLengthMode::eq10)
            h = smoothing_length<D>(model.options.eta, particles.mass[p], rho,
                                    model.materials[particles.tag[p].material].rho0);
        record.mass = static_cast<real>(particles.mass[p]);
        record.inverse_support = static_cast<real>(1.0 / (WendlandC6<D>::support * h));
        return h == h0;
    }
};

/// Between the passes: Eqs. (11), (8), (4) or (7) and Balsara's switch of one particle.
template <class real, int D>
struct StressEpilogue {
    const Ueta2022Model<D>& model;
    Ueta2022State<D>& particles;
    std::span<StressRecord<real, D>> records;
    std::span<StepSummary> summaries;
    double half_dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t p, Mat<double, D> L) const {
        const Tag& tag = particles.tag[p];
        const Material& material = model.materials[tag.material];
        const double rho = particles.density[p] + half_dt * particles.density_rate[p];
        for (double& element : L.element) element /= rho;

        const auto eos = model.equation_of_state(tag, rho);
        summary_of<real>(summaries, p).fault.note_density(rho, material.rho0, p);
        Deviator<double, D> stress{}, rate{};
        if (tag.motion == Motion::free) {
            if (material.law == Law::fluid) {
                const ShearState<double> state{strain_rate(L), eos.pressure, rho};
                stress = viscous_stress(L, viscosity(*material.laws, state));
            } else if (material.shear_modulus > 0.0) {
                stress = particles.deviatoric_stress[p];
                add_scaled(stress, half_dt, particles.deviatoric_stress_rate[p]);
                if (model.yields)
                    stress = return_map(stress, eos.pressure, model.surfaces[tag.material]);
                rate = elastic_stress_rate(L, stress, material.shear_modulus);
            }
        }
        particles.density_rate[p] = density_rate(material, tag.motion, rho, L);
        if (particles.has_strength) particles.deviatoric_stress_rate[p] = rate;

        const auto scaled = stress_over_rho_squared(eos.pressure, stress, rho);
        StressRecord<real, D>& record = records[p];
        for (int k = 0; k < Sym<real, D>::size; ++k)
            record.stress.element[k] = static_cast<real>(scaled.element[k]);
        record.rho = static_cast<real>(rho);
        record.c = static_cast<real>(eos.sound_speed);
        const double switched =
            model.options.balsara
                ? balsara_switch(L, eos.sound_speed, particles.smoothing_length[p])
                : 1.0;
        record.balsara = static_cast<real>(switched);
    }
};

/// Accelerations and timesteps, Eqs. (12) and (18).
template <class real, int D>
struct MomentumEpilogue {
    const Ueta2022Model<D>& model;
    Ueta2022State<D>& particles;
    std::span<const StressRecord<real, D>> records;
    std::span<StepSummary> summaries;

    DOSEKI_DEVICE_FN void operator()(std::size_t p,
                                     const MomentumAccumulators<double, D>& sums) const {
        if (!particles.is_free(p)) {
            particles.acceleration[p] = {};
            return;
        }
        const Vec<double, D> a = sums.acceleration + model.options.gravity;
        particles.acceleration[p] = a;
        const double v_sig = max(sums.max_v_sig, 2.0 * static_cast<double>(records[p].c));
        StepSummary& summary = summary_of<real>(summaries, p);
        summary.power += particles.mass[p] * sums.av_power;
        summary.limit(timestep(particles.smoothing_length[p], v_sig, sqrt(dot(a, a)),
                               model.options.cflnumber, model.options.cfl_force),
                      static_cast<std::int64_t>(p));
        summary.fault.note_right_hand_side(dot(a, a) + particles.density_rate[p], p);
    }
};

/// Eq. (63), once a step is complete.
template <int D>
struct StressReturn {
    const Ueta2022Model<D>& model;
    Ueta2022State<D>& particles;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        const Tag& tag = particles.tag[p];
        const YieldSurface<double>& surface = model.surfaces[tag.material];
        if (particles.is_free(p) && std::isfinite(surface.k))
            particles.deviatoric_stress[p] =
                return_map(particles.deviatoric_stress[p],
                           model.equation_of_state(tag, particles.density[p]).pressure, surface);
    }
};

/// Of the stress of a record, the pressure alone.
template <class real, int D>
struct IsotropicStress {
    const Ueta2022Model<D>& model;
    const Ueta2022State<D>& particles;
    std::span<const StressRecord<real, D>> records;
    std::span<StressRecord<real, D>> isotropic;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        const double rho = static_cast<double>(records[p].rho);
        const Sym<double, D> stress = stress_over_rho_squared(
            model.equation_of_state(particles.tag[p], rho).pressure, Deviator<double, D>{}, rho);
        for (int k = 0; k < Sym<real, D>::size; ++k)
            isotropic[p].stress.element[k] = static_cast<real>(stress.element[k]);
    }
};

}  // namespace doseki
