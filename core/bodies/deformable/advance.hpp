#pragma once
// How deformable bodies are stepped, by themselves and among others.

#include "base/array.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "bodies/deformable/deformable_bodies.hpp"
#include "bodies/deformable/internal_forces.hpp"
#include "bodies/deformable/sudden_forces.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "physics/hyperelastic/strain.hpp"
#include "physics/wall.hpp"

namespace doseki {

/// Shift along x that sets a body two supports beyond all before it.
template <int D>
Vec<double, D> TotalLagrangian<D>::room_for(const DeformableBody& body,
                                            std::span<const Vec<double, D>> position) {
    const double margin = 2.0 * body.support();
    double low = std::numeric_limits<double>::max(), high = -low;
    for (const auto& place : position) low = min(low, place[0]), high = max(high, place[0]);
    Vec<double, D> apart{};
    apart[0] = reach_ - low + margin;
    reach_ = high + apart[0] + margin;
    return apart;
}

template <int D>
void TotalLagrangian<D>::start(const Vec<double, D>& gravity, double stable_step) {
    if (size() == 0) return;
    sort();
    stepped_.choose(size(), [](std::uint32_t) { return true; });
    a.assign(size(), {}), load.assign(size(), {}), steady.assign(size(), {});
    deformation_.assign(size(), identity<double, D>());
    motion_.resize(size()), place_.resize(size()), solid_.resize(size()),
        damping_force_.assign(size(), {});
    for (std::size_t p = 0; p < size(); ++p) {
        const DeformableBody& body = body_of(p);
        motion_[p] = {{v[p], mass(p), 1.0 / body.support()}, rest_[p].component};
        const double stiffness = body.hourglass * body.shear_modulus(),
                     viscosity = body.hourglass * body.viscosity();
        place_[p] = {rest_[p], volume(p)};
        solid_[p] = {stiffness, viscosity, {}, {}, {}, {}, {}};
        springs_damp_ |= viscosity > 0.0;
    }
    find_bonds();
    correct_gradients();
    if (bonds_.any()) find_spans();
    sharpest_whole_ = sharpness_.empty() ? 0.0 : std::ranges::max(sharpness_);
    if (stable_step > 0.0)
        stable_step_ = stable_step;
    else
        limit_timestep();
    stepped_.choose(size(), [](std::uint32_t) { return true; });
    compute_accelerations(0.0, gravity);
    if (bonds_.any()) acted_.resize(size()), note_acted();
    choose_stepped();
}

template <int D>
void TotalLagrangian<D>::sort() {
    Array<double> radii(size());
    const Array<std::uint8_t> fixed(size(), 0);
    for (std::size_t p = 0; p < size(); ++p) radii[p] = body_of(p).support();
    const Array<std::uint32_t> order = neighbours_.sort(rest_, radii, fixed);
    auto reorder = [&order](auto& field) {
        auto sorted = field;
        for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = field[order[k]];
        field.swap(sorted);
    };
    reorder(held_shape_), reorder(rest_), reorder(x), reorder(v), reorder(body_), reorder(clamped_),
        reorder(gone_);
    reorder(radii);
    slot_.resize(size());
    for (std::uint32_t k = 0; k < order.size(); ++k) slot_[order[k]] = k;
    number_points();
    OnThreads::Backend::build_lists(neighbours_, std::span<const Vec<double, D>>(rest_),
                                    std::span<const double>(radii), 0.0, {});
}

/// The records hold places at rest, so the deformation they give is what a gradient makes of none.
template <int D>
void TotalLagrangian<D>::correct_gradients() {
    // The matrix is 1 inside; 0 where neighbours do not span the space.
    constexpr double min_determinant = 1e-4;
    correction_.resize(size());
    Array<std::uint8_t> flat(size(), 0);
    auto finish = [&](std::size_t p, const DeformationAccumulators<double, D>& sums) {
        flat[p] = !(determinant(sums.place) > min_determinant);
        correction_[p] = inverse(sums.place, min_determinant);
    };
    sum_over_pairs<OnThreads>(DeformationTerm<D>{records()}, finish);
    for (std::size_t p = 0; p < size(); ++p)
        if (flat[p])
            throw PhysicsFailure("an elastic body is too thin for its spacing of " +
                                     std::to_string(body_of(p).spacing) +
                                     " m: neighbours of a point do not span it",
                                 FailureKind::unresolved);
}

/// Over springs, those of bonds where there are any.
template <int D>
template <class Epilogue>
void TotalLagrangian<D>::sum_springs(const ElasticRecords<D>& records,
                                     const Epilogue& epilogue) const {
    if (bonds_.any())
        sum_over_pairs<OnThreads>(Bonded<SpringTerm<D>>{{records}, bonds_.rows()}, epilogue);
    else
        sum_over_pairs<OnThreads>(SpringTerm<D>{records}, epilogue);
}

/// Calls take(p, force per volume at rest), for velocities predicted half_dt ahead. Bonds are on
/// the processor.
template <int D>
template <class F>
void TotalLagrangian<D>::sum_internal_forces(double half_dt, const F& take) {
    if (!bonds_.any()) return sum_whole_forces(half_dt, take);
    predict<OnThreads>(half_dt);
    update_deformations();
    sum_bonded_forces(take);
}

template <int D>
void TotalLagrangian<D>::compute_accelerations(double half_dt, const Vec<double, D>& gravity) {
    sum_internal_forces(half_dt, AcceleratePoint<D>{spans(), gravity});
}

template <int D>
void TotalLagrangian<D>::internal_accelerations(std::span<Vec<double, D>> accelerations) {
    sum_internal_forces(0.0, InternalAcceleration<D>{spans(), accelerations});
}

template <int D>
BodyStep<D> TotalLagrangian<D>::push(double dt, const Vec<double, D>& gravity) {
    if (bonds_.any())
        push_bonded(dt, gravity);
    else
        compute_accelerations(0.5 * dt, gravity);
    const BodyStep<D> given = push_points(dt, gravity);
    if (!std::isfinite(given.contact_work))  // no load times a way that is not finite is not
        throw PhysicsFailure("an elastic body has lost its shape", FailureKind::not_finite);
    return given;
}

template <int D>
Array<std::uint32_t> TotalLagrangian<D>::neighbours_of(std::size_t p) const {
    Array<std::uint32_t> found;
    for (const std::uint32_t j : pairs_of(p))
        if (body_[j] == body_[p] && gone_[j] == gone_[p]) found.push_back(j);
    return found;
}

template <int D>
Array<std::uint32_t> TotalLagrangian<D>::pairs_of(std::size_t p) const {
    Array<std::uint32_t> found;
    neighbours_.clusters()[p / lanes<double>].for_each_moving([&](std::uint32_t entry) {
        const std::uint32_t j = entry & ListEntry::index_mask;
        const Vec<double, D> apart = rest_[j] - rest_[p];
        if (dot(apart, apart) < body_of(p).support() * body_of(p).support()) found.push_back(j);
    });
    return found;
}

template <int D>
Array<PointShare> TotalLagrangian<D>::carriers(std::size_t p, const Vec<double, D>& offset) const {
    Array<PointShare> shares{{static_cast<std::uint32_t>(p), 1.0}};
    const auto all = [](std::uint32_t) { return true; };
    const Vec<double, D> along = inverse(shape_around(p, all), 0.0) * offset;
    for (const std::uint32_t j : neighbours_of(p)) {
        const Vec<double, D> R = rest_[p] - rest_[j];
        const double share = pair_weight(j, R) * dot(R, along);
        if (j == p || share == 0.0) continue;
        shares[0].share += share;
        shares.push_back({j, -share});
    }
    return shares;
}

template <int D>
template <class Holds>
Mat<double, D> TotalLagrangian<D>::shape_around(std::size_t p, const Holds& holds) const {
    Mat<double, D> shape{};
    for (const std::uint32_t j : neighbours_of(p)) {
        if (j == p || !holds(j)) continue;
        const Vec<double, D> R = rest_[p] - rest_[j];
        add_outer(shape, pair_weight(j, R), R, R);
    }
    return shape;
}

template <int D>
Mat<double, D> TotalLagrangian<D>::motion_around(std::size_t p) const {
    Mat<double, D> moved{};
    for (const std::uint32_t j : neighbours_of(p)) {
        if (j == p) continue;
        const Vec<double, D> R = rest_[p] - rest_[j];
        add_outer(moved, pair_weight(j, R), x[p] - x[j], R);
    }
    return moved * inverse(shape_around(p, [](std::uint32_t) { return true; }), 0.0);
}

template <int D>
void TotalLagrangian<D>::divide(const Division& division) {
    for (const std::int32_t parent : division.parent) {
        const auto k = static_cast<std::size_t>(parent);
        bodies_.push_back(DeformableBody(bodies_[k])), apart_.push_back(Vec<double, D>(apart_[k]));
        rigid_.push_back(0), held_energy_.push_back(0.0);
    }
    for (std::size_t p = 0; p < size(); ++p) {
        if (division.body[p] >= 0)
            body_[p] = division.body[p];
        else if (division.body[p] < -1)
            gone_[p] = clamped_[p] = 1, v[p] = a[p] = {};
    }
    auto apart = [this](std::uint32_t p, std::uint32_t j) {
        return gone(p) || gone(j) || body_[p] != body_[j];
    };
    bonds_.part(apart);
    choose_stepped();
    find_spans(), find_acted();
}

template <int D>
double TotalLagrangian<D>::timestep() const {
    if (!stepped_.any()) return std::numeric_limits<double>::infinity();
    double stiffening = 1.0;
    for (const std::uint32_t p : stepped_.points())
        stiffening = max(stiffening, body_of(p).stiffening(deformation_[p]) * weakening(p));
    return courant * stable_step_ / stiffening;
}

template <int D>
void DeformableBodies<D>::start(Particles<D>& particles, const Vec<double, D>& gravity) {
    if (empty()) return;
    solids_.start(gravity);
    auto sorted = [this](const auto& by_number) {
        auto result = by_number;
        for (std::size_t k = 0; k < by_number.size(); ++k) result[solids_.slot(k)] = by_number[k];
        return result;
    };
    faces_.sort(sorted), rigid_point_ = sorted(rigid_point_);
    surfaces_.start(solids_);
    flow_force_.assign(solids_.size(), {}), acceleration_.assign(solids_.size(), {});
    sudden_.assign(solids_.size(), {}), owed_.assign(solids_.size(), {});
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (has(particles, p))
            particles.set_point(p, BodyKind::deformable, solids_.slot(particles.point(p)));
}

/// The force of this step acts from the next one on, and slowly: if it acted in this one, it would
/// feed vibrations of two steps, and if it were all of the next one, those of one.
template <int D>
void DeformableBodies<D>::end_step(double dt, double memory) {
    const double share = std::min(1.0, dt / memory);
    for (const std::uint32_t k : solids_.stepped().points())
        solids_.steady[k] = solids_.steady[k] - owed_[k], owed_[k] = {};
    solids_.push_by(solids_.steady, -0.5 * dt);
    solids_.follow(flow_force_, 0.5 * share);
    for (const std::uint32_t k : solids_.stepped().points()) {
        if (solids_.clamped(k)) continue;
        const Vec<double, D> kick = (1.0 / solids_.mass(k)) * (flow_force_[k] - sudden_[k]),
                             mean = (1.0 / dt) * (solids_.v[k] - before_[k]) + kick;
        acceleration_[k] = acceleration_[k] + share * (mean - acceleration_[k]);
    }
}

template <int D>
void DeformableBodies<D>::find_sudden_forces() {
    SuddenForces<D>(solids_, flow_force_).split(step_, sudden_);
}

/// Surfaces turn with F^-T; what they stretch is left out.
template <int D>
Vec<double, D> DeformableBodies<D>::turned(std::size_t k, const Vec<double, D>& at_rest) const {
    const Vec<double, D> n = cofactors(solids_.deformation(k)) * at_rest;
    const double square = dot(n, n);
    return square > 0.0 ? std::sqrt(dot(at_rest, at_rest) / square) * n : n;
}

template <int D>
void DeformableBodies<D>::stress(const Particles<D>& particles, std::size_t p, double* out) const {
    const std::size_t k = particles.point(p);
    const Mat<double, D>& F = solids_.deformation(k);
    const Sym<double, D> sigma = cauchy_stress(solids_.stress(k), F);
    std::fill_n(out, 9, 0.0);
    for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) out[3 * a + b] = sigma(std::min(a, b), std::max(a, b));
    if constexpr (D == 2) out[8] = solids_.body_of(k).stress_across(F);
}

}  // namespace doseki
