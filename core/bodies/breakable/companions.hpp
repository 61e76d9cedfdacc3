#pragma once
#include <algorithm>
#include <cstdint>
#include <span>

#include "base/array.hpp"

namespace doseki {

/// Rigid bodies beside deformable ones: companions, which may touch those and go with them in short
/// steps, and others, which are half a long step ahead of them meanwhile. Who comes to be a
/// companion within that half has to be taken back to where the short steps are.
class Companions {
public:
    bool none() const { return companions_.empty(); }
    std::span<const std::uint32_t> others() const { return others_; }
    /// Those that go in the short steps of this half.
    const Array<std::uint32_t>& together() const { return together_; }

    /// By a flag for each rigid body.
    void choose(std::span<const std::uint8_t> is_companion) {
        companions_.clear(), others_.clear();
        for (std::uint32_t k = 0; k < is_companion.size(); ++k)
            (is_companion[k] ? companions_ : others_).push_back(k);
    }

    /// A half begins, in which the others have gone ahead by all of it, by this way at most.
    void begin(double half, double way, std::size_t bodies) {
        ahead_ = half, way_ahead_ = way, together_ = companions_;
        is_ahead_.assign(bodies, 0);
        for (const std::uint32_t k : others_) is_ahead_[k] = 1;
    }
    /// The others are less ahead by a step in which those beside them have gone this way. Returns
    /// what of it is beyond the way of the others: that much farther has any gone.
    double catch_up(double step, double way) {
        ahead_ -= step;
        const double beyond = std::max(0.0, way - way_ahead_);
        way_ahead_ = std::max(0.0, way_ahead_ - way);
        return beyond;
    }
    /// From now on ways count from where bodies are, the others ahead.
    void count_anew() { way_ahead_ = 0.0; }
    /// Bodies from this number on, which were born where the short steps are.
    void take_born(std::size_t first, std::size_t end) {
        for (std::size_t k = first; k < end; ++k)
            together_.push_back(static_cast<std::uint32_t>(k));
    }
    void end() { ahead_ = 0.0, is_ahead_.clear(); }

    /// How far the others are ahead [s].
    double ahead() const { return ahead_; }
    /// Companions that are ahead, which the caller takes back.
    Array<std::uint32_t> take_late() {
        Array<std::uint32_t> late;
        for (const std::uint32_t k : companions_)
            if (k < is_ahead_.size() && is_ahead_[k]) {
                late.push_back(k), together_.push_back(k);
                is_ahead_[k] = 0;
            }
        return late;
    }

private:
    Array<std::uint32_t> companions_, others_, together_;
    Array<std::uint8_t> is_ahead_;
    double ahead_ = 0.0, way_ahead_ = 0.0;  // [s], [m]
};

}  // namespace doseki
