// Memory that the processor and the graphics card both address.

#include "base/memory.hpp"

#include <cuda_runtime.h>

#include <cstdlib>
#include <memory_resource>
#include <new>

#include "device/card.hpp"

namespace doseki {

std::string card_problem() {
    int count = 0;
    const cudaError_t error = cudaGetDeviceCount(&count);
    if (error != cudaSuccess) return cudaGetErrorString(error);
    return count > 0 ? "" : "there is none";
}

namespace {

/// Of the card of this process.
cudaDeviceProp properties() {
    int card = 0;
    cudaDeviceProp found{};
    if (cudaGetDevice(&card) == cudaSuccess) cudaGetDeviceProperties(&found, card);
    return found;
}

}  // namespace

void use_card(int k) {
    int count = 0;
    if (cudaGetDeviceCount(&count) == cudaSuccess && count > 0) cudaSetDevice(k % count);
}

std::string card_name() { return properties().name; }

double card_memory() { return static_cast<double>(properties().totalGlobalMem); }

namespace {

/// Without a card the module can still be loaded, and asked what is wrong.
bool has_card() {
    static const bool there_is_one = card_problem().empty();
    return there_is_one;
}

/// Memory of the driver.
class ManagedMemory : public std::pmr::memory_resource {
    void* do_allocate(std::size_t bytes, std::size_t) override {
        void* memory = nullptr;
        if (cudaMallocManaged(&memory, bytes) != cudaSuccess) throw std::bad_alloc();
        return memory;
    }
    void do_deallocate(void* memory, std::size_t, std::size_t) override { cudaFree(memory); }
    bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
        return this == &other;
    }
};

/// Keeps what was freed for the next time: the driver takes long to find memory. It is never
/// destroyed, since what it serves may live until the program has ended.
std::pmr::memory_resource& pool() {
    static auto* const pool = new std::pmr::synchronized_pool_resource(
        std::pmr::pool_options{0, std::size_t{1} << 22}, new ManagedMemory());
    return *pool;
}

}  // namespace

void* allocate_for_device(std::size_t bytes) {
    if (has_card()) return pool().allocate(bytes);
    void* const memory = std::malloc(bytes > 0 ? bytes : 1);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

void free_for_device(void* memory, std::size_t bytes) noexcept {
    if (has_card())
        pool().deallocate(memory, bytes);
    else
        std::free(memory);
}

}  // namespace doseki
