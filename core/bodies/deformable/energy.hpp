#pragma once
// The energy of deformable bodies.

#include "bodies/elastic/advance_bonds.hpp"
#include "bodies/elastic/interactions.hpp"
#include "bodies/elastic/total_lagrangian.hpp"

namespace doseki {

/// Eqs. (80), (83) and (109), in records of their own: those of the last step
/// are what the next one goes on from.
template <int D>
ElasticEnergy TotalLagrangian<D>::elastic_energy(double ahead) const {
    ElasticEnergy sum;
    for (const double held : held_energy_) sum.strain += held;
    if (!stepped_.any()) return sum;
    auto& [place, solid, energy] = energy_rows_;
    place.resize(size()), solid.resize(size()), energy.resize(size());
    stepped_.for_each([&](std::size_t p) {
        place[p] = {x[p] + ahead * v[p], place_[p].volume}, solid[p] = solid_[p], energy[p] = {};
    });
    const ElasticRecords<D> records{motion_, place, solid};
    auto strain = [&](std::size_t p, const Mat<double, D>& F) {
        const DeformableBody& body = body_of(p);
        solid[p].F = F, solid[p].kappa = body.hourglass * body.shear_modulus();
        energy[p].strain = volume(p) * body.energy(F);
    };
    if (bonds_.any()) {
        auto bonded = [&](std::size_t p, const BondedDeformation<double, D>& sums) {
            solid[p].F = identity<double, D>(), solid[p].kappa = 0.0;
            const bool spans = spans_[p] && determines_strain(sums.shape);
            if (spans) strain(p, sums.now.place * inverse(sums.shape, 0.0));
        };
        sum_over_pairs<OnThreads>(BondedDeformationTerm<D>{{records}, bonds_.rows()}, bonded);
    } else {
        auto whole = [&](std::size_t p, const DeformationAccumulators<double, D>& sums) {
            strain(p, sums.place * correction_[p]);
        };
        sum_over_pairs<OnThreads>(DeformationTerm<D>{records}, whole);
    }
    sum_springs(records, [&](std::size_t p, const MisfitMoments<double, D>& sums) {
        energy[p].springs = 0.5 * volume(p) * solid[p].kappa * trace(sums.square);
    });
    for (const std::uint32_t p : stepped_.points())
        if (!gone(p)) sum.strain += energy[p].strain, sum.springs += energy[p].springs;
    return sum;
}

template <int D>
double TotalLagrangian<D>::kinetic_energy() const {
    return stepped_.reduce(0.0, std::plus<>(),
                           [this](std::size_t p) { return 0.5 * mass(p) * dot(v[p], v[p]); });
}

}  // namespace doseki
