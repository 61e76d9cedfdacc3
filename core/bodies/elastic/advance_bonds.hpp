#pragma once
// How cracks begin, open, close and end.

#include <utility>

#include "bodies/elastic/bonds.hpp"
#include "bodies/elastic/outer.hpp"
#include "physics/fracture.hpp"
#include "physics/hyperelastic/strain.hpp"

namespace doseki {

template <int D>
void Bonds<D>::index(std::size_t points) {
    first_bond_.assign(points + 1, 0), settled_.assign(points, 0), tip_.assign(points, {});
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
        for (std::size_t k = first_bond_[p]; k < first_bond_[p + 1]; ++k) {
            const BondEnds& ends = pairs_[bond_[k]];
            if (ends.a == p && ends.b == j) code = 2 * bond_[k];
            if (ends.b == p && ends.a == j) code = 2 * bond_[k] + 1;
        }
    code_.push_back(code);
}

/// Second Piola-Kirchhoff stress: of the material, so that it does not turn.
template <int D>
Sym<double, D> material_stress(const Mat<double, D>& F, const Mat<double, D>& P) {
    return symmetric_part(inverse(F, 0.0) * P);
}
template <int D>
Sym<double, D> material_stress(const BondPoint<D>& point) {
    return point.spans ? material_stress(point.F, point.P) : Sym<double, D>{};
}

/// Those at the points of a bond.
template <int D>
struct Beside {
    CrackTip<D> a{}, b{};

    bool open() const { return a.open || b.open; }
};

/// Tension that every bond of a body bears [Pa].
inline double least_strength(const DeformableBody& body) {
    return with_value(body.law->fracture, [](const auto& law) { return law.least_strength(); });
}

/// One bond, its points, and what happens to it in a step.
template <int D>
class BondStep {
public:
    BondStep(const BondEnds& ends, const BondPoint<D>& a, const BondPoint<D>& b,
             const DeformableBody& body, BondState<D>& state, const Beside<D>& beside = {})
        : ends_(ends),
          a_(a),
          b_(b),
          body_(body),
          state_(state),
          beside_(beside),
          rest_(a.rest - b.rest),
          share_(ends.weight * a.volume * b.volume) {}

    /// Of what the last change of the jump took, by the trapezoidal rule: half with the pull from
    /// which it followed, half with that of the step after it, but for points that are settled.
    double half_work() const {
        return (a_.settled ? 0.0 : half_work(pull_of(a_, at_rest()))) +
               (b_.settled ? 0.0 : half_work(pull_of(b_, at_rest())));
    }
    /// The first half of one of the points, which are still as they were then.
    double first_half(std::size_t p) const {
        return half_work(pull_of(p == ends_.a ? a_ : b_, at_rest() - state_.change));
    }
    /// Tension [Pa] along the bond at which a crack begins.
    double strength() const {
        const CrackSite place = site((1.0 / norm(rest_)) * rest_);
        return with_value(body_.law->fracture,
                          [&](const auto& law) { return law.strength(place); });
    }
    BondChange take(double dt) {
        if (!state_.cracked() && !begins()) return {};
        Crack crack{state_.opening, state_.max_opening, state_.damage};
        const CrackSite place = site(state_.normal);
        pull_ = pull();
        const double before = half_work();
        state_.change = {};
        BondChange change = with_value(body_.law->fracture, [&](const auto& law) {
            return law.failed(crack) ? slide(place) : widen(law, crack, dt, place);
        });
        change.work += before;
        return change;
    }

private:
    /// Of the length of a bond: below this part of it along the normal, a crack does not cross it.
    static constexpr double least_crossing = 0.25;
    /// Of what would take the stress of a bond away in one step of its crack, so that those of
    /// neighbours do not overshoot together.
    static constexpr double relaxation = 0.7;
    /// Of the largest response of the cracks around a point; half of the relaxation and some more.
    static constexpr double crowding = 0.4;
    /// Of the length of a bond: sides of a crack farther apart than this part for good.
    static constexpr double reach = 0.03;
    /// Of the sides of a crack: that of rock (Byerlee, Pure Appl. Geophys. 116, 1978).
    static constexpr double friction = 0.6;

    Vec<double, D> at_rest() const { return rest_ + state_.jump; }
    Vec<double, D> now() const { return a_.x - b_.x; }

    /// Force over the weight with which point i resists a change of the jump, Eq. (109).
    Vec<double, D> pull_of(const BondPoint<D>& i, const Vec<double, D>& at_rest) const {
        if (!i.spans) return {};
        const Mat<double, D> S = i.P * transposed(i.B);
        const Vec<double, D> misfit = now() - i.F * at_rest;
        return transposed(i.F) * (S * at_rest + i.kappa * misfit) - transposed(S) * misfit;
    }
    /// The same of both points.
    Vec<double, D> pull() const { return pull_of(a_, at_rest()) + pull_of(b_, at_rest()); }
    /// Its area over the weight, for a crack of this normal: an even stress across a plane pulls on
    /// all bonds that the plane cuts with the area of that plane.
    double area(const Vec<double, D>& normal) const {
        const Vec<double, D> corrected = corrected_rest(a_) + corrected_rest(b_);
        return max(std::abs(dot(normal, corrected)), 0.5 * std::abs(dot(normal, rest_)));
    }
    Vec<double, D> corrected_rest(const BondPoint<D>& i) const {
        return i.spans ? i.B * rest_ : rest_;
    }
    /// By how much the stress across falls while the crack opens [Pa/m]: its own part of that, and
    /// never less than that of all bonds around, which is more where few are left: the matrix of
    /// these is up to 2 at whole edges. Nor than a share of what the cracks of its points may do
    /// together, Eq. (151), so that their steps are stable in whatever directions they are.
    double stiffness(const Vec<double, D>& normal, const CrackSite& place) const {
        const double modulus = place.stiffness * body_.spacing,
                     of_all = D * modulus - 2.0 * (D - 1) * body_.shear_modulus();
        double own = 0.0, together = 0.0, few = 1.0;
        for (const auto& [i, tip] : {std::pair{&a_, &beside_.a}, std::pair{&b_, &beside_.b}}) {
            if (!i->spans) continue;
            const Vec<double, D> corrected = corrected_rest(*i);
            const double square = dot(corrected, corrected);
            own += modulus * ends_.weight * i->volume * square + i->kappa;
            together += of_all * dot(corrected, tip->moment * corrected) / square + i->kappa;
            few = max(few, 0.5 * norm(i->B * normal));
        }
        return max(few * place.stiffness, max(own, crowding * together) / area(normal));
    }
    CrackSite site(const Vec<double, D>& normal) const {
        const double c = body_.wave_speed(), stiffness = body_.rho0 * c * c / body_.spacing;
        // With these shares, all bonds across a direction have the volume of the body.
        const double volume = share_ * area(normal) * std::abs(dot(normal, rest_));
        const double radius = (D == 2 ? 0.564 : 0.620) * body_.spacing;  // of a ball as large
        const auto [low, high] = std::minmax(a_.number, b_.number);
        const std::uint64_t key = (std::uint64_t{low} << 32) | high;
        const double growth = DeformableBody::crack_speed * c / radius;
        const double tip = std::min(beside_.a.strength_for(normal), beside_.b.strength_for(normal));
        return {stiffness, body_.young_modulus(), volume, growth, key, body_.seed, tip};
    }

    /// A bond beside a crack is stretched by it though its points have little stress: there, what
    /// it bears itself counts too.
    bool begins() {
        const auto [stress, normal] = largest_principal(
            symmetric_part(0.5 * (full(material_stress(a_)) + full(material_stress(b_)))));
        const double along = dot(normal, rest_);
        if (!(stress > 0.0) || std::abs(along) < least_crossing * norm(rest_)) return false;
        const Vec<double, D> outward = along > 0.0 ? normal : -1.0 * normal;
        const double own = beside_.open() ? dot(pull(), outward) / area(outward) : 0.0,
                     tension = max(stress, own);
        const CrackSite place = site(outward);
        if (!with_value(body_.law->fracture,
                        [&](const auto& law) { return law.starts(tension, place); }))
            return false;
        state_.normal = outward;
        state_.strength =
            with_value(body_.law->fracture, [&](const auto& law) { return law.strength(place); });
        return true;
    }

    /// Eq. (111): the crack of a bond that still bears tension.
    template <class Law>
    BondChange widen(const Law& law, Crack& crack, double dt, const CrackSite& place) {
        const Vec<double, D> normal = state_.normal;
        const double tension = dot(pull_, normal) / area(normal);
        law.grow(crack, tension, dt, place);
        const double excess = tension - law.traction(crack, place),
                     resistance = stiffness(normal, place) + law.slope(crack, tension, place);
        crack.opening = max(0.0, crack.opening + relaxation * excess / resistance);
        crack.max_opening = max(crack.max_opening, crack.opening);
        law.grow(crack, 0.0, 0.0, place);
        const double work = set_jump(state_.jump + (crack.opening - state_.opening) * normal);
        state_.opening = crack.opening, state_.max_opening = crack.max_opening;
        state_.damage = crack.damage;
        return {work, law.failed(crack) ? 1u : 0u, 0};
    }

    /// A broken bond: its sides go apart without a force, press on each other where they meet, and
    /// slide there when friction does not hold them.
    BondChange slide(const CrackSite& place) {
        const Vec<double, D> normal = state_.normal, traction = (1.0 / area(normal)) * pull_;
        const double ease = relaxation / stiffness(normal, place), pressed = -dot(traction, normal);
        const Vec<double, D> along = traction + pressed * normal;
        const double before = state_.opening;
        Vec<double, D> slip{};
        if (before > 0.0) {
            slip = ease * along;
        } else {
            const double hold = friction * max(0.0, pressed), shear = norm(along);
            if (shear > hold) slip = (ease * (1.0 - hold / shear)) * along;
        }
        const double opening = max(0.0, before - ease * pressed);
        const double work = set_jump(state_.jump + slip + (opening - before) * normal);
        state_.opening = opening, state_.max_opening = max(state_.max_opening, opening);
        if (norm(now() - mean_deformation() * rest_) < reach * norm(rest_)) return {work, 0, 0};
        state_.whole = -1.0;
        return {work, 0, 1};
    }
    Mat<double, D> mean_deformation() const {
        if (!a_.spans) return b_.F;
        return b_.spans ? 0.5 * (a_.F + b_.F) : a_.F;
    }
    double half_work(const Vec<double, D>& pull) const {
        return 0.5 * share_ * dot(pull, state_.change);
    }
    /// Returns the first half of the energy that this takes.
    double set_jump(const Vec<double, D>& jump) {
        state_.change = jump - state_.jump;
        const double work = half_work(pull_);
        state_.jump = jump;
        return work;
    }

    const BondEnds& ends_;
    BondPoint<D> a_, b_;
    const DeformableBody& body_;
    BondState<D>& state_;
    const Beside<D> beside_;
    Vec<double, D> rest_;
    double share_;
    Vec<double, D> pull_{};  // before this step
};

template <int D>
template <class Point>
void Bonds<D>::find_moments(const Point& point) {
    for (const std::uint32_t n : stepped_) {
        const BondEnds& ends = pairs_[n];
        if (!state_[n].cracked() || state_[n].whole == 0.0) continue;
        const BondPoint<D> a = point(ends.a), b = point(ends.b);
        const Vec<double, D> rest = a.rest - b.rest, at_a = a.B * rest, at_b = b.B * rest;
        add_outer(tip_[ends.a].moment, ends.weight * b.volume, at_a, at_a);
        add_outer(tip_[ends.b].moment, ends.weight * a.volume, at_b, at_b);
    }
}

template <int D>
template <class Point, class Body, class Tension>
void Bonds<D>::advance(double dt, const Point& point, const Body& body, const Tension& tension) {
    for (const std::uint32_t n : stepped_) tip_[pairs_[n].a] = tip_[pairs_[n].b] = {};
    find_moments(point);
    for (const std::uint32_t n : stepped_) {
        if (!(state_[n].opening > 0.0)) continue;
        for (const std::uint32_t p : {pairs_[n].a, pairs_[n].b}) {
            tip_[p].open = true;
            if (state_[n].damage >= 1.0 && state_[n].whole != 0.0) tip_[p].meet(state_[n]);
        }
    }
    change_ = reduce(stepped_.size(), BondChange{}, std::plus<BondChange>{}, [&](std::size_t k) {
        const BondEnds& ends = pairs_[stepped_[k]];
        BondState<D>& state = state_[stepped_[k]];
        if (state.whole == 0.0) return BondChange{};
        const Beside<D> beside{tip_[ends.a], tip_[ends.b]};
        // The largest principal stress of a mean is at most the mean of those of its parts.
        const double most = 0.5 * (tension(ends.a) + tension(ends.b));
        if (!state.cracked() && !beside.open() && most < least_strength(body(ends.a)))
            return BondChange{};
        return BondStep<D>(ends, point(ends.a), point(ends.b), body(ends.a), state, beside)
            .take(dt);
    });
    work_ += change_.work, broken_ += change_.broken;
    for (const std::uint32_t n : stepped_) settled_[pairs_[n].a] = settled_[pairs_[n].b] = 0;
}

template <int D>
template <class Point, class Body>
double Bonds<D>::strength(std::size_t p, const Point& point, const Body& body) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = first_bond_[p]; k < first_bond_[p + 1]; ++k) {
        const BondEnds& ends = pairs_[bond_[k]];
        BondState<D> state = state_[bond_[k]];
        const BondStep<D> bond(ends, point(ends.a), point(ends.b), body(ends.a), state);
        least = min(least, bond.strength());
    }
    return least;
}

template <int D>
template <class Point, class Body>
double Bonds<D>::opening(const Point& point, const Body& body) const {
    return reduce(stepped_.size(), 0.0, std::plus<>{}, [&](std::size_t k) {
        const BondEnds& ends = pairs_[stepped_[k]];
        BondState<D> state = state_[stepped_[k]];
        if (state.whole == 0.0 || !state.cracked()) return 0.0;
        return BondStep<D>(ends, point(ends.a), point(ends.b), body(ends.a), state).half_work();
    });
}

}  // namespace doseki
