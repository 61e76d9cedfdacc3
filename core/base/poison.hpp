#pragma once
// Poison: with DOSEKI_POISON set in the environment, outputs hold NaN before each pass, so that one
// that a pass leaves out, or a later one that reads too early, shows at once.

#include <cmath>
#include <cstdlib>
#include <limits>
#include <type_traits>

#include "base/field.hpp"

namespace doseki {

inline bool is_poisoned_run() {
    static const bool is_set = std::getenv("DOSEKI_POISON") != nullptr;
    return is_set;
}

/// Calls f(number) on every floating-point number of a field of records made of `real` alone.
template <class real, class Record, class F>
void for_each_stored_number(Field<Record>& records, F&& f) {
    static_assert(std::is_trivially_copyable_v<Record> && sizeof(Record) % sizeof(real) == 0);
    auto* const number = reinterpret_cast<real*>(records.data());
    for (std::size_t k = 0; k < records.size() * sizeof(Record) / sizeof(real); ++k) f(number[k]);
}

template <class real, class Record>
void poison(Field<Record>& records) {
    for_each_stored_number<real>(
        records, [](real& number) { number = std::numeric_limits<real>::quiet_NaN(); });
}

/// Index of the first record that still holds a NaN, or -1.
template <class real, class Record>
std::int64_t survivor(Field<Record>& records) {
    std::int64_t first = -1, k = 0;
    for_each_stored_number<real>(records, [&](real& number) {
        if (first < 0 && std::isnan(number))
            first = k / static_cast<std::int64_t>(sizeof(Record) / sizeof(real));
        ++k;
    });
    return first;
}

}  // namespace doseki
