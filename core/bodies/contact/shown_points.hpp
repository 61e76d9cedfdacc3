#pragma once
#include <numeric>
#include <utility>

#include "base/array.hpp"
#include "bodies/contact_points.hpp"

namespace doseki {

/// Contact points that are shown to contacts, in rising order: those of rigid bodies come first,
/// body by body.
struct ShownPoints {
    Array<std::int32_t> points;
    Array<std::uint32_t> first;  // among these, of each rigid body that has any, and their end

    ShownPoints() = default;
    template <int D>
    ShownPoints(Array<std::int32_t> shown, const ContactPoints<D>& all) : points(std::move(shown)) {
        std::int32_t body = -1;
        std::uint32_t n = 0;
        for (; n < points.size(); ++n) {
            const auto c = static_cast<std::size_t>(points[n]);
            if (all.deformable[c]) break;
            if (all.body[c] != body) body = all.body[c], first.push_back(n);
        }
        first.push_back(n);
    }
    template <int D>
    static ShownPoints all_of(const ContactPoints<D>& all) {
        Array<std::int32_t> points(all.size());
        std::iota(points.begin(), points.end(), 0);
        return {std::move(points), all};
    }

    std::size_t rigid_bodies() const { return first.size() - 1; }
    std::size_t rigid_points() const { return first.back(); }
};

}  // namespace doseki
