// Memory that the processor and the graphics card both address.

#include "base/memory.hpp"

#include <cuda_runtime.h>
#include <thrust/mr/sync_pool.h>
#include <thrust/system/cuda/memory_resource.h>

#include <cstdlib>
#include <new>

#include "device/card.hpp"

namespace doseki {

std::string card_problem() {
    int count = 0;
    const cudaError_t error = cudaGetDeviceCount(&count);
    if (error != cudaSuccess) return cudaGetErrorString(error);
    return count > 0 ? "" : "there is none";
}

std::string card_name() {
    cudaDeviceProp card{};
    if (cudaGetDeviceProperties(&card, 0) != cudaSuccess) return "";
    return card.name;
}

namespace {

/// Without a card the module can still be loaded, and asked what is wrong.
bool has_card() {
    static const bool there_is_one = card_problem().empty();
    return there_is_one;
}

/// Keeps what was freed for the next time: the driver takes long to find memory. It is never
/// destroyed, since what it serves may live until the program has ended.
auto& pool() {
    using Pool = thrust::mr::synchronized_pool_resource<thrust::universal_memory_resource>;
    static auto* const pool = new Pool();
    return *pool;
}

}  // namespace

void* allocate_for_device(std::size_t bytes) {
    if (has_card()) return thrust::raw_pointer_cast(pool().do_allocate(bytes));
    void* const memory = std::malloc(bytes > 0 ? bytes : 1);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

void free_for_device(void* memory, std::size_t bytes) noexcept {
    if (has_card())
        pool().do_deallocate(thrust::universal_ptr<void>(memory), bytes);
    else
        std::free(memory);
}

}  // namespace doseki
