#pragma once
// Deformable bodies that may break: their sums over bonds, and the steps of those.

#include "bodies/deformable/advance.hpp"
#include "bodies/elastic/advance_bonds.hpp"

namespace doseki {

/// The bonds are numbered in the order of storage, which a restored state has too.
template <int D>
void TotalLagrangian<D>::find_bonds() {
    bonds_.clear();
    for (std::size_t p = 0; p < size(); ++p) {
        if (!body_of(p).breaks()) continue;
        Array<std::uint32_t> after;
        for (const std::uint32_t j : pairs_of(p))
            if (j > p) after.push_back(j);
        std::sort(after.begin(), after.end());
        for (const std::uint32_t j : after)
            bonds_.add(static_cast<std::uint32_t>(p), j,
                       -WendlandC2<D>::gradient_factor(norm(rest_[p] - rest_[j]),
                                                       1.0 / body_of(p).support()));
    }
    if (!bonds_.any()) return;
    bonds_.index(size());
    for (std::size_t c = 0; c < neighbours_.clusters().size(); ++c) {
        bonds_.begin_cluster();
        neighbours_.clusters()[c].for_each_moving([&](std::uint32_t entry) {
            for (std::size_t lane = 0; lane < static_cast<std::size_t>(lanes<double>); ++lane)
                bonds_.add_code(c * static_cast<std::size_t>(lanes<double>) + lane, size(),
                                entry & ListEntry::index_mask);
        });
    }
    stress_.assign(size(), {}), spans_.assign(size(), 1);
    turned_.assign(size(), 0), energy_.assign(size(), 0.0), released_by_.assign(size(), 0.0);
}

/// As update_point, with the matrix of the bonds that are left. Points whose bonds do not span the
/// space have no stress: what holds them is that of their neighbours.
template <int D>
void TotalLagrangian<D>::update_bonded(std::size_t p,
                                       const DeformationAccumulators<double, D>& sums,
                                       const Mat<double, D>& shape) {
    const DeformableBody& body = body_of(p);
    const bool spanned = spans_[p] != 0;
    spans_[p] = spans_space(shape);
    turned_[p] |= spanned != (spans_[p] != 0);
    if (!spans_[p]) {
        correction_[p] = {}, deformation_[p] = identity<double, D>(), stress_[p] = {};
        solid_[p].Q = solid_[p].F_rate = solid_[p].spin = {}, solid_[p].F = deformation_[p];
        solid_[p].kappa = solid_[p].kappa_rate = damping_power_[p] = 0.0;
        return;
    }
    correction_[p] = inverse(shape, 0.0);
    solid_[p].kappa = body.hourglass * body.shear_modulus();
    solid_[p].kappa_rate = body.hourglass * body.viscosity();
    update_point(p, sums);
    stress_[p] = stress(p);
}

template <int D>
void TotalLagrangian<D>::account_for(std::size_t p, const SpringSums<double, D>& sums) {
    const ElasticRecord<D>& point = solid_[p];
    const double before = energy_[p], strain = spans_[p] ? body_of(p).energy(point.F) : 0.0;
    energy_[p] = point.volume * (strain + 0.5 * point.kappa * trace(sums.moments.square));
    released_by_[p] = turned_[p] ? before - energy_[p] : 0.0;
    turned_[p] = 0;
}

/// For the places and velocities in the records.
template <int D>
void TotalLagrangian<D>::update_deformations() {
    auto update = [this](std::size_t p, const BondedDeformation<double, D>& sums) {
        update_bonded(p, sums.now, sums.shape);
    };
    sum_over_pairs(BondedDeformationTerm<D>{{records()}, bonds_.rows()}, update);
}

template <int D>
template <class F>
void TotalLagrangian<D>::sum_bonded_forces(const F& take) {
    update_deformations();
    damp_springs();
    sum_over_pairs(Bonded<InternalForceTerm<D>>{{records()}, bonds_.rows()}, take);
}

template <int D>
void TotalLagrangian<D>::advance_bonds(double dt) {
    released_ +=
        reduce(size(), 0.0, std::plus<>(), [this](std::size_t p) { return released_by_[p]; });
    auto point = [this](std::size_t p) {
        return BondPoint<D>{rest_[p],         solid_[p].x,     v[p],
                            deformation_[p],  correction_[p],  stress_[p],
                            solid_[p].volume, solid_[p].kappa, number_[p],
                            spans_[p] != 0};
    };
    bonds_.advance(dt, point,
                   [this](std::size_t p) -> const DeformableBody& { return body_of(p); });
    if (bonds_.change().gone > 0) update_deformations();
}

}  // namespace doseki
