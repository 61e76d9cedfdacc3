#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <span>

#include "base/array.hpp"
#include "base/error.hpp"
#include "base/members.hpp"
#include "base/parallel.hpp"
#include "bodies/elastic/deformable_body.hpp"
#include "bodies/elastic/elastic_law.hpp"
#include "bodies/elastic/principal.hpp"
#include "model/archive.hpp"
#include "pairs/pair_term.hpp"

namespace doseki {

/// Whether bonds with this moment, 1 inside a body, tell of all strains.
template <int D>
bool determines_strain(const Mat<double, D>& moment) {
    constexpr double min_determinant = 1e-6;
    return determinant(moment) > min_determinant;
}

/// Whether they also do so well enough. The inverse is 2 along an edge of a body; with few bonds it
/// is so large that a point would be stiffer than the longest stable step allows.
template <int D>
bool spans_space(const Mat<double, D>& moment) {
    constexpr double largest = 5.0;
    if (!determines_strain(moment)) return false;
    double square = 0.0;
    for (const double element : inverse(moment, 0.0).element) square += element * element;
    return square <= largest * largest;
}

/// Of a step, from an energy at the places where its forces act, halfway and where those of the
/// next one act: what an energy that is square in the places has less half its rise, and plus half
/// its rise before.
inline double across_step(double first, double half, double last) {
    return 2.0 * half - 0.5 * (first + last);
}

/// What the sums over pairs need of a bond, for its first point: by how much a crack has lengthened
/// the vector between the points at rest [m], and 1, or 0 while nothing is borne.
template <class T, int D>
struct BondFields {
    Vec<T, D> jump;
    T whole;
};

/// A bond in memory. All are doubles, which an archive asks for.
template <int D>
struct BondState {
    Vec<double, D> jump{};    // at rest: turns with the body
    Vec<double, D> normal{};  // of its crack at rest; zero before there is one
    Vec<double, D> change{};  // of the jump in the last step
    double whole = 1.0;       // 0: it is gone for good; -1: it goes in this step
    double opening = 0.0, max_opening = 0.0, damage = 0.0;  // see Crack
    double strength = 0.0;                                  // tension at which its crack began [Pa]

    bool cracked() const { return dot(normal, normal) > 0.0; }
};

/// What cracks leave at a point: whether any are open, the moment of the bonds that have cracked,
/// by the gradients that these make, and of a broken one the normal at rest and the tension at
/// which its crack goes on [Pa].
template <int D>
struct CrackTip {
    bool open = false;
    Mat<double, D> moment{};
    Vec<double, D> normal{};
    double strength = std::numeric_limits<double>::infinity();

    /// The one that goes on at less.
    void meet(const BondState<D>& bond) {
        if (bond.strength < strength) normal = bond.normal, strength = bond.strength;
    }
    /// For a crack of this normal: cracks go on within 45 degrees of their plane.
    double strength_for(const Vec<double, D>& other) const {
        const double along = dot(normal, other);
        return along * along >= 0.5 ? strength : std::numeric_limits<double>::infinity();
    }
};

/// The bonds of the pairs of a list, entry by entry and lane by lane.
template <int D>
struct BondRows {
    /// Twice the number of a bond, plus 1 where the particle of the lane is its second point. Bond
    /// number 0 is whole for ever: that of pairs which cannot break.
    std::span<const std::uint32_t> code;
    std::span<const std::size_t> first;  // code of each cluster
    std::span<const BondState<D>> state;

    template <class T>
    static constexpr std::size_t width_of() {
        if constexpr (std::is_arithmetic_v<T>)
            return 1;
        else
            return T::size();
    }
    /// value(lane) in each lane; a number is one lane.
    template <class T, class Value>
    DOSEKI_FN static T in_lanes(const Value& value) {
        if constexpr (std::is_arithmetic_v<T>)
            return value(std::size_t{0});
        else
            return T(value);
    }
    template <class T>
    DOSEKI_FN BondFields<T, D> load(PairEntry at) const {
        constexpr std::size_t width = width_of<T>();
        const std::uint32_t* const codes =
            code.data() + first[at.first / width] + at.number * width;
        BondFields<T, D> bond;
        for (int a = 0; a < D; ++a)
            bond.jump[a] = in_lanes<T>([&](auto lane) {
                const double jump = state[codes[lane] >> 1].jump[a];
                return (codes[lane] & 1u) != 0 ? -jump : jump;
            });
        bond.whole = in_lanes<T>([&](auto lane) { return state[codes[lane] >> 1].whole; });
        return bond;
    }
};

/// A point of a breakable body, as its bonds see it.
template <int D>
struct BondPoint {
    Vec<double, D> rest, x, v;
    Mat<double, D> F, B;   // deformation gradient and correction, Eq. (80)
    Mat<double, D> P;      // first Piola-Kirchhoff stress without damping
    double volume, kappa;  // at rest; stiffness of the springs
    std::uint32_t number;  // in the order in which points were added
    bool spans;            // whether its bonds span the space, so that it has a stress
};

/// What one step did to bonds: how many ceased to bear tension, how many are gone, and how often
/// any moved.
struct BondChange {
    std::size_t broken = 0, gone = 0, moved = 0;

    BondChange operator+(const BondChange& other) const {
        return {broken + other.broken, gone + other.gone, moved + other.moved};
    }
};

/// Force over its weight with which each of the points of a bond resists a change of the jump, Eq.
/// (109).
template <int D>
struct BondPulls {
    Vec<double, D> of_a, of_b;
};

template <int D>
class BondStep;

/// The pair of points a < b of a bond, and -F of Eq. (25) at rest.
struct BondEnds {
    std::uint32_t a = 0, b = 0;
    double weight = 0.0;
};

/// The bonds between points of breakable bodies: pairs at rest, each once. Cracks live on them,
/// Eqs. (108) to (114): a crack opens across a bond, along the largest principal stress that there
/// was when it began, until the bond is broken: then it bears compression with friction, and no
/// tension. How they go on is in elastic/advance_bonds.hpp.
template <int D>
class Bonds {
public:
    bool any() const { return pairs_.size() > 1; }
    /// All numbers but 0, which is that of pairs that cannot break.
    std::size_t size() const { return pairs_.size(); }

    /// The points of those that have cracks, in the last step of these; more than once.
    template <class F>
    void for_each_cracked_point(const F& f) const {
        for (const std::uint32_t n : cracked_) f(pairs_[n].a), f(pairs_[n].b);
    }
    /// A bond between points a < b, `weight` = -F of Eq. (25) at rest.
    void add(std::uint32_t a, std::uint32_t b, double weight) {
        pairs_.push_back({a, b, weight});
        state_.emplace_back();
    }
    void clear() {
        pairs_.assign(1, BondEnds{}), state_.assign(1, {}), code_.clear(), first_code_.clear();
        work_ = 0.0, change_ = {}, broken_ = 0, stepped_.clear();
    }
    /// From now on only the bonds of points for which moves(p) take part in steps; the others keep
    /// what they are.
    template <class Moves>
    void step_only(const Moves& moves) {
        stepped_.clear(), change_ = {};
        for (std::uint32_t n = 1; n < size(); ++n)
            if (moves(pairs_[n].a)) stepped_.push_back(n);
    }
    /// Intactness of the weakest of the bonds of point p to points j for which counts(j), see
    /// for_each_bond.
    template <class Counts>
    double least_intactness(std::size_t p, const Counts& counts) const {
        double least = 1.0;
        for_each_bond(p, [&](std::uint32_t j, double intact) {
            if (counts(j)) least = min(least, intact);
        });
        return least;
    }
    /// Cracks of these points do not go on from what they did in the last step.
    void stop(std::span<const std::uint32_t> points) {
        for (const std::uint32_t p : points)
            walk(p, [&](std::uint32_t n, std::uint32_t) { state_[n].change = {}; });
    }
    /// Tension [Pa] at which the first of the bonds of point p begins to crack.
    template <class Point, class Body>
    double strength(std::size_t p, const Point& point, const Body& body) const;
    /// Finds the bonds of each of `points` points, which were added in the order of their first.
    void index(std::size_t points);
    /// Codes of a list: `neighbour(p)` of each lane, of one more entry of the cluster that begins
    /// with point `first`.
    void begin_cluster() { first_code_.push_back(code_.size()); }
    void add_code(std::size_t p, std::size_t points, std::uint32_t j);

    BondRows<D> rows() const { return {code_, first_code_, state_}; }

    /// Calls f(j, intactness) for the bonds of point p: 1 whole, 0 where it bears no tension.
    template <class F>
    void for_each_bond(std::size_t p, const F& f) const {
        walk(p, [&](std::uint32_t n, std::uint32_t j) { f(j, intactness(n)); });
    }
    /// Calls f(j, strength) for those that are left, with the tension at which their crack began,
    /// 0 where there is none.
    template <class F>
    void for_each_left(std::size_t p, const F& f) const {
        walk(p, [&](std::uint32_t n, std::uint32_t j) {
            if (state_[n].whole != 0.0) f(j, state_[n].strength);
        });
    }
    /// Energy of point p at place(k) with those bonds that are left to points j for which
    /// counts(j); none where these do not span the space.
    template <class Point, class Body, class Place, class Counts>
    double energy_left(std::size_t p, const Point& point, const Body& body, const Place& place,
                       const Counts& counts) const;
    /// Eq. (127): the share of the bonds of point p that is broken, by the weights of the fit (80).
    double damage(std::size_t p) const {
        double whole = 0.0, left = 0.0;
        walk(p, [&](std::uint32_t n, std::uint32_t) {
            whole += pairs_[n].weight, left += pairs_[n].weight * intactness(n);
        });
        return whole > 0.0 ? 1.0 - left / whole : 0.0;
    }
    /// Moment of the bonds of point p that are left, as they were at rest, Eq. (120).
    /// Of those to points j for which counts(j).
    template <class Point, class Counts>
    Mat<double, D> moment(std::size_t p, const Point& point, const Counts& counts) const;
    /// Root of the sum of squares of what the places of a point, whose moment is `shape`, and of
    /// its neighbours weigh in its gradients [1/m], Eq. (146): its square bounds the stiffness of a
    /// point, over that of the material.
    template <class Point>
    double sharpness(std::size_t p, const Mat<double, D>& shape, const Point& point) const;
    /// Ends for good those bonds between points a and b for which apart(a, b): their points meet
    /// only as those of two bodies.
    template <class Apart>
    void part(const Apart& apart) {
        for (const std::uint32_t n : stepped_) {
            if (!apart(pairs_[n].a, pairs_[n].b)) continue;
            broken_ += intactness(n) > 0.0;
            state_[n].whole = 0.0, state_[n].damage = 1.0;
        }
    }
    /// Bonds that bear no tension.
    std::size_t broken() const { return broken_; }
    /// What the last step did.
    const BondChange& change() const { return change_; }
    /// Energy that all steps took [J], 2-D: [J/m].
    double work() const { return work_; }

    /// A step of all cracks, before forces act: point(p) is a BondPoint now and before(p) the one
    /// on which forces acted last, body(p) its DeformableBody, tension(p) the largest principal
    /// value of its material_stress; update() brings points to the jumps that their bonds have now:
    /// for_each_cracked_point.
    template <class Point, class Before, class Body, class Tension, class Update>
    void advance(double dt, const Point& point, const Before& before, const Body& body,
                 const Tension& tension, Update&& update);
    /// Counts what the step took, Eqs. (109) and (128), and takes out the bonds that go in it, by
    /// place(p, share), the places at a share of the way since forces acted last; tells of the
    /// points that lost some the moment of those that are left: take_shape(p, moment).
    template <class Point, class Body, class Place, class TakeShape>
    void settle(const Point& point, const Body& body, const Place& place,
                const TakeShape& take_shape);

    void serialise(Archive& archive) {
        Array<BondState<D>> states(state_.begin() + 1, state_.end());
        archive("bond_state", states), archive("bond_work", work_);
        if (!archive.loads()) return;
        expect_fit(states.size() + 1 == size() && std::isfinite(work_), "bond_state");
        for (const BondState<D>& s : states) expect_state(s);
        std::copy(states.begin(), states.end(), state_.begin() + 1);
        broken_ = 0;
        for (std::size_t n = 1; n < size(); ++n) broken_ += intactness(n) <= 0.0;
    }

private:
    enum class Moment { before, now };  // of a step in which bonds go

    /// Calls f(n, j) for each bond n of point p, to point j.
    template <class F>
    void walk(std::size_t p, const F& f) const {
        if (p + 1 >= first_bond_.size()) return;
        for (std::size_t k = first_bond_[p]; k < first_bond_[p + 1]; ++k) {
            const BondEnds& ends = pairs_[bond_[k]];
            f(bond_[k], ends.a == p ? ends.b : ends.a);
        }
    }
    double intactness(std::size_t n) const {
        return state_[n].whole == 0.0 ? 0.0 : 1.0 - state_[n].damage;
    }
    template <class Point, class Body, class Place, class Counts>
    double energy(std::size_t p, Moment moment, const Point& point, const Body& body,
                  const Place& place, const Counts& counts) const;
    template <class Point, class Body, class Place, class Counts>
    double energy_across(std::size_t p, Moment moment, const Point& point, const Body& body,
                         const Place& place, const Counts& counts) const;
    template <class Point, class Body, class Place>
    void keep_pressed(const Point& point, const Body& body, const Place& place);
    /// Of the cracks around each point.
    template <class Point>
    void find_moments(std::span<const std::uint32_t> bonds, const Point& point);
    template <class Point>
    void find_tips(const Point& point);
    template <class Point, class Body, class Tension>
    void find_cracked(const Point& point, const Body& body, const Tension& tension);
    template <class Point, class Body>
    BondStep<D> step_of(std::uint32_t n, const Point& point, const Body& body);
    template <class Before, class Body>
    void find_first_pulls(const Before& before, const Body& body);
    template <class Point, class Body>
    BondChange move_cracks(double dt, double tolerance, const Point& point, const Body& body);
    template <class Point, class Body>
    std::size_t find_parting(const Point& point, const Body& body);
    std::set<std::uint32_t> parting_points() const;
    template <class Point, class Body>
    double work_of_step(const std::set<std::uint32_t>& but, const Point& point, const Body& body);
    static void expect_state(const BondState<D>& s) {
        bool good = (s.whole == 0.0 || s.whole == 1.0) && s.damage >= 0.0 && s.damage <= 1.0 &&
                    s.opening >= 0.0 && s.max_opening >= s.opening &&
                    std::isfinite(s.max_opening) && s.strength >= 0.0;
        for (int a = 0; a < D; ++a)
            good = good && std::isfinite(s.jump[a]) && std::isfinite(s.change[a]) &&
                   std::abs(s.normal[a]) <= 1.0 + 1e-9;
        expect_fit(good, "bond_state");
    }

    Array<BondEnds> pairs_ = Array<BondEnds>(1);
    Array<BondState<D>> state_ = Array<BondState<D>>(1);
    Array<std::size_t> first_bond_;  // in bond_, of each point, and the end
    Array<std::uint32_t> bond_;
    Array<std::uint32_t> code_;
    Array<std::size_t> first_code_;
    Array<std::uint32_t> stepped_;  // numbers of bonds, rising
    // In a step: of the points of stepped bonds, numbers of those with cracks, rising, and the
    // pulls of these when forces acted last.
    Array<CrackTip<D>> tip_;
    Array<std::uint32_t> cracked_;
    Array<BondPulls<D>> first_;
    double work_ = 0.0;
    BondChange change_;
    std::size_t broken_ = 0;
};

}  // namespace doseki
