#pragma once
#include <algorithm>

#include "base/array.hpp"
#include "model/material.hpp"
#include "model/options.hpp"
#include "model/particles.hpp"

namespace doseki {

/// What the ueta2022 scheme keeps of particles: beside the common fields the deviatoric stress of
/// materials with strength.
template <int D>
struct Ueta2022State : Particles<D> {
    Ueta2022State(const Array<Material>& materials, const Options<D>&)
        : has_strength(std::any_of(materials.begin(), materials.end(),
                                   [](const Material& m) { return m.shear_modulus > 0.0; })) {}

    bool has_strength;                                  // without, the fields below stay empty
    Field<Deviator<double, D>> deviatoric_stress;       // [Pa]
    Field<Deviator<double, D>> deviatoric_stress_rate;  // [Pa/s]

    template <class F>
    void for_each_field(F&& f) {
        this->for_each_common_field(f);
        if (has_strength)
            f("deviatoric_stress", deviatoric_stress),
                f("deviatoric_stress_rate", deviatoric_stress_rate);
    }

    Deviator<double, D> stress(std::size_t p) const {
        return has_strength ? deviatoric_stress[p] : Deviator<double, D>{};
    }
    Deviator<double, D> stress_rate(std::size_t p) const {
        return has_strength ? deviatoric_stress_rate[p] : Deviator<double, D>{};
    }

    void enter(std::size_t p) override {
        if (has_strength) deviatoric_stress[p] = deviatoric_stress_rate[p] = {};
    }
    /// Half a step of all but position and velocity.
    DOSEKI_DEVICE_FN void kick(std::size_t p, double half_dt) {
        this->density[p] += half_dt * this->density_rate[p];
        if (has_strength) add_scaled(deviatoric_stress[p], half_dt, deviatoric_stress_rate[p]);
    }
    /// With which a particle moves.
    DOSEKI_DEVICE_FN Vec<double, D> transport_velocity(std::size_t p) const {
        return this->velocity[p];
    }

    bool has_density(std::size_t) const { return true; }
    /// Not finite where any field is not.
    double sum_of_fields(std::size_t p) const {
        double sum = this->sum_of_common_fields(p);
        for (double element : stress(p).element) sum += element;
        return sum;
    }
};

}  // namespace doseki
