#pragma once
// The two sums of elastic solids as terms of the pair loop, which runs over pairs at rest: the
// records' coordinates are the reference positions X.

#include <span>

#include "pair_loop.hpp"
#include "physics/hourglass.hpp"
#include "physics/kernel.hpp"
#include "terms.hpp"

namespace doseki {

/// What the sums need of a point beside its place at rest.
template <int D>
struct ElasticRecord {
    std::array<double, D> x;      // where it is now
    double volume;                // at rest [m^D]
    double kappa, kappa_rate;     // stiffness [Pa] and damping [Pa s] of the springs
    std::array<double, D * D> Q;  // see less_springs
};

template <class T, int D>
struct ElasticPoint {
    Vec<T, D> x, v;
    T volume, inverse_support, kappa, kappa_rate;
    Mat<T, D> Q;
};

/// `get(k -> value of record k)` makes a T of a member: of one record, or lane by lane.
template <class T, int D, class Get>
DOSEKI_FN ElasticPoint<T, D> elastic_point(const MotionRecord<double, D>* motion,
                                           const ElasticRecord<D>* solid, const Get& get) {
    ElasticPoint<T, D> point;
    for (int a = 0; a < D; ++a) {
        point.x[a] = get([=](std::uint32_t p) { return solid[p].x[a]; });
        point.v[a] = get([=](std::uint32_t p) { return motion[p].v[a]; });
    }
    point.volume = get([=](std::uint32_t p) { return solid[p].volume; });
    point.inverse_support = get([=](std::uint32_t p) { return motion[p].inverse_support; });
    point.kappa = get([=](std::uint32_t p) { return solid[p].kappa; });
    point.kappa_rate = get([=](std::uint32_t p) { return solid[p].kappa_rate; });
    for (int k = 0; k < D * D; ++k)
        point.Q.element[k] = get([=](std::uint32_t p) { return solid[p].Q[k]; });
    return point;
}

template <int D>
struct ElasticRecords {
    std::span<const MotionRecord<double, D>> motion;
    std::span<const ElasticRecord<D>> solid;

    DOSEKI_FN ElasticPoint<Pack<double>, D> one(std::uint32_t j) const {
        return elastic_point<Pack<double>>(motion.data(), solid.data(),
                                           [j](auto member) { return Pack<double>(member(j)); });
    }
    /// W in a row; lanes beyond the last repeat it.
    ElasticPoint<Pack<double>, D> lanes_from(std::uint32_t first) const {
        const auto last = static_cast<std::uint32_t>(solid.size() - 1);
        return elastic_point<Pack<double>>(motion.data(), solid.data(), [=](auto member) {
            return Pack<double>(
                [&](auto l) { return member(std::min<std::uint32_t>(first + l, last)); });
        });
    }
};

/// Common to both terms: no point of a solid is fixed to the pair loop, clamped ones included.
template <int D>
struct ElasticTerm {
    template <class T>
    using Point = ElasticPoint<T, D>;
    using Lanes = Pack<double>;

    ElasticRecords<D> records;

    auto load(std::uint32_t first) const { return records.lanes_from(first); }
    DOSEKI_FN auto load_one(std::uint32_t j) const { return records.one(j); }
    DOSEKI_FN auto load_fixed(std::uint32_t j) const { return records.one(j); }
    template <class Sums>
    void moving_done(Sums&) const {}
    template <class Sums>
    void add_fixed(Sums&, const Pair<Lanes, D>&, const Point<Lanes>&, const Point<Lanes>&) const {}
};

template <class T, int D>
struct DeformationSums {
    Mat<T, D> place{}, velocity{};  // sum V_j (x_j - x_i) (x) grad0 W, the same of v
};

/// Eq. (80) before correction: the deformation gradient and its rate; `finish(p, sums)` once for
/// each point.
template <int D, class Finish>
struct DeformationTerm : ElasticTerm<D> {
    template <class T>
    using Sums = DeformationSums<T, D>;
    using Lanes = Pack<double>;

    const Finish& finish_point;

    DOSEKI_FN void add(Sums<Lanes>& sums, const Pair<Lanes, D>& pair,
                       const ElasticPoint<Lanes, D>& i, const ElasticPoint<Lanes, D>& j) const {
        const Lanes F = WendlandC2<D>::gradient_factor(pair.r, i.inverse_support);
        add_velocity_gradient(sums.place, j.volume, i.x - j.x, F, pair.r_ij);
        add_velocity_gradient(sums.velocity, j.volume, i.v - j.v, F, pair.r_ij);
    }

    void finish(std::uint32_t first, int count, const Sums<Lanes>& sums) const {
        for (int l = 0; l < count; ++l) {
            DeformationSums<double, D> lane;
            for (int k = 0; k < D * D; ++k) {
                lane.place.element[k] = sums.place.element[k][l];
                lane.velocity.element[k] = sums.velocity.element[k][l];
            }
            finish_point(first + l, lane);
        }
    }
};

/// Eq. (83): force per volume at rest; `finish(p, force)` once for each point.
template <int D, class Finish>
struct InternalForceTerm : ElasticTerm<D> {
    template <class T>
    using Sums = Vec<T, D>;
    using Lanes = Pack<double>;

    const Finish& finish_point;

    DOSEKI_FN void add(Vec<Lanes, D>& force, const Pair<Lanes, D>& pair,
                       const ElasticPoint<Lanes, D>& i, const ElasticPoint<Lanes, D>& j) const {
        const Lanes F = WendlandC2<D>::gradient_factor(pair.r, i.inverse_support);
        const Vec<Lanes, D> elastic =
            elastic_pair_force(i.Q, j.Q, i.kappa + j.kappa, pair.r_ij, i.x - j.x);
        force = force + (j.volume * F) * (elastic + (i.kappa_rate + j.kappa_rate) * (i.v - j.v));
    }

    void finish(std::uint32_t first, int count, const Vec<Lanes, D>& force) const {
        for (int l = 0; l < count; ++l) {
            Vec<double, D> lane;
            for (int a = 0; a < D; ++a) lane[a] = force[a][l];
            finish_point(first + l, lane);
        }
    }
};

}  // namespace doseki
