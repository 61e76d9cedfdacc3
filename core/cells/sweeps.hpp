#pragma once
// What is done for every particle where lists are made anew, compiled once.

#include <cstdint>
#include <limits>
#include <span>

#include "base/array.hpp"
#include "model/domain.hpp"
#include "model/material.hpp"
#include "model/options.hpp"
#include "model/particles.hpp"

namespace doseki {

/// Support radii of particles [m], as large as they may become before the next sort. `kernel`: that
/// of the kernel over the smoothing length.
template <int D>
Array<double> support_radii(const Particles<D>& particles, std::span<const Material> materials,
                            const Options<D>& options, double kernel);

/// The smallest and the largest of them; of no particles, such that any is smaller and larger.
struct SupportRange {
    double smallest = std::numeric_limits<double>::max(),
           largest = std::numeric_limits<double>::lowest();

    DOSEKI_DEVICE_FN void add(const SupportRange& other) {
        smallest = min(smallest, other.smallest), largest = max(largest, other.largest);
    }
};
SupportRange range_of(std::span<const double> support);

/// Of each particle, whether it is one of a wall.
template <int D>
Array<std::uint8_t> wall_flags(const Particles<D>& particles);

/// Index of the first particle that is lost, -1 for none: outside the world, or a whole box away
/// from a domain that is given.
template <int D>
std::int64_t lost_particle(const Particles<D>& particles, const Domain<D>& domain);

/// Takes particles to their images inside the domain.
template <int D>
void wrap_positions(Particles<D>& particles, const Domain<D>& domain);

/// New particle k is old particle order[k]; particles not named are gone.
template <int D>
void reorder(Particles<D>& particles, std::span<const std::uint32_t> order);

}  // namespace doseki
