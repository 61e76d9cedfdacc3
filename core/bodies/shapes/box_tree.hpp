#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>

#include "base/array.hpp"
#include "base/box.hpp"
#include "bodies/rotation.hpp"

namespace doseki {

/// Boxes in boxes, so that what is near a point is found without looking at all there is. The same
/// items make the same tree.
template <int D>
class BoxTree {
public:
    BoxTree() = default;
    explicit BoxTree(const Array<Box<D>>& items) : item_(items.size()) {
        std::iota(item_.begin(), item_.end(), 0u);
        if (!items.empty()) divide(items, 0, items.size());
    }

    /// Calls visit(item) for all items whose box is nearer to x than the root of `square`, nearer
    /// boxes first; `visit` may make `square` smaller.
    template <class Visit>
    DOSEKI_DEVICE_FN void visit_near(const Vec<double, D>& x, double& square, Visit&& visit) const {
        if (nodes_.empty()) return;
        std::array<std::uint32_t, deepest> waiting;
        std::size_t count = 0;
        waiting[count++] = 0;
        while (count > 0) {
            const std::uint32_t here = waiting[--count];
            const Node& node = nodes_[here];
            if (!(square_to(node.box, x) < square)) continue;
            if (node.items > 0) {
                for (std::uint32_t k = 0; k < node.items; ++k) visit(item_[node.first + k]);
                continue;
            }
            const std::uint32_t left = here + 1, right = node.first;
            const bool left_first =
                square_to(nodes_[left].box, x) <= square_to(nodes_[right].box, x);
            waiting[count++] = left_first ? right : left;
            waiting[count++] = left_first ? left : right;
        }
    }

    /// Calls visit(item) for all items in boxes for which meets(box) is true.
    template <class Meets, class Visit>
    void visit_all(Meets&& meets, Visit&& visit) const {
        if (nodes_.empty()) return;
        std::array<std::uint32_t, deepest> waiting;
        std::size_t count = 0;
        waiting[count++] = 0;
        while (count > 0) {
            const std::uint32_t here = waiting[--count];
            const Node& node = nodes_[here];
            if (!meets(node.box)) continue;
            for (std::uint32_t k = 0; k < node.items; ++k) visit(item_[node.first + k]);
            if (node.items > 0) continue;
            waiting[count++] = node.first, waiting[count++] = here + 1;
        }
    }

    /// Whether x is nearer than `distance` to the box around everything.
    DOSEKI_DEVICE_FN bool is_near(const Vec<double, D>& x, double distance) const {
        return !nodes_.empty() && square_to(nodes_[0].box, x) <= distance * distance;
    }

private:
    static constexpr std::size_t leaf = 4, deepest = 64;

    struct Node {
        Box<D> box;
        std::uint32_t first;  // item of a leaf, else the right child; the left one comes next
        std::uint32_t items;  // of a leaf
    };

    DOSEKI_DEVICE_FN static double square_to(const Box<D>& box, const Vec<double, D>& x) {
        double square = 0.0;
        for (int a = 0; a < D; ++a) {
            const double beyond = std::max({box.low[a] - x[a], x[a] - box.high[a], 0.0});
            square += beyond * beyond;
        }
        return square;
    }

    /// Halves the items from `first` to `end` across the longest axis of their middles.
    void divide(const Array<Box<D>>& items, std::size_t first, std::size_t end) {
        const std::size_t here = nodes_.size();
        Node node{Box<D>::nowhere(), static_cast<std::uint32_t>(first),
                  static_cast<std::uint32_t>(end - first)};
        Box<D> middles = Box<D>::nowhere();
        for (std::size_t k = first; k < end; ++k)
            node.box.add(items[item_[k]]), middles.add(items[item_[k]].middle());
        nodes_.push_back(node);
        if (end - first <= leaf) return;
        const Vec<double, D> size = middles.size();
        int axis = 0;
        for (int a = 1; a < D; ++a)
            if (size[a] > size[axis]) axis = a;
        const std::size_t half = first + (end - first) / 2;
        auto at = [&](std::size_t k) { return item_.begin() + static_cast<std::ptrdiff_t>(k); };
        std::nth_element(at(first), at(half), at(end), [&](std::uint32_t a, std::uint32_t b) {
            const double x = items[a].middle()[axis], y = items[b].middle()[axis];
            return x < y || (x == y && a < b);
        });
        divide(items, first, half);
        nodes_[here].first = static_cast<std::uint32_t>(nodes_.size());
        nodes_[here].items = 0;
        divide(items, half, end);
    }

    Array<std::uint32_t> item_;
    Array<Node> nodes_;
};

}  // namespace doseki
