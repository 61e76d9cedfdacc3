#pragma once
// Outlines of the parts of 2-D bodies.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/array.hpp"
#include "bodies/fragments/cells.hpp"
#include "bodies/fragments/surface_vertex.hpp"
#include "bodies/surface/surface.hpp"

namespace doseki {

/// A vertex of an outline where it is now.
struct PlacedVertex {
    SurfaceVertex<2> vertex;
    Vec<double, 2> place;
    std::int32_t number = -1;  // among the vertices before; -1: new
};

/// What the outlines of parts follow from.
struct OutlineSources {
    const Cells& cells;
    const Array<std::uint32_t>& carrier;   // point of each vertex of outlines at rest
    std::span<const std::int32_t> before;  // body of each point
    std::span<const std::int32_t> after;
    std::span<const Vec<double, 2>> x;  // of points, now
};

/// Draws the outlines of the parts of bodies, Eq. (121). Both sides of a crack are given the same
/// vertices, in the places where the crack is now: the curves of two parts are one and the same
/// there, so that they touch and do not overlap. Where a crack meets an outline or another crack,
/// both sides have a crease.
class OutlineTracer {
public:
    /// `known`: vertices of the bodies that divide, those of a curve one after another.
    OutlineTracer(const OutlineSources& sources, const Array<PlacedVertex>& known)
        : from_(sources) {
        for (std::size_t k = 0; k < known.size(); ++k) {
            const SurfaceVertex<2>& vertex = known[k].vertex;
            if (k == 0 || !same_curve(known[k - 1], known[k])) curves_.emplace_back().begin_curve();
            Surface<2>& curve = curves_.back();
            places_[vertex.key] = {curves_.size() - 1, curve.size()};
            curve.add(vertex.crease != 0);
            curve.position.back() = known[k].place;
            known_[vertex.key] = known[k];
        }
        for (std::size_t cell = 0; cell < from_.cells.size(); ++cell)
            if (is_there(cell)) cells_.push_back(cell);
        for (const auto& [node, other] : from_.cells.outline())
            if (from_.before[point(node)] >= 0 || from_.before[point(other)] >= 0)
                sides_.push_back({node, other});
    }

    /// The closed curves around a part, anticlockwise; clockwise around holes.
    Array<Array<PlacedVertex>> trace(std::int32_t part) {
        next_.clear();
        for (const std::size_t cell : cells_) follow_cell(cell, part);
        follow_outline(part);
        Array<Array<PlacedVertex>> curves;
        while (!next_.empty()) {
            curves.emplace_back();
            const std::uint64_t first = next_.begin()->first;
            for (std::uint64_t key = first;;) {
                const auto found = next_.find(key);
                if (found == next_.end()) throw std::invalid_argument("an outline has no end");
                curves.back().push_back(known_.at(key));
                key = found->second;
                next_.erase(found);
                if (key == first) break;
            }
        }
        return curves;
    }

private:
    bool same_curve(const PlacedVertex& a, const PlacedVertex& b) const {
        return from_.before[a.vertex.point] == from_.before[b.vertex.point] &&
               a.vertex.curve == b.vertex.curve;
    }
    std::uint32_t point(std::uint32_t node) const {
        return CellNode::is_vertex(node) ? from_.carrier[CellNode::index(node)] : node;
    }
    auto before() const {
        return [this](std::uint32_t node) { return from_.before[point(node)]; };
    }
    auto after() const {
        return [this](std::uint32_t node) { return from_.after[point(node)]; };
    }
    bool is_there(std::size_t cell) const {
        for (std::size_t k = 0; k < from_.cells.corners(cell); ++k)
            if (from_.before[point(from_.cells.node(cell, k))] >= 0) return true;
        return false;
    }
    Vec<double, 2> place(std::uint32_t node) const {
        return CellNode::is_vertex(node) ? known_.at(VertexKey::of_outline(node)).place
                                         : from_.x[node];
    }
    bool on_outline(std::uint32_t a, std::uint32_t b) const {
        const auto found = from_.cells.outline().find(a);
        return found != from_.cells.outline().end() && found->second == b;
    }
    std::uint64_t add(std::uint64_t key, std::uint32_t node, const Vec<double, 2>& place,
                      bool crease) {
        known_.try_emplace(key, PlacedVertex{{point(node), {}, crease, 0.0, key, 0}, place, -1});
        return key;
    }

    /// The middle of a side between two parts, on the side of the first.
    std::uint64_t side(std::uint32_t node, std::uint32_t other) {
        const std::uint64_t key = VertexKey::of_side(node, other);
        if (known_.contains(key)) return key;
        if (on_outline(node, other)) return add(key, node, middle_of_curve(node), true);
        if (on_outline(other, node)) return add(key, node, middle_of_curve(other), true);
        return add(key, node, 0.5 * (place(node) + place(other)), false);
    }
    /// Of the part of an outline at rest that begins with a vertex.
    Vec<double, 2> middle_of_curve(std::uint32_t node) const {
        const auto [curve, vertex] = places_.at(VertexKey::of_outline(node));
        const Surface<2>& all = curves_[curve];
        return all.mean(all.position, all.at(static_cast<std::uint32_t>(vertex), 0.5));
    }

    void follow_cell(std::size_t cell, std::int32_t part) {
        const Cells& cells = from_.cells;
        const Array<CellRun> runs = cells.runs(cell, after());
        if (runs.front().whole) return;
        for (const CellRun& run : runs) {
            if (after()(cells.node(cell, run.first)) != part) continue;
            const std::size_t end = run.first + run.count, n = cells.corners(cell);
            const std::uint64_t in = side(cells.node(cell, end - 1), cells.node(cell, end)),
                                out = side(cells.node(cell, run.first),
                                           cells.node(cell, run.first + n - 1));
            const auto middle = middle_of(cell, run, runs.size());
            next_[in] = middle ? *middle : out;
            if (middle) next_[*middle] = out;
        }
    }

    /// Where parts meet in a cell, if more than two bodies do or a crack was there before.
    std::optional<std::uint64_t> middle_of(std::size_t cell, const CellRun& run,
                                           std::size_t parts) {
        const Cells& cells = from_.cells;
        const std::size_t n = cells.corners(cell);
        CellRun whole{};
        for (const CellRun& old : cells.runs(cell, before()))
            if ((run.first + n - old.first) % n < old.count) whole = old;
        Vec<double, 2> at{};
        if (const PlacedVertex* old = middle_before(cell, whole))
            at = old->place;
        else if (whole.whole && parts == 2)
            return {};
        else if (whole.whole) {
            for (std::size_t k = 0; k < n; ++k) at = at + place(cells.node(cell, k));
            at = (1.0 / static_cast<double>(n)) * at;
        } else if (whole == run)
            return {};
        else {
            const std::size_t end = whole.first + whole.count;
            const auto in = side(cells.node(cell, end - 1), cells.node(cell, end)),
                       out = side(cells.node(cell, whole.first),
                                  cells.node(cell, whole.first + n - 1));
            at = 0.5 * (known_.at(in).place + known_.at(out).place);
        }
        std::size_t corner = n;
        for (std::size_t k = 0; k < run.count; ++k) corner = std::min(corner, (run.first + k) % n);
        const std::uint32_t by = nearest(cell, run, at);
        const std::uint64_t key = add(VertexKey::of_middle(cell, corner), by, at, true);
        std::uint32_t& carrier = known_.at(key).vertex.point;  // may be that of another part now
        if (from_.after[carrier] != from_.after[point(by)]) carrier = point(by);
        return key;
    }
    const PlacedVertex* middle_before(std::size_t cell, const CellRun& whole) const {
        for (std::size_t k = 0; k < whole.count; ++k) {
            const std::size_t corner = (whole.first + k) % from_.cells.corners(cell);
            const auto found = known_.find(VertexKey::of_middle(cell, corner));
            if (found != known_.end() && found->second.number >= 0) return &found->second;
        }
        return nullptr;
    }
    /// The corner of a run that is nearest to a place.
    std::uint32_t nearest(std::size_t cell, const CellRun& run, const Vec<double, 2>& at) const {
        std::uint32_t best = from_.cells.node(cell, run.first);
        auto square = [&](std::uint32_t node) {
            const Vec<double, 2> r = place(node) - at;
            return dot(r, r);
        };
        for (std::size_t k = 1; k < run.count; ++k) {
            const std::uint32_t node = from_.cells.node(cell, run.first + k);
            if (square(node) < square(best)) best = node;
        }
        return best;
    }

    void follow_outline(std::int32_t part) {
        for (const auto& [node, other] : sides_) {
            const bool mine = after()(node) == part, also = after()(other) == part;
            const std::uint64_t own = VertexKey::of_outline(node),
                                others = VertexKey::of_outline(other);
            if (mine) next_[own] = also ? others : side(node, other);
            if (!mine && also) next_[side(other, node)] = others;
        }
    }

    OutlineSources from_;
    Array<std::size_t> cells_;                              // of bodies with parts
    Array<std::pair<std::uint32_t, std::uint32_t>> sides_;  // of their outlines
    std::map<std::uint64_t, PlacedVertex> known_;
    std::map<std::uint64_t, std::pair<std::size_t, std::size_t>> places_;  // curve and vertex
    Array<Surface<2>> curves_;
    std::map<std::uint64_t, std::uint64_t> next_;
};

}  // namespace doseki
