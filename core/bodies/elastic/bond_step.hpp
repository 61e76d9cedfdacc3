#pragma once
// One bond in a step: how its crack begins, opens, closes and ends.

#include <utility>

#include "bodies/elastic/bonds.hpp"
#include "physics/fracture.hpp"
#include "physics/hyperelastic/strain.hpp"

namespace doseki {

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

/// What the end of bonds may add to the energy of points, Eq. (176): a part of what they have when
/// a crack begins, at this strength or what every bond bears. Open cracks add some hundredths of
/// that.
inline double negligible_gain(double volume, double strength, const DeformableBody& body) {
    constexpr double part = 0.1, least_strain = 1e-6;  // less is rounding
    const double E = body.young_modulus(),
                 tension = std::max({strength, least_strength(body), least_strain * E});
    return part * volume * tension * tension / (2.0 * E);
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

    /// Half of what the change of its jump takes from points that pull so.
    double half_work(const Vec<double, D>& pull) const {
        return 0.5 * share_ * dot(pull, state_.change);
    }
    /// On both of its points.
    BondPulls<D> pulls() const { return {pull_of(a_, at_rest()), pull_of(b_, at_rest())}; }
    /// Whether it has a crack, or gets one now.
    bool cracks() { return state_.cracked() || begins(); }
    /// Tension [Pa] along the bond at which a crack begins.
    double strength() const {
        const CrackSite place = site((1.0 / norm(rest_)) * rest_);
        return with_value(body_.law->fracture,
                          [&](const auto& law) { return law.strength(place); });
    }
    /// Moves its crack towards what it bears, unless it is within `tolerance` of its strength from
    /// that.
    BondChange move(double dt, double tolerance) {
        Crack crack{state_.opening, state_.max_opening, state_.damage};
        const CrackSite place = site(state_.normal);
        pull_ = pull(), near_ = tolerance * state_.strength;
        const bool begins = dt > 0.0;
        const Vec<double, D> last = state_.change;
        if (begins) state_.change = {};
        return with_value(body_.law->fracture, [&](const auto& law) {
            if (!law.failed(crack)) return widen(law, crack, dt, place);
            return begins && state_.opening > 0.0 ? go_on(last) : slide(place);
        });
    }
    /// Whether its sides are apart for good.
    bool parts() const {
        const bool failed = with_value(body_.law->fracture, [&](const auto& law) {
            return law.failed(Crack{state_.opening, state_.max_opening, state_.damage});
        });
        return failed && displacement() >= reach;
    }
    /// Whether they are so far apart that the bond says nothing of the body any more.
    bool is_far() const { return displacement() >= far; }

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
    static constexpr double far = 0.3;
    /// Of the sides of a crack: that of rock (Byerlee, Pure Appl. Geophys. 116, 1978).
    static constexpr double friction = 0.6;

    Vec<double, D> at_rest() const { return rest_ + state_.jump; }
    Vec<double, D> now() const { return a_.x - b_.x; }
    /// Of its sides, over its length.
    double displacement() const { return norm(now() - mean_deformation() * rest_) / norm(rest_); }

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
            symmetric_part(0.5 * (full(material_stress(a_)) + full(material_stress(b_)))), rest_);
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
        const double further = std::abs(excess) > near_ ? relaxation * excess / resistance : 0.0;
        crack.opening = max(0.0, crack.opening + further);
        crack.max_opening = max(crack.max_opening, crack.opening);
        law.grow(crack, 0.0, 0.0, place);
        const bool moved = set_jump((crack.opening - state_.opening) * normal);
        state_.opening = crack.opening, state_.max_opening = crack.max_opening;
        state_.damage = crack.damage;
        return {law.failed(crack) ? 1u : 0u, 0, moved ? 1u : 0u};
    }

    /// A broken bond whose sides are apart goes on as in the step before: what is left is for
    /// the moves that follow.
    BondChange go_on(const Vec<double, D>& last) {
        const double opening = max(0.0, state_.opening + dot(last, state_.normal));
        const bool moved =
            set_jump(last + (opening - state_.opening - dot(last, state_.normal)) * state_.normal);
        state_.opening = opening, state_.max_opening = max(state_.max_opening, opening);
        return {0, 0, moved ? 1u : 0u};
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
        double opening = max(0.0, before - ease * pressed);
        if (norm(slip) <= ease * near_) slip = {};
        if (std::abs(opening - before) <= ease * near_) opening = before;
        const bool moved = set_jump(slip + (opening - before) * normal);
        state_.opening = opening, state_.max_opening = max(state_.max_opening, opening);
        return {0, 0, moved ? 1u : 0u};
    }
    Mat<double, D> mean_deformation() const {
        if (!a_.spans) return b_.F;
        return b_.spans ? 0.5 * (a_.F + b_.F) : a_.F;
    }
    /// Returns whether it is one.
    bool set_jump(const Vec<double, D>& further) {
        state_.jump = state_.jump + further, state_.change = state_.change + further;
        return dot(further, further) > 0.0;
    }

    const BondEnds& ends_;
    BondPoint<D> a_, b_;
    const DeformableBody& body_;
    BondState<D>& state_;
    const Beside<D> beside_;
    Vec<double, D> rest_;
    double share_;
    Vec<double, D> pull_{};  // before it moves
    double near_ = 0.0;      // to what it bears: near enough [Pa]
};

}  // namespace doseki
