#include "run/failure.hpp"

#include <cstdio>

namespace doseki {
namespace {

std::string short_number(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.9g", value);
    return buffer;
}

}  // namespace

/// Ids are below 2^53, so that they survive as real numbers.
FailureSite first_site(const Ranks& ranks, const FailureSite& own) {
    if (ranks.alone()) return own;
    Array<double> part;
    if (own.id >= 0)
        part = {static_cast<double>(own.id),
                static_cast<double>(own.material),
                own.position[0],
                own.position[1],
                own.position[2],
                own.speed,
                own.density};
    const Array<double> all = ranks.gather(part);
    if (all.empty()) return {};
    return {static_cast<std::int64_t>(all[0]),
            static_cast<int>(all[1]),
            {all[2], all[3], all[4]},
            all[5],
            all[6]};
}

std::string described(const FailureSite& site, int dimensions, double time, std::int64_t step,
                      const Array<Material>& materials) {
    std::string text = "at t = " + short_number(time) + " s, step " + std::to_string(step);
    if (site.id < 0) return text;
    const Material& material = materials[static_cast<std::size_t>(site.material)];
    std::string where;
    for (int a = 0; a < dimensions; ++a)
        where += (a ? ", " : "") + short_number(site.position[static_cast<std::size_t>(a)]);
    return text + ": particle " + std::to_string(site.id) + " (" + material.name + ") at (" +
           where + ") m has speed " + short_number(site.speed) + " m/s, density " +
           short_number(site.density) + " kg/m^3 (at rest " + short_number(material.rho0) + ")";
}

}  // namespace doseki
