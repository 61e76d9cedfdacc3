#include "base/field.hpp"

#include <cstring>
#include <stdexcept>
#include <utility>

#include "base/parallel.hpp"

namespace doseki {
namespace {

/// `from` is element `first`. Elements of a size that is known here are copied by a few
/// instructions.
template <std::size_t size>
void gather(std::byte* to, const std::byte* from, std::size_t first,
            std::span<const std::uint32_t> order) {
    for_each_particle(order.size(), [=](std::size_t k) {
        std::memcpy(to + k * size, from + (order[k] - first) * size, size);
    });
}

void gather(std::size_t size, std::byte* to, const std::byte* from, std::size_t first,
            std::span<const std::uint32_t> order) {
    const bool is_done = [&]<std::size_t... doubles>(std::index_sequence<doubles...>) {
        return ((size == (doubles + 1) * sizeof(double) &&
                 (gather<(doubles + 1) * sizeof(double)>(to, from, first, order), true)) ||
                ...);
    }(std::make_index_sequence<9>());
    if (is_done) return;
    for_each_particle(order.size(), [=](std::size_t k) {
        std::memcpy(to + k * size, from + (order[k] - first) * size, size);
    });
}

}  // namespace

void FieldMemory::resize(std::size_t n) {
    if (n > size_ && stored_ == 0) first_ = size_;
    first_ = std::min(first_, n);
    stored_ = n > size_ ? n - first_ : std::min(stored_, n - first_);
    size_ = n;
    bytes_.resize(stored_ * element_size_);
}

void FieldMemory::reorder(std::span<const std::uint32_t> order, Places kept) {
    const std::size_t count = kept.last - kept.first;
    decltype(bytes_) sorted(count * element_size_);
    gather(element_size_, sorted.data(), bytes_.data(), first_, order.subspan(kept.first, count));
    bytes_.swap(sorted);
    size_ = order.size(), first_ = kept.first, stored_ = count;
}

void fail_on_missing_element() {
    throw std::logic_error("a quantity of some particles is changed for one that has it not");
}

}  // namespace doseki
