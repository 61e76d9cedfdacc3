#pragma once
// Steps of all cracks together.

#include "bodies/elastic/bond_step.hpp"

namespace doseki {

template <int D>
void Bonds<D>::index(std::size_t points) {
    first_bond_.assign(points + 1, 0), tip_.assign(points, {});
    for (std::size_t n = 1; n < size(); ++n)
        ++first_bond_[pairs_[n].a + 1], ++first_bond_[pairs_[n].b + 1];
    for (std::size_t p = 0; p < points; ++p) first_bond_[p + 1] += first_bond_[p];
    bond_.assign(first_bond_[points], 0);
    Array<std::size_t> next(first_bond_.begin(), first_bond_.end());
    for (std::size_t n = 1; n < size(); ++n)
        for (const std::uint32_t p : {pairs_[n].a, pairs_[n].b})
            bond_[next[p]++] = static_cast<std::uint32_t>(n);
    step_only([](std::uint32_t) { return true; });
}

template <int D>
void Bonds<D>::add_code(std::size_t p, std::size_t points, std::uint32_t j) {
    std::uint32_t code = 0;
    if (p < points)
        walk(p, [&](std::uint32_t n, std::uint32_t other) {
            if (other == j) code = 2 * n + (pairs_[n].b == p);
        });
    code_.push_back(code);
}

template <int D>
template <class Point>
void Bonds<D>::find_moments(std::span<const std::uint32_t> bonds, const Point& point) {
    for (const std::uint32_t n : bonds) {
        const BondEnds& ends = pairs_[n];
        if (!state_[n].cracked() || state_[n].whole == 0.0) continue;
        const BondPoint<D> a = point(ends.a), b = point(ends.b);
        const Vec<double, D> rest = a.rest - b.rest, at_a = a.B * rest, at_b = b.B * rest;
        add_outer(tip_[ends.a].moment, ends.weight * b.volume, at_a, at_a);
        add_outer(tip_[ends.b].moment, ends.weight * a.volume, at_b, at_b);
    }
}

template <int D>
template <class Point>
void Bonds<D>::find_tips(const Point& point) {
    for (const std::uint32_t n : stepped_) tip_[pairs_[n].a] = tip_[pairs_[n].b] = {};
    find_moments(stepped_, point);
    for (const std::uint32_t n : stepped_) {
        if (!(state_[n].opening > 0.0)) continue;
        for (const std::uint32_t p : {pairs_[n].a, pairs_[n].b}) {
            tip_[p].open = true;
            if (state_[n].damage >= 1.0 && state_[n].whole != 0.0) tip_[p].meet(state_[n]);
        }
    }
}

/// Those that have a crack, or get one now.
template <int D>
template <class Point, class Body, class Tension>
void Bonds<D>::find_cracked(const Point& point, const Body& body, const Tension& tension) {
    Array<std::uint8_t> cracks(stepped_.size(), 0);
    for_each_particle(stepped_.size(), [&](std::size_t k) {
        const BondEnds& ends = pairs_[stepped_[k]];
        BondState<D>& state = state_[stepped_[k]];
        if (state.whole == 0.0) return;
        const Beside<D> beside{tip_[ends.a], tip_[ends.b]};
        // The largest principal stress of a mean is at most the mean of those of its parts.
        const double most = 0.5 * (tension(ends.a) + tension(ends.b));
        if (!state.cracked() && !beside.open() && most < least_strength(body(ends.a))) return;
        cracks[k] = step_of(stepped_[k], point, body).cracks();
    });
    cracked_.clear();
    for (std::size_t k = 0; k < stepped_.size(); ++k)
        if (cracks[k] != 0) cracked_.push_back(stepped_[k]);
}

template <int D>
template <class Point, class Body>
BondStep<D> Bonds<D>::step_of(std::uint32_t n, const Point& point, const Body& body) {
    const BondEnds& ends = pairs_[n];
    return {ends,         point(ends.a), point(ends.b),
            body(ends.a), state_[n],     {tip_[ends.a], tip_[ends.b]}};
}

/// A crack relieves its points and those beside it: all move again, with the stress that there is
/// then, until each bears what it should. Forces act on what is then.
template <int D>
template <class Point, class Before, class Body, class Tension, class Update>
void Bonds<D>::advance(double dt, const Point& point, const Before& before, const Body& body,
                       const Tension& tension, Update&& update) {
    constexpr int most_passes = 8;
    constexpr double tolerance = 0.005;  // of the strength
    find_tips(point);
    find_cracked(point, body, tension);
    find_first_pulls(before, body);
    change_ = move_cracks(dt, 0.0, point, body);
    for (const std::uint32_t n : cracked_) tip_[pairs_[n].a].moment = tip_[pairs_[n].b].moment = {};
    find_moments(cracked_, point);
    std::size_t moved = change_.moved;
    for (int n = 1; n < most_passes && moved > 0; ++n) {
        update();
        const BondChange further = move_cracks(0.0, tolerance, point, body);
        change_ = change_ + further, moved = further.moved;
    }
    if (moved > 0) update();
    change_.gone = find_parting(point, body), broken_ += change_.broken;
}

template <int D>
template <class Before, class Body>
void Bonds<D>::find_first_pulls(const Before& before, const Body& body) {
    first_.resize(cracked_.size());
    for_each_particle(cracked_.size(), [&](std::size_t k) {
        first_[k] = step_of(cracked_[k], before, body).pulls();
    });
}

template <int D>
template <class Point, class Body>
BondChange Bonds<D>::move_cracks(double dt, double tolerance, const Point& point,
                                 const Body& body) {
    return reduce(cracked_.size(), BondChange{}, std::plus<BondChange>{}, [&](std::size_t k) {
        return step_of(cracked_[k], point, body).move(dt, tolerance);
    });
}

/// Bonds that go in this step.
template <int D>
template <class Point, class Body>
std::size_t Bonds<D>::find_parting(const Point& point, const Body& body) {
    return doseki::reduce(cracked_.size(), std::size_t{0}, std::plus<>{}, [&](std::size_t k) {
        const bool parts = step_of(cracked_[k], point, body).parts();
        if (parts) state_[cracked_[k]].whole = -1.0;
        return std::size_t{parts};
    });
}

template <int D>
template <class Point, class Body>
double Bonds<D>::strength(std::size_t p, const Point& point, const Body& body) const {
    double least = std::numeric_limits<double>::infinity();
    walk(p, [&](std::uint32_t n, std::uint32_t) {
        const BondEnds& ends = pairs_[n];
        BondState<D> state = state_[n];
        const BondStep<D> bond(ends, point(ends.a), point(ends.b), body(ends.a), state);
        least = min(least, bond.strength());
    });
    return least;
}

}  // namespace doseki
