#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "cells/sorted_cells.hpp"
#include "model/archive.hpp"
#include "pairs/list_storage.hpp"

namespace doseki {

/// Lists of clusters of consecutive particles. Invariants:
///  - every pair with |x_i - x_j| < max(R_i, R_j) + skin at the time of the build is listed for i,
///  in
///    the list of i's cluster; nothing is ever truncated;
///  - fixed-fixed pairs are listed only where both have a face and these differ: no sum is taken
///    over others;
///  - the content of a list does not depend on the number of threads.
template <int D>
class Neighbours : public SortedCells<D> {
public:
    using List = ClusterList;
    using SortedCells<D>::SortedCells;

    /// Lists of all clusters of `width` particles, for positions already stored in sorted order,
    /// those of ghosts at the end.
    /// `faces`: of each particle, 0 for none; empty where none has one.
    void build(int width, std::span<const Vec<double, D>> position, std::span<const double> support,
               double skin, std::span<const std::int32_t> faces = {});

    std::span<const ClusterList> clusters() const { return clusters_; }
    std::size_t entries() const;
    std::size_t bytes() const;

    /// Throws std::invalid_argument unless the lists are those of clusters of `width` particles, so
    /// many as there are flags, moving ones first.
    void expect_fit_of(int width, std::span<const std::uint8_t> is_fixed) const {
        SortedCells<D>::expect_fit_of(clusters(), width, is_fixed);
    }

    /// The lists as they are; the grids are used only while lists are built.
    void serialise(Archive& archive);

private:
    /// All lists in one array, with their lengths.
    struct FlatLists {
        Array<std::uint32_t> moving, fixed, entries;
    };

    FlatLists flatten() const;
    void unflatten(const FlatLists& flat);

    /// A cell that a search visits, along one direction.
    struct CellStep {
        std::uint32_t key_part;
        std::uint32_t image_part;
    };

    struct Bounds {
        Vec<double, D> low, high;
        double support;
    };

    /// Some particles of a cluster, by their places in it.
    struct Part {
        Bounds bounds;
        int first, last;
    };

    /// What a thread needs while it searches.
    struct Scratch {
        Array<std::uint32_t> list;
        std::span<const std::int32_t> faces;  // that must differ; empty: all pairs are listed
        Array<Part> parts;
        std::array<Array<CellStep>, D> steps;
    };

    using Grid = CellGrid<D>;

    static void find_parts(std::span<const Vec<double, D>> position,
                           std::span<const double> support, std::size_t first, std::size_t last,
                           Array<Part>& parts);

    void search_cells(int width, const Grid& grid, const Part& part, std::uint32_t first,
                      double skin, std::span<const Vec<double, D>> position,
                      std::span<const double> support, Scratch& scratch) const;
    template <int width>
    void search(const Grid& grid, const Part& part, std::uint32_t first, double skin,
                std::span<const Vec<double, D>> position, std::span<const double> support,
                Scratch& scratch) const;
    void fill_steps(const Grid& grid, const Bounds& bounds, double radius, Scratch& scratch) const;

    Array<ClusterList> clusters_;
    Array<ListStorage> storage_;  // one per thread
};

template <int D>
void Neighbours<D>::serialise(Archive& archive) {
    FlatLists flat;
    if (!archive.loads()) flat = flatten();
    archive("lists_moving", flat.moving), archive("lists_fixed", flat.fixed);
    archive("lists_entries", flat.entries), SortedCells<D>::serialise(archive);
    if (archive.loads()) unflatten(flat);
}

// Compiled once, in neighbours.cpp.
extern template class Neighbours<2>;
extern template class Neighbours<3>;

}  // namespace doseki
