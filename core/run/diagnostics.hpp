#pragma once

#include "base/array.hpp"
#include "model/material.hpp"
#include "model/particles.hpp"
#include "run/any_scheme.hpp"

namespace doseki {

/// Totals over the particles. Mass, momentum and kinetic energy count free particles; elastic
/// energy counts fixed ones as well, since a bed is compressed too. The kinetic energy of bodies is
/// theirs to tell. Driven particles have not entered yet.
template <int D>
struct Totals {
    double mass = 0.0;
    Vec<double, D> momentum{};
    double kinetic_energy = 0.0, bulk_energy = 0.0, shear_energy = 0.0;
    Array<std::int64_t> count;  // free particles per material
};

template <class Lists>
Totals<Lists::dim> totals(AnyScheme<Lists>& scheme) {
    const Particles<Lists::dim>& particles = scheme.particles();
    const Array<Material>& materials = scheme.materials();
    Totals<Lists::dim> sum;
    sum.count.assign(materials.size(), 0);
    for (std::size_t p = 0; p < particles.size(); ++p) {
        const Tag& tag = particles.tag[p];
        if (tag.motion == Motion::driven) continue;
        const double m = particles.mass[p], rho = particles.density[p];
        const auto eos = scheme.equation_of_state(p);
        // Where tension is clamped away there is no force, hence no energy.
        if (rho >= materials[tag.material].rho0 || eos.pressure < 0.0)
            sum.bulk_energy += m * eos.bulk_energy;
        if (tag.motion == Motion::fixed) continue;
        sum.shear_energy += scheme.shear_energy(p);
        sum.mass += m;
        sum.momentum = sum.momentum + m * particles.velocity[p];
        if (tag.motion != Motion::bound)
            sum.kinetic_energy += 0.5 * m * dot(particles.velocity[p], particles.velocity[p]);
        ++sum.count[tag.material];
    }
    return sum;
}

}  // namespace doseki
