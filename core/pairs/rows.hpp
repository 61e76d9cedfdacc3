#pragma once
// Which records a pair term reads: W particles i, one in each lane, or one neighbour j in all
// lanes; where particles are taken in groups, those of a group in turn, or a neighbour for each
// turn. take<Point>(records, rows) makes a Point of them, whatever its members are.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include "base/members.hpp"

namespace doseki {

/// Row j of an array of records, as a T: itself, or in all lanes of a pack.
template <class T>
struct OneRow {
    using Number = T;
    std::uint32_t j;

    DOSEKI_FN OneRow within(std::uint32_t low, std::uint32_t high) const {
        return {std::clamp(j, low, high)};
    }
    /// The same of an array whose first record is number `first`.
    DOSEKI_FN OneRow counted_from(std::uint32_t first) const { return {j - first}; }
};

template <class Point, class Record, class T>
DOSEKI_FN Point take(std::span<const Record> records, OneRow<T> row) {
    return converted<Point>(records[row.j]);
}

#if !defined(__CUDACC__)
/// `period` consecutive rows, one in each lane and then again; beyond the limits, the row there.
template <class real, int period = lanes<real>>
struct LaneRows {
    using Number = Pack<real>;
    std::uint32_t first, lowest, highest, base = 0;

    LaneRows within(std::uint32_t low, std::uint32_t high) const {
        return {first, low, high, base};
    }
    LaneRows counted_from(std::uint32_t number) const { return {first, lowest, highest, number}; }
    std::uint32_t operator[](std::size_t lane) const {
        return std::clamp(first + static_cast<std::uint32_t>(lane % period), lowest, highest) -
               base;
    }
};

/// How many particles share the neighbours that are picked out for them, and how many of these
/// neighbours are summed at once, side by side. The fewer the particles, the more of what is in
/// reach of one is in reach of all; the more neighbours at once, the more loads. Measured in
/// docs/decisions/0054-neighbours-side-by-side.md.
template <class real>
inline constexpr int group_size = std::min(std::is_same_v<real, double> ? 4 : 8, lanes<real>);
template <class real>
inline constexpr int abreast = lanes<real> / group_size<real>;

/// Number of the group of lanes that each lane is of.
template <class real>
Pack<real> lane_group() {
    return Pack<real>([](int lane) { return static_cast<real>(lane / group_size<real>); });
}

/// Rows of several neighbours, each in one group of lanes.
template <class real>
struct RowsAbreast {
    using Number = Pack<real>;
    std::array<std::uint32_t, abreast<real>> j;

    RowsAbreast counted_from(std::uint32_t first) const {
        RowsAbreast rows;
        for (std::size_t k = 0; k < j.size(); ++k) rows.j[k] = j[k] - first;
        return rows;
    }
};

struct FillGroups {
    template <class Lanes, class First, class... Number>
    DOSEKI_FN void operator()(Lanes& to, const First& first, const Number&... others) const {
        using real = typename Lanes::value_type;
        to = Lanes(first);
        [[maybe_unused]] real group(0);
        (..., (stdx::where(lane_group<real>() > group, to) = Lanes(others), ++group));
    }
};

template <class Point, class Record, class real>
DOSEKI_FN Point take(std::span<const Record> records, const RowsAbreast<real>& rows) {
    Point point;
    const FillGroups fill;
    [&]<std::size_t... k>(std::index_sequence<k...>) {
        for_each_number(fill, point, records[rows.j[k]]...);
    }(std::make_index_sequence<static_cast<std::size_t>(abreast<real>)>{});
    return point;
}

struct FillLanes {
    template <class Lanes, class... Number>
    DOSEKI_FN void operator()(Lanes& lanes, const Number&... number) const {
        const typename Lanes::value_type values[] = {number...};
        lanes.copy_from(values, stdx::element_aligned);
    }
};

template <class Point, class Record, class real, int period>
Point take(std::span<const Record> records, const LaneRows<real, period>& rows) {
    Point point;
    const FillLanes fill;
    [&]<std::size_t... lane>(std::index_sequence<lane...>) {
        for_each_number(fill, point, records[rows[lane]]...);
    }(std::make_index_sequence<lanes<real>>{});
    return point;
}

struct TakeLane {
    int lane;
    template <class T, class Lanes>
    void operator()(T& to, const Lanes& from) const {
        to = static_cast<T>(from[lane]);
    }
};

/// One lane of packed accumulators, as those of one particle.
template <class One, class Packed>
One lane_of(const Packed& packed, int lane) {
    One one;
    const TakeLane take_lane{lane};
    for_each_number(take_lane, one, packed);
    return one;
}
#endif

}  // namespace doseki
