#include "base/field.hpp"

#include <cstring>
#include <stdexcept>
#include <utility>

#include "base/bulk.hpp"

namespace doseki {
namespace {

/// Copies an element from where it was; `from` is element `first`.
template <class Size>
struct MoveElement {
    Size size;
    std::byte* to;
    const std::byte* from;
    std::size_t first;
    std::span<const std::uint32_t> order;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        std::memcpy(to + k * size, from + (order[k] - first) * size, size);
    }
};

/// Elements of a size that is known here are copied by a few instructions.
void gather(std::size_t size, std::byte* to, const std::byte* from, std::size_t first,
            std::span<const std::uint32_t> order) {
    auto copy = [&](auto size_of_one) {
        bulk::for_each(order.size(),
                       MoveElement<decltype(size_of_one)>{size_of_one, to, from, first, order});
        return true;
    };
    const bool is_done = [&]<std::size_t... doubles>(std::index_sequence<doubles...>) {
        return ((size == (doubles + 1) * sizeof(double) &&
                 copy(std::integral_constant<std::size_t, (doubles + 1) * sizeof(double)>{})) ||
                ...);
    }(std::make_index_sequence<9>());
    if (!is_done) copy(size);
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
