#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/array.hpp"
#include "base/vec.hpp"

namespace doseki {

/// The bed as heights over a plane: the last axis is up, the others are horizontal.
template <int D>
using Horizontal = Vec<double, D - 1>;

template <int D>
DOSEKI_DEVICE_FN Horizontal<D> horizontal(const Vec<double, D>& x) {
    Horizontal<D> place;
    for (int a = 0; a < D - 1; ++a) place[a] = x[a];
    return place;
}

/// Heights at the nodes of a square grid. In between, the cubic of Catmull and Rom (1974) along
/// each axis: it passes through the nodes and its slope is continuous. Beyond the grid it goes on
/// straight.
template <int D>
class HeightField {
    static constexpr int axes = D - 1;

public:
    Horizontal<D> origin{};                  // node 0 [m]
    double cell = 1.0;                       // distance between nodes [m]
    std::array<std::int64_t, axes> nodes{};  // along each axis; 2 or more
    Array<double> heights;                   // [m] of part(), the first axis fastest
    Array<std::uint8_t> unknown;             // by node: the map has nothing there; may be empty

    /// Some of the nodes: the first along each axis, and how many.
    struct Part {
        std::array<std::int64_t, axes> first{}, count{};

        std::int64_t size() const {
            std::int64_t size = 1;
            for (const std::int64_t n : count) size *= n;
            return size;
        }
        bool contains(const Part& other) const {
            if (other.size() == 0) return true;
            for (int a = 0; a < axes; ++a)
                if (other.first[a] < first[a] ||
                    other.first[a] + other.count[a] > first[a] + count[a])
                    return false;
            return true;
        }
    };
    /// The nodes that are held; of places beyond them nothing may be asked.
    const Part& part() const { return part_; }
    /// All nodes are held.
    void hold_all() { part_ = {{}, nodes}; }
    void hold(const Part& part, Array<double> heights_of_it, Array<std::uint8_t> unknown_of_it) {
        part_ = part, heights.swap(heights_of_it), unknown.swap(unknown_of_it);
    }
    /// The nodes that heights and slopes over a box in plan need.
    Part around(const Horizontal<D>& from, const Horizontal<D>& to) const {
        Part part;
        for (int a = 0; a < axes; ++a) {
            const auto cell_of = [&](double place) {
                const double last = static_cast<double>(nodes[a] - 2);
                return static_cast<std::int64_t>(
                    std::clamp(std::floor((place - origin[a]) / cell), 0.0, last));
            };
            part.first[a] = std::max<std::int64_t>(cell_of(from[a]) - 1, 0);
            part.count[a] = std::min(cell_of(to[a]) + 3, nodes[a]) - part.first[a];
        }
        return part;
    }

    struct Surface {
        double height;          // [m]
        Horizontal<D> slope;    // gradient of the height
        double area;            // of the surface over that of its plan
        Vec<double, D> normal;  // upwards
    };

    DOSEKI_DEVICE_FN Surface at(const Horizontal<D>& place) const {
        std::array<Stencil, axes> stencil;
        for (int a = 0; a < axes; ++a) stencil[a] = stencil_at(a, place[a]);
        Surface surface{};
        if constexpr (D == 2) {
            surface.height = sum_along(stencil[0].value, stencil[0], 0);
            surface.slope[0] = sum_along(stencil[0].slope, stencil[0], 0) / cell;
            surface.height += stencil[0].beyond * surface.slope[0];
        } else {
            sum_over_rows(stencil, surface);
        }
        const double steepness = dot(surface.slope, surface.slope);
        surface.area = std::sqrt(1.0 + steepness);
        for (int a = 0; a < axes; ++a) surface.normal[a] = -surface.slope[a] / surface.area;
        surface.normal[axes] = 1.0 / surface.area;
        return surface;
    }

    double height(const Horizontal<D>& place) const { return at(place).height; }

    /// How the normal turns along the surface [1/m]: by `bend` r where one goes along a short r.
    /// From normals that are 2 `step` [m] apart in plan.
    Sym<double, D> bend(const Horizontal<D>& place, double step) const {
        const Vec<double, D> n = at(place).normal;
        Mat<double, D> turn{};  // of the normal, along each horizontal axis
        for (int b = 0; b < axes; ++b) {
            Horizontal<D> ahead = place, behind = place;
            ahead[b] += step, behind[b] -= step;
            const Vec<double, D> change = at(ahead).normal - at(behind).normal;
            for (int a = 0; a < D; ++a) turn(a, b) = change[a] / (2.0 * step);
        }
        // Only what of r lies along the surface counts.
        Mat<double, D> along{};
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b)
                for (int c = 0; c < axes; ++c)
                    along(a, b) += turn(a, c) * ((b == c ? 1.0 : 0.0) - n[c] * n[b]);
        Sym<double, D> bend{};
        for (int a = 0; a < D; ++a)
            for (int b = a; b < D; ++b) bend(a, b) = 0.5 * (along(a, b) + along(b, a));
        return bend;
    }

    /// The signed distance of x from the surface, above 0 in the air, and the normal there. The
    /// foot of the perpendicular is found by iteration.
    struct Nearest {
        double distance;
        Vec<double, D> normal;
    };
    DOSEKI_DEVICE_FN Nearest nearest(const Vec<double, D>& x) const {
        Surface surface = at(horizontal(x));
        double distance = (x[axes] - surface.height) * surface.normal[axes];
        for (int k = 0; k < 3; ++k) {
            const Vec<double, D> foot = x - distance * surface.normal;
            const Surface there = at(horizontal(foot));
            Vec<double, D> on_surface = foot;
            on_surface[axes] = there.height;
            distance = dot(x - on_surface, there.normal);
            surface = there;
        }
        return {distance, surface.normal};
    }

    /// Whether the map says nothing of this place, or ends before it.
    bool is_unknown(const Horizontal<D>& place) const {
        std::int64_t index = 0, stride = 1;
        for (int a = 0; a < axes; ++a) {
            const double u = std::round((place[a] - origin[a]) / cell);
            if (!(u >= 0.0 && u < static_cast<double>(nodes[a]))) return true;
            index += among_held(a, static_cast<std::int64_t>(u)) * stride, stride *= part_.count[a];
        }
        return !unknown.empty() && unknown[static_cast<std::size_t>(index)] != 0;
    }

    /// How far at most normals lean from the vertical: the sine of the steepest slope there can be.
    double lean() const { return lean_; }
    /// Finds lean(), once all heights are there.
    void measure_lean() {
        double steepest = 0.0;  // between nodes; the cubic may rise half as steeply again
        std::int64_t stride = 1;
        for (int a = 0; a < axes; ++a) {
            double rise = 0.0;
            for (std::size_t k = 0; k + static_cast<std::size_t>(stride) < heights.size(); ++k)
                if (static_cast<std::int64_t>(k) / stride % nodes[a] < nodes[a] - 1)
                    rise = std::max(
                        rise, std::abs(heights[k + static_cast<std::size_t>(stride)] - heights[k]));
            steepest += (1.5 * rise / cell) * (1.5 * rise / cell);
            stride *= nodes[a];
        }
        lean_ = std::sqrt(steepest / (1.0 + steepest));
    }

    /// Corner of the grid of nodes that is far from the origin [m].
    double end(int a) const { return origin[a] + static_cast<double>(nodes[a] - 1) * cell; }

private:
    double lean_ = 1.0;
    Part part_;

    /// Where a node is among those held along an axis; of one that is not, the nearest.
    DOSEKI_DEVICE_FN std::int64_t among_held(int a, std::int64_t k) const {
        return std::clamp(k - part_.first[a], std::int64_t{0}, part_.count[a] - 1);
    }

    /// Four nodes along one axis, and what each adds to the value and to its slope per cell.
    struct Stencil {
        std::int64_t first;  // the one before the cell, which may lie outside by one
        std::array<double, 4> value, slope;
        double beyond;  // the grid's end [m]
    };

    DOSEKI_DEVICE_FN Stencil stencil_at(int a, double place) const {
        const double u = (place - origin[a]) / cell, last = static_cast<double>(nodes[a] - 1);
        const double inside = std::clamp(u, 0.0, last);
        const double start = std::min(std::floor(inside), last - 1.0);
        const double t = inside - start, t2 = t * t, t3 = t2 * t;
        return {static_cast<std::int64_t>(start) - 1,
                {0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
                 0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)},
                {0.5 * (-3.0 * t2 + 4.0 * t - 1.0), 0.5 * (9.0 * t2 - 10.0 * t),
                 0.5 * (-9.0 * t2 + 8.0 * t + 1.0), 0.5 * (3.0 * t2 - 2.0 * t)},
                (u - inside) * cell};
    }

    /// Height of a node of the row whose first held one is at `base`; one outside the grid lies on
    /// the straight line through the two next to it.
    DOSEKI_DEVICE_FN double node(std::int64_t base, std::int64_t k) const {
        const auto of = [&](std::int64_t j) {
            return heights[static_cast<std::size_t>(base + among_held(0, j))];
        };
        if (k < 0) return 2.0 * of(0) - of(1);
        if (k >= nodes[0]) return 2.0 * of(nodes[0] - 1) - of(nodes[0] - 2);
        return of(k);
    }

    DOSEKI_DEVICE_FN double sum_along(const std::array<double, 4>& weight, const Stencil& x,
                                      std::int64_t base) const {
        double sum = 0.0;
        for (int k = 0; k < 4; ++k) sum += weight[k] * node(base, x.first + k);
        return sum;
    }

    /// Height and slope from the rows of four nodes around the place.
    DOSEKI_DEVICE_FN void sum_over_rows(const std::array<Stencil, axes>& stencil,
                                        Surface& surface) const
        requires(D == 3)
    {
        const Stencil &x = stencil[0], &y = stencil[1];
        std::array<double, 4> height{}, slope{};
        for (int k = 0; k < 4; ++k) {
            height[k] = row(x.value, x, y.first + k);
            slope[k] = row(x.slope, x, y.first + k) / cell;
        }
        double twist = 0.0;
        for (int k = 0; k < 4; ++k) {
            surface.height += y.value[k] * height[k];
            surface.slope[0] += y.value[k] * slope[k];
            surface.slope[1] += y.slope[k] * height[k] / cell;
            twist += y.slope[k] * slope[k] / cell;
        }
        surface.height +=
            x.beyond * surface.slope[0] + y.beyond * surface.slope[1] + x.beyond * y.beyond * twist;
        surface.slope[0] += y.beyond * twist;
        surface.slope[1] += x.beyond * twist;
    }

    /// A weighted sum along row j, which may lie outside by one.
    DOSEKI_DEVICE_FN double row(const std::array<double, 4>& weight, const Stencil& x,
                                std::int64_t j) const
        requires(D == 3)
    {
        const auto inside = [&](std::int64_t of) {
            return sum_along(weight, x, among_held(1, of) * part_.count[0]);
        };
        const std::int64_t rows = nodes[1];
        if (j < 0) return 2.0 * inside(0) - inside(1);
        if (j >= rows) return 2.0 * inside(rows - 1) - inside(rows - 2);
        return inside(j);
    }
};

}  // namespace doseki
