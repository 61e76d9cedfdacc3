#pragma once
// Deformable bodies that may break: their sums over bonds, and the steps of those.

#include "bodies/deformable/advance.hpp"
#include "bodies/elastic/advance_bonds.hpp"
#include "bodies/elastic/settle_bonds.hpp"

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
    stress_.assign(size(), {}), tension_.assign(size(), 0.0);
    spans_.assign(size(), 1), sharpness_.assign(size(), 0.0);
}

/// After bonds were taken out.
template <int D>
void TotalLagrangian<D>::find_spans() {
    auto point = [this](std::size_t p) { return bond_point(p); };
    auto all = [](std::uint32_t) { return true; };
    if (spans_.empty()) return;
    stepped_.for_each([&](std::size_t p) {
        if (!body_of(p).breaks()) return;
        take_shape(p, bonds_.moment(p, point, all));
    });
}

/// Of the bonds that are left of a point.
template <int D>
void TotalLagrangian<D>::take_shape(std::size_t p, const Mat<double, D>& shape) {
    auto point = [this](std::size_t k) { return bond_point(k); };
    spans_[p] = spans_space(shape);
    sharpness_[p] = spans_[p] ? body_of(p).spacing * bonds_.sharpness(p, shape, point) : 0.0;
}

/// By what part waves may be faster at a point than where all bonds are whole: gradients of few
/// neighbours are sharper.
template <int D>
double TotalLagrangian<D>::weakening(std::size_t p) const {
    return sharpest_whole_ > 0.0 ? max(1.0, sharpness_[p] / sharpest_whole_) : 1.0;
}

/// Point p as its bonds see it in a step.
template <int D>
BondPoint<D> TotalLagrangian<D>::bond_point(std::size_t p) const {
    return {
        rest_[p],         place_[p].x,     v[p],       deformation_[p], correction_[p], stress_[p],
        place_[p].volume, solid_[p].kappa, number_[p], spans_[p] != 0};
}

template <int D>
template <class Counts>
double TotalLagrangian<D>::energy_with(std::size_t p, const Counts& counts) const {
    return bonds_.energy_left(
        p, [this](std::size_t k) { return bond_point(k); },
        [this](std::size_t k) -> const DeformableBody& { return body_of(k); },
        [this](std::size_t k) { return x[k]; }, counts);
}

/// The same when forces acted last.
template <int D>
BondPoint<D> TotalLagrangian<D>::acted_point(std::size_t p) const {
    BondPoint<D> point = bond_point(p);
    point.x = acted_[p].x, point.F = acted_[p].F, point.B = acted_[p].B;
    point.P = point.spans ? body_of(p).stress(point.F) : Mat<double, D>{};
    return point;
}

/// As update_point, with the matrix of the bonds that are left. Points whose bonds do not span the
/// space have no stress: what holds them is that of their neighbours.
template <int D>
void TotalLagrangian<D>::update_bonded(std::size_t p,
                                       const DeformationAccumulators<double, D>& sums,
                                       const Mat<double, D>& shape) {
    const DeformableBody& body = body_of(p);
    if (!spans_[p] || !determines_strain(shape)) {
        correction_[p] = {}, deformation_[p] = identity<double, D>();
        stress_[p] = {};
        solid_[p].Q = solid_[p].Q_damping = solid_[p].F_rate = solid_[p].spin = {},
        solid_[p].F = deformation_[p];
        solid_[p].kappa = solid_[p].kappa_rate = 0.0;
        return;
    }
    correction_[p] = inverse(shape, 0.0);
    solid_[p].kappa = body.hourglass * body.shear_modulus();
    solid_[p].kappa_rate = body.hourglass * body.viscosity();
    spans().update(p, sums);
    stress_[p] = stress(p);
}

/// For the places and velocities in the records, of the points in these clusters; none: of all.
template <int D>
void TotalLagrangian<D>::update_deformations(const Array<std::uint32_t>& clusters) {
    auto update = [this](std::size_t p, const BondedDeformation<double, D>& sums) {
        update_bonded(p, sums.now, sums.shape);
    };
    sum_over_pairs<OnThreads>(BondedDeformationTerm<D>{{records()}, bonds_.rows()}, update,
                              clusters.empty() ? stepped_.clusters() : &clusters);
}

/// In which there are points of bonds that have cracks.
template <int D>
Array<std::uint32_t> TotalLagrangian<D>::cracked_clusters() const {
    Array<std::uint8_t> has_cracks(neighbours_.clusters().size(), 0);
    bonds_.for_each_cracked_point(
        [&](std::uint32_t p) { has_cracks[p / static_cast<std::size_t>(lanes<double>)] = 1; });
    Array<std::uint32_t> clusters;
    for (std::uint32_t c = 0; c < has_cracks.size(); ++c)
        if (has_cracks[c] != 0) clusters.push_back(c);
    return clusters;
}

template <int D>
template <class F>
void TotalLagrangian<D>::sum_bonded_forces(const F& take) {
    if (springs_damp_) sum_springs(records(), DampSprings<D>{spans()});
    sum_over_pairs<OnThreads>(Bonded<InternalForceTerm<D>>{{records()}, bonds_.rows()}, take);
}

/// Cracks go on where points are now, and forces act on what they leave: if forces came first, a
/// crack would resist what opens it as a damper does.
template <int D>
void TotalLagrangian<D>::push_bonded(double dt, const Vec<double, D>& gravity) {
    predict<OnThreads>(0.5 * dt);
    update_deformations();
    advance_bonds(dt);
    sum_bonded_forces(AcceleratePoint<D>{spans(), gravity});
    note_acted();
}

template <int D>
void TotalLagrangian<D>::note_acted() {
    stepped_.for_each(
        [this](std::size_t p) { acted_[p] = {place_[p].x, deformation_[p], correction_[p]}; });
}

/// After bonds or bodies were changed, where forces acted last.
template <int D>
void TotalLagrangian<D>::find_acted() {
    if (!bonds_.any()) return;
    stepped_.for_each([this](std::size_t p) { place_[p].x = acted_[p].x; });
    update_deformations();
    note_acted();
}

template <int D>
void TotalLagrangian<D>::advance_bonds(double dt) {
    auto point = [this](std::size_t p) { return bond_point(p); };
    auto body = [this](std::size_t p) -> const DeformableBody& { return body_of(p); };
    stepped_.for_each([this](std::size_t p) {
        tension_[p] = largest_principal(material_stress(deformation_[p], stress_[p])).value;
    });
    Array<std::uint32_t> clusters;
    auto update = [this, &clusters] {
        if (clusters.empty()) clusters = cracked_clusters();
        update_deformations(clusters);
    };
    bonds_.advance(
        dt, point, [this](std::size_t p) { return acted_point(p); }, body,
        [this](std::size_t p) { return tension_[p]; }, update);
    auto place = [this](std::size_t p, double share) {
        return acted_[p].x + share * (place_[p].x - acted_[p].x);
    };
    bonds_.settle(point, body, place,
                  [this](std::size_t p, const Mat<double, D>& shape) { take_shape(p, shape); });
    if (bonds_.change().gone > 0) update();
}

}  // namespace doseki
