#pragma once
// Loops over all particles that run where the particles are: on the threads of the processor or, in
// a build for a device, there, by Thrust. Functions are objects that are copied to where they run:
// what they refer to lies in memory that a device reaches (base/memory.hpp), and what they call is
// marked DOSEKI_DEVICE_FN. Loops of other code are in base/parallel.hpp.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <type_traits>

#include "base/array.hpp"
#include "base/parallel.hpp"

#if defined(DOSEKI_DEVICE)
#include <thrust/binary_search.h>
#include <thrust/execution_policy.h>
#include <thrust/for_each.h>
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>
#include <thrust/scan.h>
#include <thrust/sequence.h>
#include <thrust/sort.h>
#endif

namespace doseki::bulk {

/// Numbers of elements in the order of their keys, equal ones as they were, and where those of each
/// key start; the last start is the number of elements.
struct Buckets {
    Array<std::uint32_t> order, starts;
};

#if defined(DOSEKI_DEVICE)
/// Calls f(k) for k = 0 ... count - 1; calls must not depend on one another.
template <class F>
void for_each(std::size_t count, const F& f) {
    thrust::for_each_n(thrust::device, thrust::counting_iterator<std::size_t>(0), count, f);
}

/// The same for particles of two kinds and for pairs of bodies, see base/parallel.hpp.
template <class F>
void for_each(std::size_t, std::size_t count, const F& f) {
    for_each(count, f);
}
template <class F>
void for_each_contact(std::size_t count, const F& f) {
    for_each(count, f);
}

/// Room for values that a device writes first: the processor touches none of it.
template <class T>
class Scratch {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    explicit Scratch(std::size_t count) : count_(count), data_(Memory<T>().allocate(count)) {}
    ~Scratch() { Memory<T>().deallocate(data_, count_); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    T* data() const { return data_; }
    const T* begin() const { return data_; }
    const T* end() const { return data_ + count_; }

private:
    std::size_t count_;
    T* data_;
};

/// Part k of a reduction takes each of `parts` in turn, so that threads side by side read elements
/// side by side.
template <class Value, class Combine, class F>
struct ReducePart {
    std::size_t count, parts;
    Value start;
    Combine combine;
    F f;
    Value* results;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        Value result = start;
        for (std::size_t p = k; p < count; p += parts) result = combine(result, f(p));
        results[k] = result;
    }
};

template <class Value>
struct PartAt {
    const Value* parts;
    DOSEKI_DEVICE_FN const Value& operator()(std::size_t k) const { return parts[k]; }
};

/// Combines f(0), f(1) ... f(count - 1), beginning with the neutral `start`. The order is always
/// the same one, whatever the number of threads.
template <class Value, class Combine, class F>
Value reduce(std::size_t count, const Value& start, const Combine& combine, const F& f) {
    constexpr std::size_t fewest = 256, most = 32768;
    const std::size_t parts = std::min(count, count > most ? most : fewest);
    if (parts == 0) return start;
    const Scratch<Value> results(parts);
    for_each(parts, ReducePart<Value, Combine, F>{count, parts, start, combine, f, results.data()});
    if (parts > fewest) return reduce(parts, start, combine, PartAt<Value>{results.data()});
    Value result = start;
    for (const Value& part : results) result = combine(result, part);
    return result;
}

/// Where rows of these lengths start that lie one after another, and where the last one ends.
template <class Number, class Length>
Array<Number> starts_of(std::size_t count, const Length& length) {
    Array<Number> starts(count + 1, 0);
    const auto lengths =
        thrust::make_transform_iterator(thrust::counting_iterator<std::size_t>(0), length);
    thrust::inclusive_scan(thrust::device, lengths, lengths + static_cast<std::ptrdiff_t>(count),
                           starts.data() + 1);
    return starts;
}

/// Sorts elements by keys below `count`.
inline Buckets sorted_by(Array<std::uint32_t> keys, std::size_t count) {
    Buckets sorted{Array<std::uint32_t>(keys.size()), Array<std::uint32_t>(count + 1)};
    std::uint32_t *const first = keys.data(), *const last = first + keys.size();
    thrust::sequence(thrust::device, sorted.order.data(), sorted.order.data() + keys.size());
    thrust::stable_sort_by_key(thrust::device, first, last, sorted.order.data());
    const thrust::counting_iterator<std::uint32_t> key(0);
    thrust::lower_bound(thrust::device, first, last, key,
                        key + static_cast<std::ptrdiff_t>(count + 1), sorted.starts.data());
    return sorted;
}
#else
template <class F>
void for_each(std::size_t count, const F& f) {
    for_each_particle(count, f);
}

template <class F>
void for_each(std::size_t moving, std::size_t count, const F& f) {
    for_each_particle(moving, count, f);
}

template <class F>
void for_each_contact(std::size_t count, const F& f) {
    doseki::for_each_contact(count, f);
}

template <class Value, class Combine, class F>
Value reduce(std::size_t count, const Value& start, const Combine& combine, const F& f) {
    return doseki::reduce(count, start, combine, f);
}

template <class Number, class Length>
Array<Number> starts_of(std::size_t count, const Length& length) {
    Array<Number> starts(count + 1, 0);
    for (std::size_t k = 0; k < count; ++k)
        starts[k + 1] = starts[k] + static_cast<Number>(length(k));
    return starts;
}

inline Buckets sorted_by(const Array<std::uint32_t>& keys, std::size_t count) {
    Buckets sorted{Array<std::uint32_t>(keys.size()), Array<std::uint32_t>(count + 1)};
    for (const std::uint32_t key : keys) ++sorted.starts[key + 1];
    std::partial_sum(sorted.starts.begin(), sorted.starts.end(), sorted.starts.begin());
    Array<std::uint32_t> next(sorted.starts.begin(), sorted.starts.end() - 1);
    for (std::uint32_t k = 0; k < keys.size(); ++k) sorted.order[next[keys[k]]++] = k;
    return sorted;
}
#endif

}  // namespace doseki::bulk
