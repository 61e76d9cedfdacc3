#pragma once
#include "base/array.hpp"
#include "base/bulk.hpp"
#include "pairs/backend.hpp"

namespace doseki {

/// What all back ends do alike: sorting, and loops over particles.
struct BulkBackend {
    template <int D>
    static Array<std::uint32_t> sort(SortedCells<D>& lists, const ParticlesToSort<D>& particles) {
        return lists.sort(particles.position, particles.support, particles.is_fixed,
                          particles.is_near);
    }
    template <class F>
    static void for_each_particle(std::size_t count, const F& f) {
        bulk::for_each(count, f);
    }
    /// Of which the first `moving` are in the clusters that move.
    template <class F>
    static void for_each_particle(std::size_t moving, std::size_t count, const F& f) {
        bulk::for_each(moving, count, f);
    }
    template <class Value, class Combine, class F>
    static Value reduce(std::size_t count, const Value& start, const Combine& combine, const F& f) {
        return bulk::reduce(count, start, combine, f);
    }
};

}  // namespace doseki
