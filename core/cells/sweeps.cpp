#include "cells/sweeps.hpp"

#include <cmath>
#include <limits>

#include "base/bulk.hpp"

namespace doseki {
namespace {

template <int D>
struct SupportOf {
    const Particles<D>& particles;
    std::span<const Material> materials;
    bool grows;
    double eta, kernel;
    std::span<double> support;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        double h = particles.smoothing_length[p];
        if (grows) {
            const double rho0 = materials[particles.tag[p].material].rho0;
            h = max(h, 1.25 * eta * std::pow(particles.mass[p] / rho0, 1.0 / D));
        }
        support[p] = kernel * h;
    }
};

struct RangeOfOne {
    std::span<const double> support;
    DOSEKI_DEVICE_FN SupportRange operator()(std::size_t p) const {
        return {support[p], support[p]};
    }
};

template <int D>
struct FlagWall {
    const Particles<D>& particles;
    std::span<std::uint8_t> flags;
    DOSEKI_DEVICE_FN void operator()(std::size_t p) const { flags[p] = particles.is_wall(p); }
};

struct Smaller {
    DOSEKI_DEVICE_FN std::size_t operator()(std::size_t a, std::size_t b) const {
        return min(a, b);
    }
};
constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();

template <int D>
struct LostPlace {
    const Particles<D>& particles;
    const Domain<D> domain;

    DOSEKI_DEVICE_FN std::size_t operator()(std::size_t p) const {
        for (int a = 0; a < D; ++a) {
            const double x = particles.position[p][a], length = domain.length(a);
            const bool bounded = !domain.periodic[a] && length > 0.0;
            const bool strayed =
                bounded && (x < domain.low[a] - length || x > domain.high[a] + length);
            if (!(std::abs(x) < 1e9) || strayed) return p;
        }
        return nowhere;
    }
};

template <int D>
struct Wrap {
    Particles<D>& particles;
    const Domain<D> domain;
    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        particles.position[p] = wrapped(domain, particles.position[p]);
    }
};

/// Places in the order that have a particle of a wall, or of the others: where they begin and end.
template <int D>
struct PlacesOfKind {
    struct Range {
        std::size_t first = nowhere, last = 0;
        DOSEKI_DEVICE_FN void add(const Range& other) {
            first = min(first, other.first), last = max(last, other.last);
        }
    };
    const Particles<D>& particles;
    std::span<const std::uint32_t> order;
    bool walls;

    DOSEKI_DEVICE_FN Range operator()(std::size_t k) const {
        return particles.is_wall(order[k]) == walls ? Range{k, k + 1} : Range{};
    }
};

/// From the first to the last place that has a particle of that kind.
template <int D>
Places places_of(const Particles<D>& particles, std::span<const std::uint32_t> order, bool walls) {
    using Kind = PlacesOfKind<D>;
    const auto range =
        bulk::reduce(order.size(), typename Kind::Range{}, joined, Kind{particles, order, walls});
    if (range.last == 0) return {order.size(), order.size()};
    return {range.first, range.last};
}

}  // namespace

template <int D>
Array<double> support_radii(const Particles<D>& particles, std::span<const Material> materials,
                            const Options<D>& options, double kernel) {
    Array<double> support(particles.size());
    const bool grows = options.h_mode == SmoothingLengthMode::eq10;
    bulk::for_each(support.size(),
                   SupportOf<D>{particles, materials, grows, options.eta, kernel, support});
    return support;
}

SupportRange range_of(std::span<const double> support) {
    return bulk::reduce(support.size(), SupportRange{}, joined, RangeOfOne{support});
}

template <int D>
Array<std::uint8_t> wall_flags(const Particles<D>& particles) {
    Array<std::uint8_t> flags(particles.size());
    bulk::for_each(flags.size(), FlagWall<D>{particles, flags});
    return flags;
}

template <int D>
std::int64_t lost_particle(const Particles<D>& particles, const Domain<D>& domain) {
    const std::size_t lost =
        bulk::reduce(particles.size(), nowhere, Smaller{}, LostPlace<D>{particles, domain});
    return lost == nowhere ? -1 : static_cast<std::int64_t>(lost);
}

template <int D>
void wrap_positions(Particles<D>& particles, const Domain<D>& domain) {
    if (domain.any_periodic()) bulk::for_each(particles.size(), Wrap<D>{particles, domain});
}

template <int D>
void reorder(Particles<D>& particles, std::span<const std::uint32_t> order) {
    const Places all{0, order.size()}, walls = places_of(particles, order, true),
                                       others = places_of(particles, order, false);
    for (const NamedField& field : particles.fields()) {
        const FieldOf of = field.memory->of();
        field.memory->reorder(
            order, of == FieldOf::walls ? walls : (of == FieldOf::others ? others : all));
    }
}

#define DOSEKI_INSTANTIATE(D)                                                            \
    template Array<double> support_radii(const Particles<D>&, std::span<const Material>, \
                                         const Options<D>&, double);                     \
    template Array<std::uint8_t> wall_flags(const Particles<D>&);                        \
    template std::int64_t lost_particle(const Particles<D>&, const Domain<D>&);          \
    template void wrap_positions(Particles<D>&, const Domain<D>&);                       \
    template void reorder(Particles<D>&, std::span<const std::uint32_t>);

DOSEKI_INSTANTIATE(2)
DOSEKI_INSTANTIATE(3)

}  // namespace doseki
