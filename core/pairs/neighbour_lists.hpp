#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <tuple>

#include "base/array.hpp"
#include "base/box.hpp"
#include "base/error.hpp"
#include "base/vec.hpp"
#include "model/archive.hpp"
#include "model/domain.hpp"
#include "pairs/list_storage.hpp"

namespace doseki {

/// Entry of a list: particle index and, in the upper bits, through which image of it.
struct ListEntry {
    static constexpr int index_bits = 27;
    static constexpr std::uint32_t index_mask = (1u << index_bits) - 1;
    static constexpr std::uint32_t max_index = index_mask;
};

/// Sorted cells, one wrapped grid for each class of particles (moving or fixed, and per factor two
/// of the smoothing length). The sort is by class, then cell in Morton order, so that W consecutive
/// particles sit together. Invariants:
///  - every pair with |x_i - x_j| < max(R_i, R_j) + skin at the time of the build is listed for i,
///  in
///    the list of i's cluster; nothing is ever truncated;
///  - fixed-fixed pairs are listed only where both have a face and these differ: no sum is taken
///    over others;
///  - the content of a list does not depend on the number of threads.
/// Cells wrap around a power-of-two table, so a particle far away costs nothing and loses nothing:
/// cells that share a table entry only add candidates, which the distance test removes.
template <int D>
class Neighbours {
public:
    static constexpr int dim = D;

    explicit Neighbours(const Domain<D>& domain) : domain_(domain) { fill_image_shifts(); }

    /// Order in which particles are to be stored: moving ones before fixed ones, and among each
    /// those that are near other ranks last; none are where `is_near` is empty.
    Array<std::uint32_t> sort(std::span<const Vec<double, D>> position,
                              std::span<const double> support,
                              std::span<const std::uint8_t> is_fixed,
                              std::span<const std::uint8_t> is_near = {});

    /// Order in which ghosts are to be stored after the particles: moving ones first. They are
    /// neighbours, and have none themselves.
    Array<std::uint32_t> sort_ghosts(std::span<const Vec<double, D>> position,
                                     std::span<const double> support,
                                     std::span<const std::uint8_t> is_fixed);

    /// Lists of all clusters of `width` particles, for positions already stored in sorted order,
    /// those of ghosts at the end.
    /// `faces`: of each particle, 0 for none; empty where none has one.
    void build(int width, std::span<const Vec<double, D>> position, std::span<const double> support,
               double skin, std::span<const std::int32_t> faces = {});

    std::span<const ClusterList> clusters() const { return clusters_; }
    const Vec<double, D>& image_shift(std::uint32_t entry) const {
        return image_shift_[entry >> ListEntry::index_bits];
    }
    const Array<Vec<double, D>>& image_shifts() const { return image_shift_; }
    std::size_t entries() const;
    std::size_t bytes() const;
    bool is_periodic() const { return domain_.any_periodic(); }
    std::size_t moving() const { return moving_; }
    /// Particles that have neighbours, ghosts left out.
    std::size_t size() const { return size_; }
    /// The first moving ones, which have no ghosts among their neighbours.
    std::size_t inner() const { return inner_; }
    void set_size(std::size_t size) { size_ = size; }

    /// Throws std::invalid_argument unless the lists are those of clusters of `width` particles, so
    /// many as there are flags, moving ones first.
    void expect_fit_of(int width, std::span<const std::uint8_t> is_fixed) const;

    /// The lists as they are; the grids are used only while lists are built.
    void serialise(Archive& archive);

private:
    /// All lists in one array, with their lengths.
    struct FlatLists {
        Array<std::uint32_t> moving, fixed, entries;
    };

    FlatLists flatten() const;
    void unflatten(const FlatLists& flat);

    /// Particles of one class: a contiguous range in sorted order with its table of cells.
    struct Grid {
        bool fixed = false;
        std::uint32_t first = 0, last = 0;
        double support = 0.0;  // largest R of the class
        Box<D> bounds{};       // of its particles
        Vec<double, D> cell_size{};
        Vec<double, D> origin{};
        std::array<std::int64_t, D> cells{};  // power of two, except in periodic directions
        std::array<Array<std::uint32_t>, D> key_part;  // Morton key = OR over directions
        std::span<const std::uint16_t> curve{};        // of the cells of a block
        Array<std::uint32_t> cell_start;

        /// Place of a cell in storage: blocks of cells in Morton order, the cells of each along a
        /// Hilbert curve.
        std::uint32_t place(std::uint32_t key) const {
            const auto in_block = static_cast<std::uint32_t>(curve.size() - 1);
            return (key & ~in_block) | curve[key & in_block];
        }
    };

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

    /// Particles by class: moving before fixed, far from other ranks before near, then by smoothing
    /// length.
    using Classes = std::map<std::tuple<bool, bool, int>, Array<std::uint32_t>>;
    Array<std::uint32_t> sort_classes(const Classes& classes,
                                      std::span<const Vec<double, D>> position,
                                      std::span<const double> support, std::size_t first);
    bool is_beyond(const Grid& grid, const Bounds& bounds, double radius) const;

    /// What a thread needs while it searches.
    struct Scratch {
        Array<std::uint32_t> list;
        std::span<const std::int32_t> faces;  // that must differ; empty: all pairs are listed
        Array<Part> parts;
        std::array<Array<CellStep>, D> steps;
    };

    void fill_image_shifts();
    void size_grid(Grid& grid, std::span<const Vec<double, D>> position,
                   std::span<const std::uint32_t> members) const;
    static std::int64_t table_size(const std::array<std::int64_t, D>& cells);
    std::array<std::int64_t, D> fold(const Grid& grid, std::array<std::int64_t, D> cells,
                                     std::span<const Vec<double, D>> position,
                                     std::span<const std::uint32_t> members) const;
    static void fill_key_parts(Grid& grid);
    static std::int64_t cell_of(const Grid& grid, double x, int a);
    std::int64_t wrap(const Grid& grid, std::int64_t cell, int a) const;
    std::uint32_t key_of(const Grid& grid, const Vec<double, D>& x) const;

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

    Domain<D> domain_;
    Array<Vec<double, D>> image_shift_;
    Array<Grid> grids_;
    Array<ClusterList> clusters_;
    Array<ListStorage> storage_;  // one per thread
    std::size_t moving_ = 0, inner_ = 0, size_ = 0;
};

template <int D>
void Neighbours<D>::serialise(Archive& archive) {
    FlatLists flat;
    if (!archive.loads()) flat = flatten();
    archive("lists_moving", flat.moving), archive("lists_fixed", flat.fixed);
    archive("lists_entries", flat.entries), archive("moving_particles", moving_);
    if (archive.loads()) unflatten(flat);
}

// Compiled once, in neighbours.cpp.
extern template class Neighbours<2>;
extern template class Neighbours<3>;

}  // namespace doseki
