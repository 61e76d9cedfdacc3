#include "cells/sorted_cells.hpp"

#include <algorithm>
#include <cmath>

#include "base/bulk.hpp"
#include "base/error.hpp"

namespace doseki {
namespace {

/// Particles of a class have a grid of their own: moving ones before fixed ones, far from other
/// ranks before near, then by factors of two of the support.
struct ParticleClass {
    static constexpr int exponents = 4096;  // of a double, zero and infinity too
    static constexpr std::uint32_t first_near = exponents, first_fixed = 2 * exponents,
                                   count = 4 * exponents;

    std::span<const double> support;
    std::span<const std::uint8_t> is_fixed, is_near;
    std::span<std::uint32_t> codes;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        const bool near = !is_near.empty() && is_near[p] != 0;
        int exponent;
        std::frexp(support[p], &exponent);
        codes[p] = (is_fixed[p] ? first_fixed : 0) + (near ? first_near : 0) +
                   static_cast<std::uint32_t>(exponent + exponents / 2);
    }

    static bulk::Buckets of_all(std::span<const double> support,
                                std::span<const std::uint8_t> is_fixed,
                                std::span<const std::uint8_t> is_near) {
        Array<std::uint32_t> codes(support.size());
        bulk::for_each(codes.size(), ParticleClass{support, is_fixed, is_near, codes});
        return bulk::sorted_by(std::move(codes), count);
    }
};

struct SupportOfMember {
    std::span<const double> support;
    std::span<const std::uint32_t> members;
    DOSEKI_DEVICE_FN double operator()(std::size_t k) const { return support[members[k]]; }
};

template <int D>
struct PlaceOfMember {
    const CellGrid<D>& grid;
    std::span<const Vec<double, D>> position;
    std::span<const std::uint32_t> members;
    std::span<std::uint32_t> places;
    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        places[k] = grid.place_of(position[members[k]]);
    }
};

struct GroupOfMember {
    std::span<const std::uint32_t> places;
    std::span<std::uint32_t> groups;
    int bits;
    DOSEKI_DEVICE_FN void operator()(std::size_t k) const { groups[k] = places[k] >> bits; }
};

struct HasMembers {
    std::span<const std::uint32_t> starts;
    DOSEKI_DEVICE_FN std::uint32_t operator()(std::size_t group) const {
        return starts[group + 1] > starts[group] ? 1 : 0;
    }
};

/// Sorts the members of a group by cell, in the order that they have.
template <int D>
struct SortGroup {
    static constexpr std::uint32_t size = CellGrid<D>::group_size;

    std::span<const std::uint32_t> members, places, by_group, starts, rank;
    std::uint32_t first;  // in storage
    std::span<std::uint32_t> cell_start;
    std::uint32_t* order;

    DOSEKI_DEVICE_FN void operator()(std::size_t group) const {
        const std::uint32_t start = starts[group], end = starts[group + 1];
        if (start == end) return;
        std::uint32_t next[size] = {};
        for (std::uint32_t k = start; k < end; ++k) ++next[cell(by_group[k])];
        std::uint32_t before = start;
        for (std::uint32_t c = 0; c < size; ++c) {
            const std::uint32_t count = next[c];
            cell_start[std::size_t{rank[group]} * size + c] = first + before;
            next[c] = before, before += count;
        }
        for (std::uint32_t k = start; k < end; ++k)
            order[next[cell(by_group[k])]++] = members[by_group[k]];
    }

private:
    DOSEKI_DEVICE_FN std::uint32_t cell(std::uint32_t k) const { return places[k] & (size - 1); }
};

/// Sorts members into the cells of their grid; the first is stored at `grid.first`.
template <int D>
void sort_members(CellGrid<D>& grid, std::span<const std::uint32_t> members,
                  std::span<const Vec<double, D>> position, std::uint32_t* order) {
    Array<std::uint32_t> places(members.size()), keys(members.size());
    bulk::for_each(members.size(), PlaceOfMember<D>{grid, position, members, places});
    bulk::for_each(members.size(), GroupOfMember{places, keys, CellGrid<D>::group_bits});
    const bulk::Buckets groups = bulk::sorted_by(std::move(keys), grid.groups());
    grid.rank = bulk::starts_of<std::uint32_t>(grid.groups(), HasMembers{groups.starts});
    grid.cell_start.resize(std::size_t{grid.rank.back()} * CellGrid<D>::group_size + 1);
    bulk::for_each(grid.groups(), SortGroup<D>{members, places, groups.order, groups.starts,
                                               grid.rank, grid.first, grid.cell_start, order});
    grid.cell_start.back() = grid.last;
}

}  // namespace

template <int D>
void SortedCells<D>::fill_image_shifts() {
    constexpr int images = D == 2 ? 9 : 27;
    image_shift_.resize(images);
    for (int code = 0; code < images; ++code) {
        int digits = code;
        for (int a = 0; a < D; ++a, digits /= 3)
            image_shift_[code][a] =
                (digits % 3 - 1) * (domain_.periodic[a] ? domain_.length(a) : 0.0);
    }
}

template <int D>
Array<std::uint32_t> SortedCells<D>::sort(std::span<const Vec<double, D>> position,
                                          std::span<const double> support,
                                          std::span<const std::uint8_t> is_fixed,
                                          std::span<const std::uint8_t> is_near) {
    if (position.size() > ListEntry::max_index)
        throw ResourceFailure("more than 2^27 particles on one rank");
    grids_.clear();
    size_ = position.size();
    const auto classes = ParticleClass::of_all(support, is_fixed, is_near);
    moving_ = classes.starts[ParticleClass::first_fixed];
    inner_ = classes.starts[ParticleClass::first_near];
    return sort_classes(classes, position, support, 0);
}

template <int D>
Array<std::uint32_t> SortedCells<D>::sort_ghosts(std::span<const Vec<double, D>> position,
                                                 std::span<const double> support,
                                                 std::span<const std::uint8_t> is_fixed) {
    if (size_ + position.size() > ListEntry::max_index)
        throw ResourceFailure("more than 2^27 particles and ghosts on one rank");
    return sort_classes(ParticleClass::of_all(support, is_fixed, {}), position, support, size_);
}

/// Adds a grid for each class; the first particle is to be stored at `first`.
template <int D>
Array<std::uint32_t> SortedCells<D>::sort_classes(const bulk::Buckets& classes,
                                                  std::span<const Vec<double, D>> position,
                                                  std::span<const double> support,
                                                  std::size_t first) {
    Array<std::uint32_t> order(position.size());
    for (std::uint32_t code = 0; code < ParticleClass::count; ++code) {
        const std::uint32_t start = classes.starts[code], end = classes.starts[code + 1];
        if (start == end) continue;
        const auto members = std::span(classes.order).subspan(start, end - start);
        CellGrid<D>& grid = grids_.emplace_back();
        grid.fixed = code >= ParticleClass::first_fixed;
        grid.first = static_cast<std::uint32_t>(first) + start;
        grid.last = static_cast<std::uint32_t>(first) + end;
        grid.support =
            bulk::reduce(members.size(), 0.0, maximum, SupportOfMember{support, members});
        grid.size(domain_, position, members);
        sort_members(grid, members, position, &order[start]);
    }
    return order;
}

template <int D>
std::size_t SortedCells<D>::bytes_of_cells() const {
    std::size_t bytes = 0;
    for (const auto& grid : grids_)
        bytes += (grid.rank.capacity() + grid.cell_start.capacity()) * sizeof(std::uint32_t);
    return bytes;
}

template class SortedCells<2>;
template class SortedCells<3>;

}  // namespace doseki
