#pragma once
#include <algorithm>
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "boundaries/terrain.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// When a run looks where its terrain needs walls, and what ranks tell each other for that. It
/// follows how far anything has gone and not when lists are built, for that follows the skin and
/// the ranks; and what flies side by side wears no list out.
template <int D>
class TerrainLooks {
public:
    TerrainLooks(Terrain<D>& terrain, const Ranks& ranks) : terrain_(terrain), ranks_(ranks) {}

    /// Particles have gone `distance` [m] at most in one more step; true where it is time to look.
    bool wear(double distance, double min_support) {
        moved_ += distance;
        return moved_ >= margin * min_support;
    }

    /// Fluid must find a bed wherever it may be until the next look. True where walls are to come
    /// or go, on any rank; `supports()` are those of the particles [m].
    template <class Supports>
    bool look(const Particles<D>& particles, const Supports& supports,
              Array<std::uint8_t>& removed) {
        moved_ = 0.0;
        if (!terrain_.is_there()) return false;
        const double support = largest(supports());
        if (!ranks_.alone()) fetch_around(particles, support);
        return terrain_.look(particles, support, margin * support, ranks_.rank(), gathering(),
                             removed);
    }

    /// Gets the part of the map that is asked for until the next look, and then of where particles
    /// have come to.
    template <class Supports>
    void fetch(const Particles<D>& particles, const Supports& supports) const {
        if (!terrain_.is_there() || ranks_.alone()) return;
        fetch_around(particles, largest(supports()));
    }

    /// Adds the particles that look() has found.
    void fill(Particles<D>& particles, std::int64_t& next_id) const {
        terrain_.fill(particles, next_id, ranks_.rank(), gathering());
    }

    void serialise(Archive& archive) { archive("moved_since_look", moved_); }

private:
    static constexpr double margin = 0.2;  // that a particle may go between two looks, in supports

    void fetch_around(const Particles<D>& particles, double support) const {
        terrain_.fetch(particles, (1.0 + 4.0 * margin) * support,
                       [this](std::span<double> values) { ranks_.largest(values); });
    }
    double largest(const Array<double>& supports) const {
        return ranks_.largest(
            supports.empty() ? 0.0 : *std::max_element(supports.begin(), supports.end()));
    }
    /// Makes numbers of all ranks of those of one.
    auto gathering() const {
        return [this](const Array<double>& part) { return ranks_.gather(part); };
    }

    Terrain<D>& terrain_;
    const Ranks& ranks_;
    double moved_ = 0.0;  // since the last look: the fastest of each step, summed [m]
};

}  // namespace doseki
