#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "base/array.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/principal.hpp"
#include "bodies/deformable/deformable_body.hpp"
#include "bodies/deformable/elastic_law.hpp"
#include "bodies/fracture/bond_records.hpp"
#include "model/archive.hpp"

namespace doseki {

/// A point of a breakable body, as its bonds see it.
template <int D>
struct BondPoint {
    Vec<double, D> rest, x;
    Mat<double, D> F, B;      // deformation gradient and correction, Eq. (80)
    Mat<double, D> P;         // first Piola-Kirchhoff stress without damping
    double volume, kappa;     // at rest; stiffness of the springs
    bool spans;               // whether its bonds span the space, so that it has a stress
};

/// What one step did to bonds: energy that went into them [J], 2-D: [J/m], how many stopped to hold,
/// and how many touch or part.
struct BondChange {
    double work = 0.0;
    std::size_t broken = 0, switched = 0;

    BondChange operator+(const BondChange& other) const {
        return {work + other.work, broken + other.broken, switched + other.switched};
    }
};

/// The bonds between points of breakable bodies: pairs at rest, each once. Cracks live on them, Eqs.
/// (108) to (114): a crack opens across a bond, along the largest principal stress that it had when
/// the crack began, until the bond bears no tension. While its sides press on each other a broken
/// bond bears compression and does not slide; open, it bears nothing.
template <int D>
class Bonds {
public:
    bool any() const { return pairs_.size() > 1; }
    /// All numbers but 0, which is that of pairs that cannot break.
    std::size_t size() const { return pairs_.size(); }

    /// A bond between points a < b, `weight` = -F of Eq. (25) at rest.
    void add(std::uint32_t a, std::uint32_t b, double weight) {
        pairs_.push_back({a, b, weight});
        state_.emplace_back();
    }
    void clear() {
        pairs_.assign(1, Ends{}), state_.assign(1, {}), code_.clear(), first_code_.clear();
        work_ = 0.0, change_ = {}, broken_ = 0;
    }
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
        if (p + 1 >= first_bond_.size()) return;
        for (std::size_t n = first_bond_[p]; n < first_bond_[p + 1]; ++n) {
            const Ends& ends = pairs_[bond_[n]];
            f(ends.a == p ? ends.b : ends.a, intactness(bond_[n]));
        }
    }
    /// Ends for good those bonds between points a and b for which apart(a, b): their points meet
    /// only as those of two bodies.
    template <class Apart>
    void part(const Apart& apart) {
        for (std::size_t n = 1; n < size(); ++n)
            if (apart(pairs_[n].a, pairs_[n].b)) broken_ += intactness(n) > 0.0, part(state_[n]);
    }
    /// Bonds that bear no tension.
    std::size_t broken() const { return broken_; }
    /// What the last step did.
    const BondChange& change() const { return change_; }
    /// Energy that all steps took [J], 2-D: [J/m].
    double work() const { return work_; }

    /// A step of all cracks: point(p) is a BondPoint, body(p) its DeformableBody.
    template <class Point, class Body>
    void advance(double dt, const Point& point, const Body& body);

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
    struct Ends {
        std::uint32_t a = 0, b = 0;
        double weight = 0.0;
    };
    /// Of the length of a bond: below this part of it along the normal, a crack does not cross it.
    static constexpr double least_crossing = 0.25;
    /// Of what would take the stress of a bond away in one step of its crack, so that those of
    /// neighbours do not overshoot together.
    static constexpr double relaxation = 0.7;
    /// Of the length of a bond: sides of a crack farther apart than this do not find each other.
    static constexpr double reach = 0.5;

    double intactness(std::size_t n) const {
        const BondState<D>& s = state_[n];
        return s.whole == 0.0 || s.parted != 0.0 ? 0.0 : 1.0 - s.damage;
    }
    static void part(BondState<D>& s) { s.parted = 1.0, s.whole = 0.0, s.damage = 1.0; }
    static void expect_state(const BondState<D>& s) {
        bool good = (s.whole == 0.0 || s.whole == 1.0) && (s.parted == 0.0 || s.parted == 1.0) &&
                    s.damage >= 0.0 && s.damage <= 1.0 && s.opening >= 0.0 &&
                    s.max_opening >= s.opening && std::isfinite(s.max_opening);
        for (int a = 0; a < D; ++a)
            good = good && std::isfinite(s.jump[a]) && std::abs(s.normal[a]) <= 1.0 + 1e-9;
        expect_fit(good, "bond_state");
    }

    struct Two {  // the points of one bond
        BondPoint<D> a, b;
        double weight;
        Vec<double, D> R() const { return a.rest - b.rest; }
        Vec<double, D> r() const { return a.x - b.x; }
        Mat<double, D> mean_deformation() const { return 0.5 * (a.F + b.F); }
    };
    BondChange step(std::size_t n, double dt, const Two& two, const DeformableBody& body);
    BondChange meet(BondState<D>& s, const Two& two);
    bool begin(BondState<D>& s, std::size_t n, const Two& two, const DeformableBody& body,
               const Sym<double, D>& stress);
    CrackSite site(std::size_t n, const Vec<double, D>& normal, const Two& two,
                   const DeformableBody& body) const;
    static double released(const BondPoint<D>& i, const Vec<double, D>& R, const Vec<double, D>& r,
                           const Vec<double, D>& change);
    static double lost(const BondPoint<D>& i, const Vec<double, D>& R, const Vec<double, D>& r);

    Array<Ends> pairs_ = Array<Ends>(1);
    Array<BondState<D>> state_ = Array<BondState<D>>(1);
    Array<std::size_t> first_bond_;  // in bond_, of each point, and the end
    Array<std::uint32_t> bond_;
    Array<std::uint32_t> code_;
    Array<std::size_t> first_code_;
    double work_ = 0.0;
    BondChange change_;
    std::size_t broken_ = 0;
};

}  // namespace doseki
