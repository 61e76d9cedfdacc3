#pragma once
// What a back end does for a run. Schemes, bodies and boundaries say what is to be done for a pair
// or for a particle; a back end says where: Cpu (cpu.hpp) with threads and packs, compiled once for
// each instruction set; a device with one thread for each particle.

#include <concepts>
#include <span>

#include "base/array.hpp"
#include "pairs/count_term.hpp"
#include "pairs/pairs_to_sum.hpp"

namespace doseki {

/// Positions, supports and kinds of particles that are to be sorted.
template <int D>
struct ParticlesToSort {
    std::span<const Vec<double, D>> position;
    std::span<const double> support;
    std::span<const std::uint8_t> is_fixed;
    std::span<const std::uint8_t> is_near;  // to other ranks; empty: none is
};

template <class B, int D>
concept SortsAndLists = requires(typename B::template Lists<D> lists, ParticlesToSort<D> particles,
                                 double skin, std::span<const std::int32_t> faces) {
    { B::sort(lists, particles) } -> std::same_as<Array<std::uint32_t>>;  // order of storage
    B::build_lists(lists, particles.position, particles.support, skin, faces);
};

template <class B, int D>
using PairsOf = PairsToSum<typename B::Real, D, typename B::template Lists<D>::List>;

template <class B, int D>
concept SumsPairs = requires(const typename B::template Lists<D>& lists, const PairsOf<B, D>& pairs,
                             const CountTerm<typename B::Real, D>& term,
                             void (*epilogue)(std::size_t, const NeighbourCounts<double>&)) {
    B::sum_pairs(lists, pairs, term, epilogue);
};

template <class B>
concept LoopsOverParticles =
    requires(std::size_t count, void (*f)(std::size_t), double (*value)(std::size_t)) {
        B::for_each_particle(count, f);
        B::for_each_particle(count, count, f);
        { B::reduce(count, 0.0, maximum, value) } -> std::same_as<double>;
    };

/// An epilogue that keeps the sums of one particle.
template <class Sums>
struct KeepSums {
    std::size_t particle;
    Sums* kept;

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const Sums& sums) const {
        if (p == particle) *kept = sums;
    }
};

/// The sums of particle p, which is of the clusters that are given.
template <class B, class Lists, class Pairs, class Term>
auto sums_of_particle(const Lists& lists, const Pairs& pairs, const Term& term, std::size_t p) {
    using Sums = typename Term::template Accumulators<double>;
    Array<Sums> kept(1);
    B::sum_pairs(lists, pairs, term, KeepSums<Sums>{p, kept.data()});
    return kept[0];
}

/// What an epilogue keeps for the cluster of particle p, see the back end's `summaries`.
template <class real, class Summary>
DOSEKI_DEVICE_FN Summary& summary_of(std::span<Summary> summaries, std::size_t p) {
    return summaries[p / static_cast<std::size_t>(lanes<real>) % summaries.size()];
}

/// `Real` is the number of pair sums; `width` how many particles share a list.
template <class B, int D>
concept Backend = requires {
    typename B::Real;
    B::width + 0;
} && SortsAndLists<B, D> && SumsPairs<B, D> && LoopsOverParticles<B>;

}  // namespace doseki
