#pragma once
// The part of a map that a rank needs.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "base/box.hpp"
#include "boundaries/height_field.hpp"
#include "model/particles.hpp"

namespace doseki {

/// Where a rank gets parts of the map from: it holds what is near its own particles and near all
/// bodies, because every rank steps all of these.
template <int D>
class GroundSource {
    static constexpr int axes = D - 1;
    using Part = typename HeightField<D>::Part;

public:
    /// Gives the heights of some nodes, then, for each, 1 where it is unknown. It is called with
    /// the first node along each axis and how many, 0 by ranks that need none; all call it.
    using Read = std::function<Array<double>(const Array<double>&)>;

    GroundSource() = default;
    explicit GroundSource(Read read) : read_(std::move(read)) {}
    explicit operator bool() const { return static_cast<bool>(read_); }

    /// Makes sure that the field holds what is no farther than `across` [m] in plan. All ranks call
    /// it; `largest` makes the largest of all ranks of each of some numbers.
    template <class Largest>
    void fetch(HeightField<D>& field, const Particles<D>& particles, double across,
               const Largest& largest) const {
        auto area = Area::nowhere();
        for (std::size_t p = 0; p < particles.size(); ++p)
            if (!particles.is_wall(p)) area.add(horizontal(particles.position[p]));
        area = grown(area, across);
        area.add(around_bodies(field, particles, across, largest));
        const Part needed = part(field, area);
        const Part roomy = part(field, grown(area, room * across));
        const bool lacks =
            !field.part().contains(needed) || field.part().size() > too_much * roomy.size();
        double any_lacks = lacks ? 1.0 : 0.0;
        largest({&any_lacks, 1});
        if (any_lacks == 0.0) return;
        Array<double> request;
        for (const std::int64_t first : roomy.first) request.push_back(static_cast<double>(first));
        for (const std::int64_t count : roomy.count)
            request.push_back(lacks ? static_cast<double>(count) : 0.0);
        const Array<double> found = read_(request);
        if (!lacks) return;
        const auto middle = found.begin() + roomy.size();
        Array<std::uint8_t> unknown;
        for (auto value = middle; value != found.end(); ++value) unknown.push_back(*value != 0.0);
        field.hold(roomy, Array<double>(found.begin(), middle), std::move(unknown));
    }

private:
    static constexpr double room = 1.0;          // more than is needed, of `across`
    static constexpr std::int64_t too_much = 3;  // times what is needed: given back

    /// In plan.
    using Area = Box<axes>;

    static Area grown(Area area, double around) {
        if (area.is_empty()) return area;
        for (int a = 0; a < axes; ++a) area.low[a] -= around, area.high[a] += around;
        return area;
    }
    static Part part(const HeightField<D>& field, const Area& area) {
        return area.is_empty() ? Part{} : field.around(area.low, area.high);
    }

    /// Of bodies of all ranks. The foot of a perpendicular lies the farther away the higher a body
    /// is.
    template <class Largest>
    static Area around_bodies(const HeightField<D>& field, const Particles<D>& particles,
                              double across, const Largest& largest) {
        std::array<double, 2 * axes> ends;  // upper ends, then lower ones with the other sign
        ends.fill(-std::numeric_limits<double>::infinity());
        for (std::size_t p = 0; p < particles.size(); ++p) {
            if (!particles.is_bound(p)) continue;
            const Horizontal<D> place = horizontal(particles.position[p]);
            const double high = std::abs(particles.position[p][axes] - field.height(place));
            for (std::size_t a = 0; a < axes; ++a) {
                const double x = place[static_cast<int>(a)];
                ends[a] = std::max(ends[a], x + across + high);
                ends[axes + a] = std::max(ends[axes + a], -x + across + high);
            }
        }
        largest(ends);
        Area area;
        for (std::size_t a = 0; a < axes; ++a)
            area.high[static_cast<int>(a)] = ends[a],
            area.low[static_cast<int>(a)] = -ends[axes + a];
        return area;
    }

    Read read_;
};

}  // namespace doseki
