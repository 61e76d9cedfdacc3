// Memory that the processor and the graphics card both address.

#include "base/memory.hpp"

#include <cuda_runtime.h>

#include <algorithm>
#include <cstdlib>
#include <memory_resource>
#include <new>

#include "device/card.hpp"

namespace doseki {

namespace {

/// Of the card of this process.
cudaDeviceProp properties() {
    int card = 0;
    cudaDeviceProp found{};
    if (cudaGetDevice(&card) == cudaSuccess) cudaGetDeviceProperties(&found, card);
    return found;
}

}  // namespace

std::string card_problem() {
    constexpr int oldest = 8;  // compute capability that kernels are compiled for
    int count = 0;
    const cudaError_t error = cudaGetDeviceCount(&count);
    if (error != cudaSuccess) return cudaGetErrorString(error);
    if (count == 0) return "there is none";
    const cudaDeviceProp card = properties();
    if (card.major >= oldest) return "";
    return std::string(card.name) + " has compute capability " + std::to_string(card.major) + "." +
           std::to_string(card.minor) + ", and " + std::to_string(oldest) + ".0 or more is needed";
}

void use_card(int k) {
    int count = 0;
    if (cudaGetDeviceCount(&count) == cudaSuccess && count > 0) cudaSetDevice(k % count);
}

std::string card_name() { return properties().name; }

double card_memory() { return static_cast<double>(properties().totalGlobalMem); }

namespace {

double attribute(cudaDeviceAttr which) {
    int card = 0, value = 0;
    if (cudaGetDevice(&card) == cudaSuccess) cudaDeviceGetAttribute(&value, which, card);
    return value;
}

}  // namespace

double card_bandwidth() {
    constexpr double kilohertz = 1e3, words_each_time = 2.0, bits = 8.0;
    return kilohertz * words_each_time * attribute(cudaDevAttrMemoryClockRate) *
           attribute(cudaDevAttrGlobalMemoryBusWidth) / bits;
}

/// A unit adds a product to a sum in each cycle, which is two operations.
double card_arithmetic(bool in_double) {
    constexpr double kilohertz = 1e3, units_in_float = 128.0;  // of a multiprocessor, from 8.6 on
    const bool has_half = attribute(cudaDevAttrComputeCapabilityMajor) == 8.0 &&
                          attribute(cudaDevAttrComputeCapabilityMinor) == 0.0;
    const double units = has_half ? 0.5 * units_in_float : units_in_float;
    const double slower = in_double ? attribute(cudaDevAttrSingleToDoublePrecisionPerfRatio) : 1.0;
    return 2.0 * kilohertz * attribute(cudaDevAttrClockRate) *
           attribute(cudaDevAttrMultiProcessorCount) * units / std::max(slower, 1.0);
}

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
