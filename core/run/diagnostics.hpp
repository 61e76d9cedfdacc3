#pragma once

#include "base/array.hpp"
#include "bodies/bodies.hpp"
#include "model/material.hpp"
#include "model/particles.hpp"
#include "run/any_scheme.hpp"

namespace doseki {

/// What deformable bodies have and have lost; energies [J], 2-D: [J/m].
struct DeformableTotals {
    double elastic_energy = 0.0;                     // of strain and springs
    double fracture_work = 0.0, damping_work = 0.0;  // that cracks and that damping took
    std::int64_t broken_bonds = 0, parts = 0, dust = 0;
};

/// Totals over the particles. Mass, momentum and kinetic energy count free particles; elastic
/// energy counts fixed ones as well, since a bed is compressed too. The energy of bodies is theirs
/// to tell. Driven particles have not entered yet.
template <int D>
struct Totals {
    double mass = 0.0;
    Vec<double, D> momentum{};
    double kinetic_energy = 0.0, bulk_energy = 0.0, shear_energy = 0.0;
    Array<std::int64_t> count;  // free particles per material
    DeformableTotals deformable;
};

template <int D>
DeformableTotals deformable_totals(const Bodies<D>& bodies) {
    const TotalLagrangian<D>& solids = bodies.deformable.solids();
    const PartCounts parts = bodies.parts();
    DeformableTotals sum;
    const ElasticEnergy energy = bodies.deformable.elastic_energy();
    sum.elastic_energy = energy.sum();
    sum.fracture_work = solids.fracture_work();
    sum.damping_work = solids.damping_work();
    sum.broken_bonds = static_cast<std::int64_t>(solids.bonds().broken());
    sum.parts = static_cast<std::int64_t>(parts.bodies);
    sum.dust = static_cast<std::int64_t>(parts.dust);
    return sum;
}

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
