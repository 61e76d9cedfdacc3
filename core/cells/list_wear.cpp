#include "cells/list_wear.hpp"

#include "base/box.hpp"
#include "base/bulk.hpp"

namespace doseki {
namespace {

/// Keeps where a particle is, and in which cell.
template <int D>
struct KeepPlace {
    WearCells<D> cells;
    std::span<const Vec<double, D>> position;
    std::span<Vec<double, D>> start;
    std::span<std::uint32_t> place;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        start[p] = position[p];
        place[p] = static_cast<std::uint32_t>(cells.place(position[p]));
    }
};

/// Range of displacements of the particles of a cell.
template <int D>
struct RangeOfCell {
    std::span<const Vec<double, D>> position, start;
    std::span<const std::uint32_t> first, members;
    std::span<Box<D>> ranges;

    DOSEKI_DEVICE_FN void operator()(std::size_t c) const {
        auto range = Box<D>::nowhere();
        for (std::uint32_t k = first[c]; k < first[c + 1]; ++k)
            range.add(position[members[k]] - start[members[k]]);
        ranges[c] = range;
    }
};

/// Square of the width of the range in a cell and those next to it.
template <int D>
struct WidthAround {
    WearCells<D> cells;
    std::span<const Box<D>> ranges;

    DOSEKI_DEVICE_FN double operator()(std::size_t place) const {
        if (ranges[place].is_empty()) return 0.0;
        constexpr int neighbours = D == 2 ? 9 : 27;
        auto range = Box<D>::nowhere();
        for (int code = 0; code < neighbours; ++code) {
            typename WearCells<D>::Cell cell;
            std::size_t rest = place;
            for (int a = 0, digits = code; a < D; ++a, digits /= 3) {
                const auto n = static_cast<std::size_t>(cells.count[a]);
                cell[a] = static_cast<std::int64_t>(rest % n) + digits % 3 - 1;
                rest /= n;
            }
            range.add(ranges[cells.place(cell)]);
        }
        const Vec<double, D> width = range.size();
        return dot(width, width);
    }
};

}  // namespace

/// As many cells as there are particles at most: a periodic direction gets wider ones, any other
/// direction puts cells that lie far apart together.
template <int D>
void ListWear<D>::size_cells(std::span<const Vec<double, D>> position) {
    constexpr double max_cells = 1048576.0;
    const auto occupied =
        bulk::reduce(position.size(), Box<D>::nowhere(), joined, BoxAround<D>{position});
    for (int a = 0; a < D; ++a) {
        const double length = domain_.periodic[a] ? domain_.length(a) : occupied.size()[a];
        const double count =
            std::floor(length / (2.0 * reach_)) + (domain_.periodic[a] ? 0.0 : 1.0);
        cells_.count[a] = static_cast<std::int64_t>(std::clamp(count, 1.0, max_cells));
    }
    auto product = [this] {
        double product = 1.0;
        for (const std::int64_t count : cells_.count) product *= static_cast<double>(count);
        return product;
    };
    while (product() > static_cast<double>(std::max<std::size_t>(64, position.size()))) {
        std::int64_t& most = *std::max_element(cells_.count.begin(), cells_.count.end());
        most = (most + 1) / 2;
    }
    for (int a = 0; a < D; ++a) {
        const bool periodic = domain_.periodic[a];
        cells_.origin[a] = periodic ? domain_.low[a] : occupied.low[a];
        cells_.size[a] =
            periodic ? domain_.length(a) / static_cast<double>(cells_.count[a]) : 2.0 * reach_;
    }
}

template <int D>
void ListWear<D>::start(std::span<const Vec<double, D>> position, double reach) {
    reach_ = reach;
    size_cells(position);
    start_.resize(position.size());
    Array<std::uint32_t> place(position.size());
    bulk::for_each(position.size(), KeepPlace<D>{cells_, position, start_, place});
    std::size_t places = 1;
    for (const std::int64_t count : cells_.count) places *= static_cast<std::size_t>(count);
    auto sorted = bulk::sorted_by(std::move(place), places);
    first_.swap(sorted.starts), members_.swap(sorted.order);
}

template <int D>
double ListWear<D>::approach(std::span<const Vec<double, D>> position) const {
    Array<Box<D>> ranges(first_.size() - 1);
    bulk::for_each(ranges.size(), RangeOfCell<D>{position, start_, first_, members_, ranges});
    return std::sqrt(bulk::reduce(ranges.size(), 0.0, maximum, WidthAround<D>{cells_, ranges}));
}

template class ListWear<2>;
template class ListWear<3>;

}  // namespace doseki
