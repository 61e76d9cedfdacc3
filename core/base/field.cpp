#include "base/field.hpp"

#include <cstring>
#include <utility>

#include "base/parallel.hpp"

namespace doseki {
namespace {

/// Elements of a size that is known here are copied by a few instructions.
template <std::size_t size>
void gather(std::byte* to, const std::byte* from, std::span<const std::uint32_t> order) {
    for_each_particle(order.size(), [=](std::size_t k) {
        std::memcpy(to + k * size, from + order[k] * size, size);
    });
}

void gather(std::size_t size, std::byte* to, const std::byte* from,
            std::span<const std::uint32_t> order) {
    const bool is_done = [&]<std::size_t... doubles>(std::index_sequence<doubles...>) {
        return ((size == (doubles + 1) * sizeof(double) &&
                 (gather<(doubles + 1) * sizeof(double)>(to, from, order), true)) ||
                ...);
    }(std::make_index_sequence<9>());
    if (is_done) return;
    for_each_particle(order.size(), [=](std::size_t k) {
        std::memcpy(to + k * size, from + order[k] * size, size);
    });
}

}  // namespace

void FieldMemory::reorder(std::span<const std::uint32_t> order) {
    decltype(bytes_) sorted(order.size() * element_size_);
    gather(element_size_, sorted.data(), bytes_.data(), order);
    bytes_.swap(sorted);
}

}  // namespace doseki
