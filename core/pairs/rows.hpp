#pragma once
// Which records a pair term reads: one neighbour j in all lanes, or W particles i, one in each.
// take<Point>(records, rows) makes a Point of them, whatever its members are.

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "base/members.hpp"

namespace doseki {

/// Row j of an array of records, as a T: itself, or in all lanes of a pack.
template <class T>
struct OneRow {
    using Number = T;
    std::uint32_t j;

    /// The same of an array whose first record is number `first`.
    DOSEKI_FN OneRow counted_from(std::uint32_t first) const { return {j - first}; }
};

template <class Point, class Record, class T>
DOSEKI_FN Point take(std::span<const Record> records, OneRow<T> row) {
    return converted<Point>(records[row.j]);
}

#if !defined(__CUDACC__)
/// W consecutive rows, one in each lane; lanes beyond the limits repeat the row there.
template <class real>
struct LaneRows {
    using Number = Pack<real>;
    std::uint32_t first, lowest, highest, base = 0;

    LaneRows within(std::uint32_t low, std::uint32_t high) const {
        return {first, low, high, base};
    }
    LaneRows counted_from(std::uint32_t number) const { return {first, lowest, highest, number}; }
    std::uint32_t operator[](std::size_t lane) const {
        return std::clamp(first + static_cast<std::uint32_t>(lane), lowest, highest) - base;
    }
};

struct FillLanes {
    template <class Lanes, class... Number>
    DOSEKI_FN void operator()(Lanes& lanes, const Number&... number) const {
        const typename Lanes::value_type values[] = {number...};
        lanes.copy_from(values, stdx::element_aligned);
    }
};

template <class Point, class Record, class real>
Point take(std::span<const Record> records, const LaneRows<real>& rows) {
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
