#pragma once
#include <vector>

#include "particles.hpp"
#include "physics/stress.hpp"

namespace doseki {

/// Totals over the particles. Mass, momentum and kinetic energy count free particles; elastic
/// energy counts fixed ones as well, since a bed is compressed too. The kinetic energy of bodies is
/// theirs to tell. Driven particles have not entered yet.
template <int D>
struct Totals {
    double mass = 0.0;
    Vec<double, D> momentum{};
    double kinetic_energy = 0.0, bulk_energy = 0.0, shear_energy = 0.0;
    std::vector<std::int64_t> count;  // free particles per material
};

template <class Scheme, int D>
Totals<D> totals(const Particles<D>& particles, const Scheme& scheme) {
    const std::vector<Material>& materials = scheme.materials();
    Totals<D> sum;
    sum.count.assign(materials.size(), 0);
    for (std::size_t p = 0; p < particles.size(); ++p) {
        const Tag& tag = particles.tag[p];
        if (tag.motion == Motion::driven) continue;
        const Material& material = materials[tag.material];
        const double m = particles.mass[p], rho = particles.density[p];
        const auto eos = scheme.thermodynamics(particles, p);
        // Where tension is clamped away there is no force, hence no energy.
        if (rho >= material.rho0 || eos.pressure < 0.0) sum.bulk_energy += m * eos.bulk_energy;
        if (tag.motion == Motion::fixed) continue;
        if (particles.has_strength && material.shear_modulus > 0.0)
            sum.shear_energy +=
                m * shear_energy(particles.deviatoric_stress[p], material.shear_modulus, rho);
        sum.mass += m;
        sum.momentum = sum.momentum + m * particles.velocity[p];
        if (tag.motion != Motion::bound)
            sum.kinetic_energy += 0.5 * m * dot(particles.velocity[p], particles.velocity[p]);
        ++sum.count[tag.material];
    }
    return sum;
}

}  // namespace doseki
