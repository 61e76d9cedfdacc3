#pragma once
#include <cstdint>
#include <span>

#include "base/members.hpp"
#include "base/vec.hpp"
#include "pairs/pair_term.hpp"

namespace doseki {

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
    double whole = 1.0;       // 0: it is gone for good
    double opening = 0.0, max_opening = 0.0, damage = 0.0;  // see Crack

    bool cracked() const { return dot(normal, normal) > 0.0; }
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
    DOSEKI_FN BondFields<T, D> load(PairEntry at) const {
        constexpr std::size_t width = T::size();
        const std::uint32_t* const codes =
            code.data() + first[at.first / width] + at.number * width;
        BondFields<T, D> bond;
        for (int a = 0; a < D; ++a)
            bond.jump[a] = T([&](auto lane) {
                const double jump = state[codes[lane] >> 1].jump[a];
                return (codes[lane] & 1u) != 0 ? -jump : jump;
            });
        bond.whole = T([&](auto lane) { return state[codes[lane] >> 1].whole; });
        return bond;
    }
};

}  // namespace doseki
