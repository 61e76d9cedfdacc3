#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "base/error.hpp"
#include "model/archive.hpp"

namespace doseki {

/// A corner of a cell: a point of a body, or a vertex of the outline that the body had at rest.
struct CellNode {
    static constexpr std::uint32_t outline = 1u << 31;  // bit of the latter

    static bool is_vertex(std::uint32_t node) { return (node & outline) != 0; }
    static std::size_t index(std::uint32_t node) { return node & ~outline; }
};

/// What a vertex of an outline in 2-D is: one of the outline at rest, the middle of the side from a
/// corner to another, on the side of the first, or the middle of a cell as one of its corners sees
/// it.
class VertexKey {
public:
    static std::uint64_t of_outline(std::uint32_t node) { return pair(node, node); }
    static std::uint64_t of_side(std::uint32_t node, std::uint32_t other) {
        return pair(node, other);
    }
    static std::uint64_t of_middle(std::size_t cell, std::size_t corner) {
        return pair(middle | static_cast<std::uint32_t>(cell), static_cast<std::uint32_t>(corner));
    }

private:
    static constexpr std::uint32_t middle = 3u << 30;
    static std::uint64_t pair(std::uint32_t a, std::uint32_t b) {
        return std::uint64_t{a} << 32 | b;
    }
};

/// The corners of a cell, cyclic and anticlockwise, that follow one another in one body.
struct CellRun {
    std::size_t first, count;
    bool whole;  // all corners are of one body

    bool operator==(const CellRun&) const = default;
};

/// The polygons into which points and vertices of the outline divide 2-D bodies at rest. Cracks run
/// through the middles of their sides.
class Cells {
public:
    std::size_t size() const { return first_.size() - 1; }
    std::size_t corners(std::size_t cell) const { return first_[cell + 1] - first_[cell]; }
    std::uint32_t node(std::size_t cell, std::size_t corner) const {
        return node_[first_[cell] + corner % corners(cell)];
    }
    /// The sides that no other cell has, from corner to corner: those of outlines at rest.
    const std::map<std::uint32_t, std::uint32_t>& outline() const { return outline_; }

    void add(std::span<const std::uint32_t> nodes) {
        node_.insert(node_.end(), nodes.begin(), nodes.end());
        first_.push_back(node_.size());
    }
    /// Renames points; call once all cells are in.
    template <class Slot>
    void start(const Slot& slot) {
        for (std::uint32_t& node : node_)
            if (!CellNode::is_vertex(node)) node = slot(node);
        find_outline();
    }

    template <class Label>
    Array<CellRun> runs(std::size_t cell, const Label& label) const {
        const std::size_t n = corners(cell);
        auto begins = [&](std::size_t k) {
            return label(node(cell, k)) != label(node(cell, k + n - 1));
        };
        Array<CellRun> runs;
        for (std::size_t k = 0; k < n; ++k)
            if (begins(k)) {
                std::size_t count = 1;
                while (!begins(k + count)) ++count;
                runs.push_back({k, count, false});
            }
        if (runs.empty()) runs.push_back({0, n, true});
        return runs;
    }

    void serialise(Archive& archive, std::size_t points, std::size_t vertices) {
        Array<std::uint32_t> count;
        for (std::size_t cell = 0; cell < size(); ++cell)
            count.push_back(static_cast<std::uint32_t>(corners(cell)));
        archive("cell_node", node_), archive("cell_count", count);
        if (!archive.loads()) return;
        first_.assign(1, 0);
        for (const std::uint32_t corners : count) {
            expect_fit(corners >= 3 && corners <= node_.size(), "cell_count");
            first_.push_back(first_.back() + corners);
        }
        expect_fit(first_.back() == node_.size(), "cell_count");
        for (const std::uint32_t node : node_)
            expect_index(CellNode::index(node), CellNode::is_vertex(node) ? vertices : points,
                         "cell_node");
        find_outline();
    }

private:
    void find_outline() {
        std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
        auto for_each_side = [this](auto&& f) {
            for (std::size_t cell = 0; cell < size(); ++cell)
                for (std::size_t k = 0; k < corners(cell); ++k) f(node(cell, k), node(cell, k + 1));
        };
        for_each_side([&](std::uint32_t a, std::uint32_t b) { sides.emplace(a, b); });
        outline_.clear();
        for_each_side([&](std::uint32_t a, std::uint32_t b) {
            if (!sides.contains({b, a})) outline_[a] = b;
        });
    }

    Array<std::uint32_t> node_;
    Array<std::size_t> first_ = {0};
    std::map<std::uint32_t, std::uint32_t> outline_;
};

}  // namespace doseki
