#pragma once
// What a back end does for a run. Schemes, bodies and boundaries say what is to be done for a pair
// or for a particle; a back end says where: Cpu (cpu.hpp) with threads and packs, compiled once for
// each instruction set; a device with one thread for each particle.

#include <concepts>
#include <span>

#include "base/array.hpp"
#include "pairs/count_term.hpp"
#include "pairs/loop.hpp"

namespace doseki {

/// Positions, supports and kinds of particles that are to be sorted.
template <int D>
struct ParticlesToSort {
    std::span<const Vec<double, D>> position;
    std::span<const double> support;
    std::span<const std::uint8_t> is_fixed;
    std::span<const std::uint8_t> is_near;  // to other ranks; empty: none is
};

/// Between which particles a sum runs: clusters of lists and the records they refer to.
template <class real, int D>
struct PairsToSum {
    std::span<const ClusterList> clusters;
    std::span<const MotionRecord<real, D>> records;
    CoordinateFrame<real, D> frame;
    PairLoopOptions options;
};

template <class B, int D>
concept SortsAndLists = requires(typename B::template Lists<D> lists, ParticlesToSort<D> particles,
                                 double skin, std::span<const std::int32_t> faces) {
    { B::sort(lists, particles) } -> std::same_as<Array<std::uint32_t>>;  // order of storage
    B::build_lists(lists, particles.position, particles.support, skin, faces);
};

template <class B, int D>
concept SumsPairs = requires(const typename B::template Lists<D>& lists,
                             const PairsToSum<typename B::Real, D>& pairs,
                             const CountTerm<typename B::Real, D>& term,
                             void (*epilogue)(std::size_t, const NeighbourCounts<double>&)) {
    B::sum_pairs(lists, pairs, term, epilogue);
};

template <class B>
concept LoopsOverParticles =
    requires(std::size_t count, void (*f)(std::size_t), double (*value)(std::size_t)) {
        B::for_each_particle(count, f);
        { B::reduce(count, 0.0, maximum, value) } -> std::same_as<double>;
    };

/// `Real` is the number of pair sums; `width` how many particles share a list.
template <class B, int D>
concept Backend = requires {
    typename B::Real;
    B::width + 0;
} && SortsAndLists<B, D> && SumsPairs<B, D> && LoopsOverParticles<B>;

}  // namespace doseki
