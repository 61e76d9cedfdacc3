#pragma once
// The sums of elastic solids as terms of the pair loop, which runs over pairs at rest: the
// records' coordinates are the reference positions X.

#include "bodies/elastic/bonds.hpp"
#include "bodies/elastic/records.hpp"
#include "pairs/rows.hpp"
#include "physics/hourglass.hpp"
#include "physics/kernel/wendland_c2.hpp"
#include "physics/velocity_gradient.hpp"

namespace doseki {

/// Common to all terms, which take point i as an Own and its neighbours as an Other. No point of a
/// solid is fixed to the pair loop, clamped ones included.
template <int D, template <class, int> class Own, template <class, int> class Other>
struct ElasticTerm : ElasticRecords<D> {
    using Real = double;
    static constexpr int dim = D;

    template <class Rows>
    DOSEKI_FN auto load(Rows rows) const {
        return Own<typename Rows::Number, D>::of(*this, rows);
    }
    template <class T>
    DOSEKI_FN auto load_moving(OneRow<T> j) const {
        return Other<T, D>::of(*this, j);
    }
    template <class T>
    DOSEKI_FN auto load_fixed(OneRow<T> j) const {
        return Other<T, D>::of(*this, j);
    }
    template <class Sums, class T>
    DOSEKI_FN void add_fixed(Sums&, const Pair<T, D>&, const Own<T, D>&, const Other<T, D>&) const {
    }
};

template <class T, int D>
struct DeformationAccumulators {
    Mat<T, D> place{}, velocity{};  // sum V_j (x_j - x_i) (x) grad0 W, the same of v

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.place...), f(self.velocity...);
    }
};

/// Eq. (80) before correction: the deformation gradient and its rate.
template <int D>
struct DeformationTerm : ElasticTerm<D, PlacedPoint, PlacedPoint> {
    template <class T>
    using Accumulators = DeformationAccumulators<T, D>;

    template <class T>
    DOSEKI_FN void add(Accumulators<T>& sums, const Pair<T, D>& pair, const PlacedPoint<T, D>& i,
                       const PlacedPoint<T, D>& j) const {
        const T F = WendlandC2<D>::gradient_factor(pair.r, i.inverse_support);
        add_velocity_gradient(sums.place, j.volume, i.x - j.x, F, pair.r_ij);
        add_velocity_gradient(sums.velocity, j.volume, i.v - j.v, F, pair.r_ij);
    }
};

/// What Eq. (83a) and the energy of the springs of Eq. (83) need.
template <int D>
struct SpringTerm : ElasticTerm<D, ElasticPoint, PlacedPoint> {
    template <class T>
    using Accumulators = MisfitMoments<T, D>;

    template <class T>
    DOSEKI_FN void add(MisfitMoments<T, D>& sums, const Pair<T, D>& pair,
                       const ElasticPoint<T, D>& i, const PlacedPoint<T, D>& j) const {
        const T weight = -(j.volume * WendlandC2<D>::gradient_factor(pair.r, i.inverse_support));
        const Vec<T, D> rate = i.v - j.v - i.F_rate * pair.r_ij;
        sums.add(weight, i.x - j.x - i.F * pair.r_ij, rate);
    }
};

/// Per volume at rest.
template <class T, int D>
struct InternalForce {
    Vec<T, D> all{}, damping{};  // the share of both dampers in it

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.all...), f(self.damping...);
    }
};

/// Eqs. (83) and (83a).
template <int D>
struct InternalForceTerm : ElasticTerm<D, ElasticPoint, ElasticPoint> {
    template <class T>
    using Accumulators = InternalForce<T, D>;

    template <class T>
    DOSEKI_FN void add(InternalForce<T, D>& force, const Pair<T, D>& pair,
                       const ElasticPoint<T, D>& i, const ElasticPoint<T, D>& j) const {
        const T F = WendlandC2<D>::gradient_factor(pair.r, i.inverse_support);
        const Vec<T, D> elastic =
            elastic_pair_force(i.Q, j.Q, i.kappa + j.kappa, pair.r_ij, i.x - j.x);
        const Vec<T, D> damping =
            (i.kappa_rate + j.kappa_rate) * (i.v - j.v) - (i.spin + j.spin) * (i.x - j.x);
        const T weight = j.volume * F;
        force.all = force.all + weight * (elastic + damping);
        force.damping =
            force.damping + weight * ((i.Q_damping + j.Q_damping) * pair.r_ij + damping);
    }
};

// Bodies whose bonds may crack: a crack lengthens the vector between two points at rest, and a bond
// that bears nothing has no weight. Nothing else changes, Eq. (108).

/// A pair as its bond has made it.
template <class T, int D, class Point>
struct BondedPair {
    Pair<T, D> pair;
    Point j;
    BondedPair(const BondFields<T, D>& bond, const Pair<T, D>& pair, const Point& j)
        : pair{pair.r_ij + bond.jump, pair.r}, j(j) {
        this->j.volume *= bond.whole;
    }
};

/// A term of solids that do not break, over bonds.
template <class Term>
struct Bonded : Term {
    using SeesEntries = void;
    static constexpr int D = Term::dim;

    BondRows<D> bonds;

    template <class Sums, class T, class Own, class Other>
    DOSEKI_FN void add(Sums& sums, const Pair<T, D>& pair, const Own& i, const Other& j,
                       PairEntry at) const {
        const BondedPair bonded(bonds.template load<T>(at), pair, j);
        Term::add(sums, bonded.pair, i, bonded.j);
    }
};

template <class T, int D>
struct BondedDeformation {
    DeformationAccumulators<T, D> now;
    Mat<T, D> shape{};  // what `now.place` is at rest: its inverse corrects, B of Eq. (80)

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.now...), f(self.shape...);
    }
};

/// Eq. (80) with the matrix of the bonds that are left.
template <int D>
struct BondedDeformationTerm : DeformationTerm<D> {
    using SeesEntries = void;
    template <class T>
    using Accumulators = BondedDeformation<T, D>;

    BondRows<D> bonds;

    template <class T>
    DOSEKI_FN void add(Accumulators<T>& sums, const Pair<T, D>& pair, const PlacedPoint<T, D>& i,
                       const PlacedPoint<T, D>& j, PairEntry at) const {
        const BondedPair bonded(bonds.template load<T>(at), pair, j);
        DeformationTerm<D>::add(sums.now, bonded.pair, i, bonded.j);
        const T F = WendlandC2<D>::gradient_factor(pair.r, i.inverse_support);
        add_velocity_gradient(sums.shape, bonded.j.volume, bonded.pair.r_ij, F, bonded.pair.r_ij);
    }
};

}  // namespace doseki
