#pragma once
// Bodies that leave.

#include <algorithm>

#include "bodies/bodies.hpp"

namespace doseki {

/// A region for the centres of bodies, which go on past the ends of periods.
template <class Region, int D>
struct InAnyPeriod {
    const Region& region;
    const Domain<D>& domain;

    bool contains(const Vec<double, D>& x) const { return region.contains(wrapped(domain, x)); }
};

template <int D>
template <class Region>
double Bodies<D>::drain(const Particles<D>& particles, const Region& at,
                        Array<std::uint8_t>& removed) {
    if (!any_moves()) return 0.0;
    const InAnyPeriod<Region, D> region{at, contacts_.domain()};
    const Array<std::uint8_t> leaves = rigid.remove_inside(region);
    if (std::find(leaves.begin(), leaves.end(), 1) != leaves.end()) moved_ = margin_;
    for (std::size_t p = 0; p < particles.size(); ++p) {
        const std::int32_t k = rigid_body_of(particles, p);
        if (k >= 0 && leaves[static_cast<std::size_t>(k)]) removed[p] = 1;
    }
    return drain_deformable(particles, region, removed);
}

template <int D>
template <class Region>
double Bodies<D>::drain_deformable(const Particles<D>& particles, const Region& region,
                                   Array<std::uint8_t>& removed) {
    if (!deformable.any_deforms()) return 0.0;
    const Fragments<D> before = deformable.as_they_are();
    const auto leaving = deformable.remove_inside(region);
    if (!leaving.any()) return 0.0;
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (deformable.has(particles, p) &&
            leaving.is_body[static_cast<std::size_t>(deformable.body_of_point(particles.point(p)))])
            removed[p] = 1;
    const std::size_t solids = contact_.solids.size();
    prepare_contacts();
    renumber_contacts(before, solids);
    return leaving.energy;
}

}  // namespace doseki
