#pragma once
// Neighbour lists of single particles.

#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "cells/sorted_cells.hpp"
#include "model/archive.hpp"

namespace doseki {

/// The neighbours of one particle: moving ones, then fixed ones.
class RowList {
public:
    RowList() = default;
    DOSEKI_DEVICE_FN RowList(const std::uint32_t* begin, std::uint32_t moving, std::uint32_t fixed)
        : begin_(begin), moving_(moving), fixed_(fixed) {}

    /// The same without fixed neighbours.
    RowList without_fixed() const { return {begin_, moving_, 0}; }

    DOSEKI_DEVICE_FN bool empty() const { return moving_ + fixed_ == 0; }
    DOSEKI_DEVICE_FN std::size_t words() const { return std::size_t{moving_} + fixed_; }
    std::uint32_t moving() const { return moving_; }
    std::uint32_t fixed() const { return fixed_; }
    /// The same with its entries there.
    DOSEKI_DEVICE_FN RowList at(const std::uint32_t* begin) const {
        return {begin, moving_, fixed_};
    }

    template <class F>
    DOSEKI_DEVICE_FN void for_each_moving(const F& f) const {
        for (const std::uint32_t* entry = begin_; entry != begin_ + moving_; ++entry) f(*entry);
    }
    template <class F>
    DOSEKI_DEVICE_FN void for_each_fixed(const F& f) const {
        const std::uint32_t* const end = begin_ + moving_ + fixed_;
        for (const std::uint32_t* entry = begin_ + moving_; entry != end; ++entry) f(*entry);
    }

private:
    const std::uint32_t* begin_ = nullptr;
    std::uint32_t moving_ = 0, fixed_ = 0;
};

/// Lists of single particles. What they hold is what those of clusters do
/// (pairs/neighbour_lists.hpp): pairs within max(R_i, R_j) + skin, fixed ones among each other only
/// between faces.
template <int D>
class RowLists : public SortedCells<D> {
public:
    using List = RowList;
    using SortedCells<D>::SortedCells;

    /// For positions stored in sorted order, those of ghosts at the end. `faces`: of each particle,
    /// 0 for none; empty where none has one.
    void build(std::span<const Vec<double, D>> position, std::span<const double> support,
               double skin, std::span<const std::int32_t> faces);

    std::span<const RowList> clusters() const { return rows_; }
    std::size_t entries() const { return entries_.size(); }
    std::size_t bytes() const {
        return this->bytes_of_cells() + rows_.capacity() * sizeof(RowList) +
               entries_.capacity() * sizeof(std::uint32_t);
    }

    /// Throws std::invalid_argument unless there is a list for each flag, moving ones first.
    void expect_fit_of(int width, std::span<const std::uint8_t> is_fixed) const {
        SortedCells<D>::expect_fit_of(clusters(), width, is_fixed);
    }

    /// The lists as they are, in the form of those of clusters of one particle.
    void serialise(Archive& archive);

private:
    /// Gives the rows, whose lengths are known, their places in the entries.
    void cut_rows(const Array<std::size_t>& starts);

    Array<std::uint32_t> entries_;
    Array<RowList> rows_;
};

// Compiled once, in row_lists.cpp.
extern template class RowLists<2>;
extern template class RowLists<3>;

}  // namespace doseki
