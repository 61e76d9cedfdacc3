// Lists of single particles, built by one thread for each.

#include "device/row_lists.hpp"

#include "base/bulk.hpp"
#include "physics/wall.hpp"

namespace doseki {
namespace {

/// Looks through the cells around a particle.
template <int D>
struct RowSearch {
    std::span<const CellGrid<D>> grids;
    std::span<const Vec<double, D>> shifts;  // of images
    std::span<const Vec<double, D>> position;
    std::span<const double> support;
    std::span<const std::int32_t> faces;  // empty: no particle has one
    std::uint32_t moving;
    double skin;

    /// Calls keep(entry) for each neighbour of p, which are moving ones or fixed ones.
    template <class Keep>
    DOSEKI_DEVICE_FN void visit(std::uint32_t p, bool fixed, const Keep& keep) const {
        const bool by_faces = fixed && p >= moving;
        if (by_faces && (faces.empty() || faces[p] == 0)) return;
        for (const CellGrid<D>& grid : grids)
            if (grid.fixed == fixed) visit_grid(grid, p, by_faces, keep);
    }

private:
    using Cell = std::array<std::int64_t, D>;

    template <class Keep>
    DOSEKI_DEVICE_FN void visit_grid(const CellGrid<D>& grid, std::uint32_t p, bool by_faces,
                                     const Keep& keep) const {
        const Vec<double, D>& x = position[p];
        const double radius = max(support[p], grid.support) + skin;
        if (grid.is_beyond(x, x, radius)) return;
        Cell low, high;
        for (int a = 0; a < D; ++a) {
            low[a] = grid.cell_of(x[a] - radius, a), high[a] = grid.cell_of(x[a] + radius, a);
            // Around a wrapped table once is everything; twice would list particles twice.
            if (!grid.periodic[a]) high[a] = min(high[a], low[a] + grid.cells[a] - 1);
        }
        for (Cell cell = low; cell[D - 1] <= high[D - 1];) {
            visit_cell(grid, cell, p, by_faces, keep);
            int a = 0;
            while (++cell[a] > high[a] && a < D - 1) cell[a] = low[a], ++a;
        }
    }

    template <class Keep>
    DOSEKI_DEVICE_FN void visit_cell(const CellGrid<D>& grid, const Cell& cell, std::uint32_t p,
                                     bool by_faces, const Keep& keep) const {
        std::uint32_t key = 0, image = 0, weight = 1;
        for (int a = 0; a < D; ++a, weight *= 3) {
            const std::int64_t wrapped = grid.wrap(cell[a], a);
            // Cell n of a periodic direction is cell 0 seen one box further.
            const std::int64_t turns = grid.periodic[a] ? (cell[a] - wrapped) / grid.cells[a] : 0;
            key |= grid.key_along(wrapped, a);
            image += weight * static_cast<std::uint32_t>(turns + 1);
        }
        const CellRange there = grid.particles(key);
        for (std::uint32_t j = there.first; j < there.last; ++j)
            if (is_near(p, j, shifts[image]) && (!by_faces || meet(p, j)))
                keep(j | image << ListEntry::index_bits);
    }

    DOSEKI_DEVICE_FN bool is_near(std::uint32_t p, std::uint32_t j,
                                  const Vec<double, D>& shift) const {
        const Vec<double, D> r = position[p] - (position[j] + shift);
        const double limit = max(support[p], support[j]) + skin;
        return dot(r, r) < limit * limit;
    }
    DOSEKI_DEVICE_FN bool meet(std::uint32_t p, std::uint32_t j) const {
        return Face::meet(faces[p], faces[j]);
    }
};

template <int D>
struct CountRow {
    RowSearch<D> search;
    std::span<RowList> rows;  // without entries yet

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        const auto p = static_cast<std::uint32_t>(k);
        std::uint32_t moving = 0, fixed = 0;
        search.visit(p, false, [&](std::uint32_t) { ++moving; });
        search.visit(p, true, [&](std::uint32_t) { ++fixed; });
        rows[k] = RowList(nullptr, moving, fixed);
    }
};

template <int D>
struct FillRow {
    RowSearch<D> search;
    std::span<const std::size_t> starts;
    std::span<std::uint32_t> entries;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        const auto p = static_cast<std::uint32_t>(k);
        std::size_t next = starts[k];
        const auto keep = [&](std::uint32_t entry) { entries[next++] = entry; };
        search.visit(p, false, keep);
        search.visit(p, true, keep);
    }
};

/// An array that grows would take up to twice the memory, and copy what is written anew.
void make_room(Array<std::uint32_t>& entries, std::size_t count) {
    constexpr std::size_t spare = 32;  // one part in so many, for lists a little longer
    if (entries.capacity() < count) {
        entries = Array<std::uint32_t>();
        entries.reserve(count + count / spare);
    }
    entries.resize(count);
}

struct CutRow {
    std::span<const std::size_t> starts;
    const std::uint32_t* entries;
    std::span<RowList> rows;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        rows[k] = rows[k].at(entries + starts[k]);
    }
};

struct LengthOf {
    std::span<const RowList> rows;
    DOSEKI_DEVICE_FN std::size_t operator()(std::size_t k) const { return rows[k].words(); }
};

}  // namespace

template <int D>
void RowLists<D>::build(std::span<const Vec<double, D>> position, std::span<const double> support,
                        double skin, std::span<const std::int32_t> faces) {
    const std::size_t n = this->size();
    const RowSearch<D> search{this->grids(), this->image_shifts(),
                              position,      support,
                              faces,         static_cast<std::uint32_t>(this->moving()),
                              skin};
    rows_.resize(n);
    bulk::for_each(n, CountRow<D>{search, rows_});
    const Array<std::size_t> starts = bulk::starts_of<std::size_t>(n, LengthOf{rows_});
    make_room(entries_, starts[n]);
    bulk::for_each(n, FillRow<D>{search, starts, entries_});
    cut_rows(starts);
}

template <int D>
void RowLists<D>::cut_rows(const Array<std::size_t>& starts) {
    bulk::for_each(rows_.size(), CutRow{starts, entries_.data(), rows_});
}

template <int D>
void RowLists<D>::serialise(Archive& archive) {
    Array<std::uint32_t> moving, fixed;
    for (const RowList& row : rows_) moving.push_back(row.moving()), fixed.push_back(row.fixed());
    archive("lists_moving", moving), archive("lists_fixed", fixed);
    archive("lists_entries", entries_), SortedCells<D>::serialise(archive);
    if (!archive.loads()) return;
    expect_fit(moving.size() == fixed.size(), "lists_fixed");
    rows_.clear();
    std::size_t total = 0;
    for (std::size_t k = 0; k < moving.size(); ++k) {
        rows_.emplace_back(nullptr, moving[k], fixed[k]);
        total += rows_.back().words();
        expect_fit(total <= entries_.size(), "lists_entries");
    }
    expect_fit(total == entries_.size(), "lists_entries");
    cut_rows(bulk::starts_of<std::size_t>(rows_.size(), LengthOf{rows_}));
}

template class RowLists<2>;
template class RowLists<3>;

}  // namespace doseki
