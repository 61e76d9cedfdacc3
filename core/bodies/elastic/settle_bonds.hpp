#pragma once
// What a step of cracks took, and the end of bonds.

#include "bodies/elastic/advance_bonds.hpp"

namespace doseki {

template <int D>
template <class Point, class Counts>
Mat<double, D> Bonds<D>::moment(std::size_t p, const Point& point, const Counts& counts) const {
    Mat<double, D> sum{};
    const BondPoint<D> own = point(p);
    walk(p, [&](std::uint32_t n, std::uint32_t j) {
        if (state_[n].whole <= 0.0 || !counts(j)) return;
        const BondPoint<D> other = point(j);
        const Vec<double, D> R = own.rest - other.rest;
        add_outer(sum, pairs_[n].weight * other.volume, R, R);
    });
    return sum;
}

template <int D>
template <class Point>
double Bonds<D>::sharpness(std::size_t p, const Mat<double, D>& shape, const Point& point) const {
    const Mat<double, D> B = inverse(shape, 0.0);
    const BondPoint<D> own = point(p);
    Vec<double, D> at_point{};
    double square = 0.0;
    walk(p, [&](std::uint32_t n, std::uint32_t j) {
        if (state_[n].whole <= 0.0) return;
        const BondPoint<D> other = point(j);
        const Vec<double, D> weight =
            (pairs_[n].weight * other.volume) * (B * (own.rest - other.rest));
        square += dot(weight, weight), at_point = at_point + weight;
    });
    return std::sqrt(square + dot(at_point, at_point));
}

/// Of strain and springs of a point, Eqs. (80) and (83) with the bonds that there are at a moment.
template <int D>
template <class Point, class Body, class Place, class Counts>
double Bonds<D>::energy(std::size_t p, Moment moment, const Point& point, const Body& body,
                        const Place& place, const Counts& counts) const {
    struct Side {
        double weight;
        Vec<double, D> R, r;
    };
    Array<Side> sides;
    const BondPoint<D> own = point(p);
    Mat<double, D> moved{}, shape{};
    walk(p, [&](std::uint32_t n, std::uint32_t j) {
        const BondState<D>& state = state_[n];
        if ((moment == Moment::before ? state.whole == 0.0 : state.whole <= 0.0) || !counts(j))
            return;
        const BondPoint<D> other = point(j);
        const Vec<double, D> jump =
            moment == Moment::before ? state.jump - state.change : state.jump;
        const Side side{pairs_[n].weight * other.volume,
                        own.rest - other.rest + (pairs_[n].a == p ? 1.0 : -1.0) * jump,
                        place(p) - place(j)};
        add_outer(moved, side.weight, side.r, side.R),
            add_outer(shape, side.weight, side.R, side.R);
        sides.push_back(side);
    });
    if (!determines_strain(shape)) return 0.0;
    const Mat<double, D> F = moved * inverse(shape, 0.0);
    double springs = 0.0;
    for (const Side& side : sides) {
        const Vec<double, D> misfit = side.r - F * side.R;
        springs += side.weight * dot(misfit, misfit);
    }
    return own.volume * (body(p).energy(F) + 0.5 * own.kappa * springs);
}

/// What the forces of the step find of the energy of a point, Eq. (128): between the places at
/// which they act they follow the trapezoidal rule, so that the curvature on the way is not in it.
template <int D>
template <class Point, class Body, class Place, class Counts>
double Bonds<D>::energy_across(std::size_t p, Moment moment, const Point& point, const Body& body,
                               const Place& place, const Counts& counts) const {
    auto at = [&](double share) {
        return energy(
            p, moment, point, body, [&](std::size_t k) { return place(k, share); }, counts);
    };
    return across_step(at(0.0), at(0.5), at(1.0));
}

template <int D>
template <class Point, class Body, class Place, class Counts>
double Bonds<D>::energy_left(std::size_t p, const Point& point, const Body& body,
                             const Place& place, const Counts& counts) const {
    if (!point(p).spans || !spans_space(moment(p, point, counts))) return 0.0;
    return energy(p, Moment::now, point, body, place, counts);
}

/// Eq. (176): a bond whose end would leave more energy in its points than they have stays, as a
/// crack that bears pressure. Those that release most go first.
template <int D>
template <class Point, class Body, class Place>
void Bonds<D>::keep_pressed(const Point& point, const Body& body, const Place& place) {
    if (change_.gone == 0) return;
    const auto all = [](std::uint32_t) { return true; };
    const auto now = [&](std::size_t k) { return place(k, 1.0); };
    const auto energy = [&](std::uint32_t n, double whole) {
        state_[n].whole = whole;
        return energy_left(pairs_[n].a, point, body, now, all) +
               energy_left(pairs_[n].b, point, body, now, all);
    };
    const auto gain = [&](std::uint32_t n) { return energy(n, -1.0) - energy(n, 1.0); };
    Array<std::pair<double, std::uint32_t>> parting;
    for (const std::uint32_t n : cracked_)
        if (state_[n].whole < 0.0) state_[n].whole = 1.0, parting.emplace_back(0.0, n);
    for (auto& [gained, n] : parting) gained = gain(n);
    std::stable_sort(parting.begin(), parting.end());
    for (const auto& [first, n] : parting) {
        const double volume = point(pairs_[n].a).volume + point(pairs_[n].b).volume;
        const double most = negligible_gain(volume, state_[n].strength, body(pairs_[n].a));
        if (step_of(n, point, body).is_far() || gain(n) <= most)
            state_[n].whole = -1.0;
        else
            --change_.gone;
    }
}

/// Points that lose bonds in this step.
template <int D>
std::set<std::uint32_t> Bonds<D>::parting_points() const {
    std::set<std::uint32_t> points;
    if (change_.gone == 0) return points;
    for (const std::uint32_t n : cracked_)
        if (state_[n].whole < 0.0) points.insert({pairs_[n].a, pairs_[n].b});
    return points;
}

/// By the trapezoidal rule between the pulls when forces acted last and now, on all points but
/// some.
template <int D>
template <class Point, class Body>
double Bonds<D>::work_of_step(const std::set<std::uint32_t>& but, const Point& point,
                              const Body& body) {
    return reduce(cracked_.size(), 0.0, std::plus<>{}, [&](std::size_t k) {
        const std::uint32_t n = cracked_[k];
        const BondStep<D> bond = step_of(n, point, body);
        const BondPulls<D> last = bond.pulls();
        double work = 0.0;
        if (!but.contains(pairs_[n].a)) work += bond.half_work(first_[k].of_a + last.of_a);
        if (!but.contains(pairs_[n].b)) work += bond.half_work(first_[k].of_b + last.of_b);
        return work;
    });
}

template <int D>
template <class Point, class Body, class Place, class TakeShape>
void Bonds<D>::settle(const Point& point, const Body& body, const Place& place,
                      const TakeShape& take_shape) {
    const auto all = [](std::uint32_t) { return true; };
    keep_pressed(point, body, place);
    const std::set<std::uint32_t> parting = parting_points();
    work_ += work_of_step(parting, point, body);
    for (const std::uint32_t p : parting) {
        if (!point(p).spans) continue;
        const Mat<double, D> shape = moment(p, point, all);
        work_ += energy_across(p, Moment::before, point, body, place, all);
        if (spans_space(shape)) work_ -= energy_across(p, Moment::now, point, body, place, all);
        take_shape(p, shape);
    }
    if (parting.empty()) return;
    for (const std::uint32_t n : cracked_)
        if (state_[n].whole < 0.0) state_[n].whole = 0.0;
}

}  // namespace doseki
