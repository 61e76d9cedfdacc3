#pragma once
#include <cstdint>
#include <functional>

#include "base/array.hpp"
#include "base/parallel.hpp"
#include "pairs/neighbour_lists.hpp"

namespace doseki {

/// The points that take part in steps, and the clusters of pairs in which there are any.
class SteppedPoints {
public:
    /// Those of `points` for which moves(p).
    template <class Moves>
    void choose(std::size_t points, const Moves& moves) {
        points_.clear(), clusters_.clear(), all_ = true;
        for (std::uint32_t p = 0; p < points; ++p) {
            if (!moves(p)) {
                all_ = false;
                continue;
            }
            points_.push_back(p);
            const std::uint32_t cluster = p / static_cast<std::uint32_t>(lanes<double>);
            if (clusters_.empty() || clusters_.back() != cluster) clusters_.push_back(cluster);
        }
    }
    bool any() const { return !points_.empty(); }
    const Array<std::uint32_t>& points() const { return points_; }
    /// None where these are all.
    const Array<std::uint32_t>* clusters() const { return all_ ? nullptr : &clusters_; }

    template <class F>
    void for_each(const F& f) const {
        for_each_particle(points_.size(), [&](std::size_t k) { f(points_[k]); });
    }
    /// See doseki::reduce.
    template <class Value, class Combine, class F>
    Value reduce(Value start, const Combine& combine, const F& f) const {
        return doseki::reduce(points_.size(), start, combine,
                              [&](std::size_t k) { return f(points_[k]); });
    }

private:
    Array<std::uint32_t> points_, clusters_;
    bool all_ = true;
};

}  // namespace doseki
