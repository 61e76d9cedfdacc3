#pragma once
// Threads of the processor: the only place that knows OpenMP. Particle storage, schemes, bodies and
// boundaries say what is to be done for each particle; how it is divided is decided here.

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>

#include "base/array.hpp"

namespace doseki {

/// Below these sizes a loop ends sooner on one thread than it takes to call the others.
inline constexpr std::size_t light_loop = 2048;  // particles, a few operations each
inline constexpr std::size_t pair_loop = 32;     // clusters
inline constexpr std::size_t contact_loop = 64;  // pairs of bodies

inline void set_threads(int count) { omp_set_num_threads(count); }
/// How many threads a loop may use.
inline int thread_count() { return omp_get_max_threads(); }

/// Calls f(p) for p = 0 ... count - 1; calls must not depend on one another.
template <class F>
void for_each_particle(std::size_t count, F&& f) {
#pragma omp parallel for schedule(static) if (count > light_loop)
    for (std::size_t p = 0; p < count; ++p) f(p);
}

/// The same for particles of which the first `moving` and all others have pair sums of their own:
/// a thread gets those whose sums for_each_task() gives it, which are in the cache of its core.
template <class F>
void for_each_particle(std::size_t moving, std::size_t count, F&& f) {
#pragma omp parallel if (count > light_loop)
    {
#pragma omp for schedule(static) nowait
        for (std::size_t p = 0; p < moving; ++p) f(p);
#pragma omp for schedule(static)
        for (std::size_t p = moving; p < count; ++p) f(p);
    }
}

/// The same for pairs of bodies that may touch, each some hundred operations where they do.
template <class F>
void for_each_contact(std::size_t count, F&& f) {
#pragma omp parallel for schedule(static) if (count > contact_loop)
    for (std::size_t k = 0; k < count; ++k) f(k);
}

/// Combines f(0), f(1) ... f(count - 1), beginning with the neutral `start`: block by block, then
/// the blocks in their order, so that sums do not depend on the number of threads.
template <class Value, class Combine, class F>
Value reduce(std::size_t count, Value start, Combine&& combine, F&& f) {
    struct Block {  // threads may write to neighbours, which the bits of many bools in a row forbid
        Value value;
    };
    constexpr std::size_t size = 256;  // small, so that threads get equal shares
    Array<Block> blocks((count + size - 1) / size, Block{start});
#pragma omp parallel for schedule(static) if (count > light_loop)
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        Value result = start;
        const std::size_t end = std::min(count, (b + 1) * size);
        for (std::size_t p = b * size; p < end; ++p) result = combine(result, f(p));
        blocks[b].value = result;
    }
    Value result = start;
    for (const Block& block : blocks) result = combine(result, block.value);
    return result;
}

/// The elements of a row, for reduce().
template <class T>
struct ElementOf {
    std::span<const T> elements;
    DOSEKI_DEVICE_FN const T& operator()(std::size_t k) const { return elements[k]; }
};

/// Sets the elements of a row to what they are at first.
template <class T>
struct ClearElement {
    std::span<T> elements;
    DOSEKI_DEVICE_FN void operator()(std::size_t k) const { elements[k] = T{}; }
};

struct Maximum {
    template <class T>
    DOSEKI_DEVICE_FN T operator()(const T& a, const T& b) const {
        return std::max(a, b);
    }
};

struct Join {
    template <class T>
    DOSEKI_DEVICE_FN T operator()(T one, const T& other) const {
        one.add(other);
        return one;
    }
};

/// Ways to combine two values, as std::plus and std::logical_and are: to the larger one, and to one
/// that the other was added to.
inline constexpr Maximum maximum;
inline constexpr Join joined;

/// What a thread takes next of its block of tasks; on a cache line of its own.
struct alignas(64) NextTask {
    std::size_t number = 0;
};

/// Calls f(thread, k) for k = 0 ... count - 1, each much work of unequal size. Each thread begins
/// with a block that is the same in every loop over as many, so that what it wrote in the loop
/// before is still in the cache of its core, and then helps the others, chunk by chunk. `thread` is
/// below thread_count(): f may keep something for each.
template <class F>
void for_each_task(std::size_t count, std::size_t chunk, F&& f) {
    const auto most = static_cast<std::size_t>(thread_count());
    Array<NextTask> next(count > pair_loop ? most : 1);
#pragma omp parallel if (next.size() > 1)
    {
        const auto own = static_cast<std::size_t>(omp_get_thread_num()),
                   threads = static_cast<std::size_t>(omp_get_num_threads());
        for (std::size_t k = 0; k < threads; ++k) {
            const std::size_t block = (own + k) % threads, first = count * block / threads,
                              last = count * (block + 1) / threads;
            auto take = [&] {
                std::size_t taken = 0;
#pragma omp atomic capture
                {
                    taken = next[block].number;
                    next[block].number += chunk;
                }
                return first + taken;
            };
            for (std::size_t at = take(); at < last; at = take())
                for (std::size_t task = at; task < std::min(at + chunk, last); ++task) f(own, task);
        }
    }
}

/// Adds to a number that other threads add to at the same time.
template <class T>
void add_from_any_thread(T& total, T part) {
#pragma omp atomic
    total += part;
}

}  // namespace doseki
