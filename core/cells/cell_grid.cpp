#include "cells/cell_grid.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "base/bulk.hpp"
#include "cells/hilbert.hpp"

namespace doseki {
namespace {

template <int D>
struct PlaceOf {
    std::span<const Vec<double, D>> position;
    std::span<const std::uint32_t> members;
    DOSEKI_DEVICE_FN Box<D> operator()(std::size_t k) const {
        return {position[members[k]], position[members[k]]};
    }
};

/// The counts of layers after the upper half has been put onto the lower one.
Array<double> folded(const Array<double>& layers) {
    const std::size_t half = layers.size() / 2;
    Array<double> sum(half);
    for (std::size_t k = 0; k < half; ++k) sum[k] = layers[k] + layers[k + half];
    return sum;
}

/// Proportional to the number of pairs within layers.
double crowding(const Array<double>& layers) {
    return std::inner_product(layers.begin(), layers.end(), layers.begin(), 0.0);
}

}  // namespace

/// Bits of a Morton key are those of all directions in turn, as long as a direction has some left;
/// so the key is the OR of one part for each direction. Blocks have bits of all.
template <int D>
void CellGrid<D>::fill_key_parts() {
    std::array<Array<int>, D> places;
    const std::int64_t fewest = *std::min_element(cells.begin(), cells.end());
    const auto of_block = hilbert_curve<D>(std::bit_width(static_cast<std::uint64_t>(fewest - 1)));
    curve.assign(of_block.begin(), of_block.end());
    for (int bit = 0, place = 0; bit < 32; ++bit)
        for (int a = 0; a < D; ++a)
            if ((std::uint64_t{1} << bit) < static_cast<std::uint64_t>(cells[a]))
                places[a].push_back(place++);
    for (int a = 0; a < D; ++a) {
        key_part[a].assign(static_cast<std::size_t>(cells[a]), 0);
        for (std::size_t cell = 0; cell < key_part[a].size(); ++cell)
            for (std::size_t bit = 0; bit < places[a].size(); ++bit)
                key_part[a][cell] |= static_cast<std::uint32_t>((cell >> bit) & 1)
                                     << places[a][bit];
    }
}

template <int D>
void CellGrid<D>::size(const Domain<D>& domain, std::span<const Vec<double, D>> position,
                       std::span<const std::uint32_t> members) {
    bounds = bulk::reduce(members.size(), Box<D>::nowhere(), joined, PlaceOf<D>{position, members});
    periodic = domain.periodic;
    std::array<std::int64_t, D> wanted;
    for (int a = 0; a < D; ++a) {
        const double side = 0.5 * support;
        if (periodic[a]) {
            wanted[a] = std::max<std::int64_t>(
                1, static_cast<std::int64_t>(std::min(domain.length(a) / side, 1048576.0)));
            origin[a] = domain.low[a];
            cell_size[a] = domain.length(a) / static_cast<double>(wanted[a]);
        } else {
            const double count = std::min(bounds.size()[a] / side + 1.0, 1048576.0);
            wanted[a] = std::bit_ceil(static_cast<std::uint64_t>(count));
            origin[a] = bounds.low[a];
            cell_size[a] = side;
        }
    }
    cells = fold(wanted, position, members);
    fill_key_parts();
}

template <int D>
std::int64_t CellGrid<D>::table_size(const std::array<std::int64_t, D>& cells) {
    std::int64_t product = 1;
    for (const std::int64_t count : cells)
        product *= static_cast<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(count)));
    return product;
}

/// No more groups than the particles warrant. Folding a direction only adds candidates, and
/// fewest where one half is nearly empty: a long flow that splashes is folded upwards, not onto
/// itself.
template <int D>
std::array<std::int64_t, D> CellGrid<D>::fold(std::array<std::int64_t, D> wanted,
                                              std::span<const Vec<double, D>> position,
                                              std::span<const std::uint32_t> members) const {
    constexpr std::int64_t fewest = 4096, largest = std::int64_t{1} << 31;  // cells
    const std::int64_t limit = std::clamp<std::int64_t>(
        4 * group_size * static_cast<std::int64_t>(members.size()), fewest, largest);
    if (table_size(wanted) <= limit) return wanted;
    std::array<Array<double>, D> layers;  // particles with the same cell along a direction
    for (int a = 0; a < D; ++a) {
        if (periodic[a]) continue;
        layers[a].assign(static_cast<std::size_t>(wanted[a]), 0.0);
        for (const std::uint32_t p : members)
            layers[a][static_cast<std::size_t>(cell_of(position[p][a], a) % wanted[a])] += 1.0;
    }
    while (table_size(wanted) > limit) {
        int best = -1;
        double min_growth = 0.0;
        for (int a = 0; a < D; ++a) {
            if (periodic[a] || wanted[a] < 2) continue;
            const double growth = crowding(folded(layers[a])) / crowding(layers[a]);
            if (best < 0 || growth < min_growth) best = a, min_growth = growth;
        }
        if (best < 0) break;
        layers[best] = folded(layers[best]);
        wanted[best] /= 2;
    }
    return wanted;
}

template struct CellGrid<2>;
template struct CellGrid<3>;

}  // namespace doseki
