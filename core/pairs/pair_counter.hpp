#pragma once
#include <span>

#include "base/array.hpp"
#include "pairs/backend.hpp"

namespace doseki {

/// An epilogue that keeps how many neighbours a particle has. A cluster that holds moving and fixed
/// particles lists fixed ones for both.
struct KeepCounts {
    double* of_particle;
    std::size_t moving;

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const NeighbourCounts<double>& count) const {
        of_particle[p] = count.moving + (p < moving ? count.fixed : 0.0);
    }
};

/// How many pairs the records of a scheme have.
template <class Scheme>
class PairCounter {
public:
    using Real = typename Scheme::Real;
    using Backend = typename Scheme::Backend;
    using Lists = typename Backend::template Lists<Scheme::dim>;
    using List = typename Lists::List;
    using Records = std::span<const MotionRecord<Real, Scheme::dim>>;

    PairCounter(const Scheme& scheme, const Lists& lists) : scheme_(scheme), lists_(lists) {}

    /// Pairs (i, j), each way counted, that are within support of each other.
    double interacting_pairs() const { return count(lists_.clusters(), scheme_.motion_records()); }

    /// Neighbours within support of each particle, ghosts left out.
    Array<double> counts() const { return counts(lists_.clusters(), scheme_.motion_records()); }

    double count(std::span<const List> clusters, Records records) const {
        double total = 0.0;
        for (double count : counts(clusters, records)) total += count;
        return total;
    }

    Array<double> counts(std::span<const List> clusters, Records records) const {
        Array<double> of_particle(records.size());
        Backend::sum_pairs(lists_, {clusters, records, scheme_.frame(), {}},
                           CountTerm<Real, Scheme::dim>{records},
                           KeepCounts{of_particle.data(), lists_.moving()});
        return of_particle;
    }

private:
    const Scheme& scheme_;
    const Lists& lists_;
};

}  // namespace doseki
