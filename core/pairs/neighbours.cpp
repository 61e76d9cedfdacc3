// Neighbours of particles, compiled once for all schemes.

#include "pairs/neighbour_lists.hpp"
#include "pairs/search.hpp"

namespace doseki {

template <int D>
auto Neighbours<D>::flatten() const -> FlatLists {
    FlatLists flat;
    for (const ClusterList& list : clusters_) {
        const std::size_t first = flat.entries.size();
        auto add = [&flat](std::uint32_t entry) { flat.entries.push_back(entry); };
        list.for_each_moving(add);
        flat.moving.push_back(static_cast<std::uint32_t>(flat.entries.size() - first));
        list.for_each_fixed(add);
        flat.fixed.push_back(static_cast<std::uint32_t>(flat.entries.size() - first) -
                             flat.moving.back());
    }
    return flat;
}

template <int D>
void Neighbours<D>::unflatten(const FlatLists& flat) {
    expect_fit(flat.moving.size() == flat.fixed.size(), "lists_fixed");
    storage_.assign(1, {});
    clusters_.assign(flat.moving.size(), {});
    std::span<const std::uint32_t> rest(flat.entries);
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
        const std::size_t length = std::size_t{flat.moving[c]} + flat.fixed[c];
        expect_fit(length <= rest.size(), "lists_entries");
        clusters_[c] = storage_[0].keep(rest.first(length), flat.moving[c]);
        rest = rest.subspan(length);
    }
    expect_fit(rest.empty(), "lists_entries");
}

template <int D>
std::size_t Neighbours<D>::entries() const {
    std::size_t count = 0;
    for (const ListStorage& list : storage_) count += list.entries();
    return count;
}

template <int D>
std::size_t Neighbours<D>::bytes() const {
    std::size_t bytes = this->bytes_of_cells() + clusters_.capacity() * sizeof(ClusterList);
    for (const ListStorage& list : storage_) bytes += list.bytes();
    return bytes;
}

template class Neighbours<2>;
template class Neighbours<3>;

}  // namespace doseki
