#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "base/array.hpp"
#include "bodies/rotation.hpp"
#include "boundaries/face_push.hpp"

namespace doseki {

/// A plane face cut into panels: a line in 2-D, a parallelogram with right angles in 3-D. Panels
/// are numbered along the first edge, row after row along the second.
template <int D>
struct PanelGrid {
    static constexpr int edges = D - 1;

    Vec<double, D> origin{}, normal{};         // a corner; the unit normal, into the flow
    std::array<Vec<double, D>, edges> edge{};  // unit vectors
    std::array<double, edges> size{};          // of a panel along each edge [m]
    std::array<std::int32_t, edges> count{};   // panels along each edge; zero: there are none
    double footprint = 0.0;                    // what a wall particle covers along each edge [m]
    double reach = 0.0;                        // how deep below the face its particles lie [m]

    std::size_t panels() const {
        std::size_t n = 1;
        for (const std::int32_t along : count) n *= static_cast<std::size_t>(along);
        return n;
    }

    FacePlane<D> plane() const { return {origin, normal}; }

    /// Whether a wall particle at x may bear a part of what presses on the panels: one of the face
    /// itself or, behind its plane, of another body.
    bool is_near(const Vec<double, D>& x, bool of_face) const {
        const double below = plane().depth(x), least = of_face ? -footprint : 0.0;
        bool near = panels() > 0 && below >= least && below <= reach;
        for (int e = 0; e < edges; ++e) {
            const double along = dot(x - origin, edge[e]);
            near &= along >= -reach && along <= size[e] * count[e] + reach;
        }
        return near;
    }

    /// Where a wall particle at x is pressed: there, unless the fluid that presses it is beside it,
    /// as at the foot of a wall that goes on below the bed. Then it is where the fluid is.
    Vec<double, D> pressed_place(const Vec<double, D>& x, const FacePush<D>& push) const {
        Vec<double, D> place = x;
        for (const Vec<double, D>& e : edge) {
            const double way = push.way(e, reach);
            place = place + (way * beside(std::abs(way) / footprint)) * e;
        }
        return place;
    }

    /// Calls f(panel, share) for the panels that what is at x, `wide` along each edge, lies on; not
    /// for what is off the face.
    template <class F>
    void for_each_share(const Vec<double, D>& x, double wide, F&& f) const {
        const Vec<double, D> r = x - origin;
        const double below = -dot(r, normal), deepest = wide > 0.0 ? reach : footprint;
        if (panels() == 0 || below < -footprint || below > deepest) return;
        std::array<Covered, 2> covered{Covered{0, 1, 0.0, 1.0, 1.0}, Covered{0, 1, 0.0, 1.0, 1.0}};
        for (int e = 0; e < edges; ++e)
            covered[static_cast<std::size_t>(e)] = covered_by(e, dot(r, edge[e]), wide);
        const std::int32_t row = count[0];
        for (std::int32_t k = covered[1].first; k < covered[1].end; ++k)
            for (std::int32_t j = covered[0].first; j < covered[0].end; ++j)
                f(static_cast<std::size_t>(k * row + j), covered[0].share(j) * covered[1].share(k));
    }

private:
    /// From 0, the fluid is in front, to 1, beside, by the way to it in spacings.
    static double beside(double way) {
        const double s = std::clamp((way - 0.5) / 0.4, 0.0, 1.0);
        return s * s * (3.0 - 2.0 * s);
    }
    /// Panels first to end - 1 along one edge lie under [low, high], in panels.
    struct Covered {
        std::int32_t first, end;
        double low, high, whole;
        double share(std::int32_t k) const {
            if (whole == 0.0) return 1.0;
            const double from = std::max(low, static_cast<double>(k)),
                         to = std::min(high, static_cast<double>(k) + 1.0);
            return std::max(0.0, to - from) / whole;
        }
    };

    Covered covered_by(int e, double at, double wide) const {
        const double low = (at - 0.5 * wide) / size[e], high = (at + 0.5 * wide) / size[e];
        const auto inside = [&](double place) {
            return static_cast<std::int32_t>(std::clamp(place, 0.0, static_cast<double>(count[e])));
        };
        if (wide == 0.0)  // a point: the panel that it is on
            return low >= 0.0 && low < count[e]
                       ? Covered{inside(low), inside(low) + 1, low, low, 0.0}
                       : Covered{0, 0, low, low, 0.0};
        return {inside(std::floor(low)), inside(std::ceil(high)), low, high, high - low};
    }
};

}  // namespace doseki
