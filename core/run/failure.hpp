#pragma once
// Why a run stops: the particle to blame, found on one rank and told by all.

#include <cmath>
#include <string>

#include "base/array.hpp"
#include "base/error.hpp"
#include "model/domain.hpp"
#include "model/material.hpp"
#include "model/particles.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

template <int D>
FailureSite site_of(const Particles<D>& particles, std::size_t p) {
    FailureSite site;
    site.id = particles.tag[p].id, site.material = particles.tag[p].material;
    for (int a = 0; a < D; ++a)
        site.position[static_cast<std::size_t>(a)] = particles.position[p][a];
    site.speed = sqrt(dot(particles.velocity[p], particles.velocity[p]));
    site.density = particles.density[p];
    return site;
}

/// The site of the first rank that has one.
FailureSite first_site(const Ranks& ranks, const FailureSite& own);

/// The sentence of a failure.
std::string described(const FailureSite& site, int dimensions, double time, std::int64_t step,
                      const Array<Material>& materials);

template <int D>
std::int64_t fastest_particle(const Particles<D>& particles) {
    std::size_t fastest = 0;
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (dot(particles.velocity[p], particles.velocity[p]) >
            dot(particles.velocity[fastest], particles.velocity[fastest]))
            fastest = p;
    return particles.size() > 0 ? static_cast<std::int64_t>(fastest) : -1;
}

}  // namespace doseki
