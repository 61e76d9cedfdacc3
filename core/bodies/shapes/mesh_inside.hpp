#pragma once
// How often a mesh of triangles goes around a point, and where it cuts itself.

#include <array>
#include <cstdint>

#include "base/array.hpp"
#include "bodies/shapes/box_tree.hpp"
#include "bodies/shapes/facet.hpp"

namespace doseki {

/// Triangles as a set to be shot at.
class MeshInside {
public:
    explicit MeshInside(Array<Facet<3>> triangles) : triangles_(std::move(triangles)) {
        Array<Box<3>> boxes;
        for (const Facet<3>& triangle : triangles_) boxes.push_back(box_of(triangle));
        tree_ = BoxTree<3>(boxes);
    }

    /// Winding number of a closed mesh around x: 1 inside, 0 outside. A ray is counted up where it
    /// leaves through the outside of a triangle, and down where it enters. One that meets an edge
    /// is shot again in another direction.
    int winding(const Vec3& x) const {
        int count = 0;
        for (const std::array<double, 3>& towards : directions)
            if (count_along(x, {towards}, count)) break;
        return count;
    }

    /// A triangle through which an edge of another one goes that has no corner in common with it.
    struct Cut {
        std::uint32_t count = 0;  // of such triangles and edges
        Vec3 first{};             // where
    };
    Cut cuts() const {
        Cut found;
        for (std::uint32_t f = 0; f < triangles_.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 &a = triangles_[f][k], &b = triangles_[f][(k + 1) % 3];
                // Edges of a closed mesh are there in both directions.
                if (a.component < b.component) add_cuts(a, b, found);
            }
        return found;
    }

private:
    /// Along no axis, plane or diagonal that meshes have.
    static constexpr std::array<std::array<double, 3>, 4> directions{{{0.5377, 0.8339, 0.1242},
                                                                      {-0.2259, 0.4622, 0.8576},
                                                                      {0.8621, -0.3188, -0.3940},
                                                                      {-0.4336, -0.3426, 0.8335}}};
    static constexpr double on_edge = 1e-9;  // of a triangle

    static Box<3> box_of(const Facet<3>& triangle) {
        Box<3> box = Box<3>::nowhere();
        for (const Vec3& corner : triangle) box.add(corner);
        return box;
    }

    /// Where the line x + s d meets a triangle: s, which way it goes through (1: outwards, -1, 0:
    /// not at all), and whether that is beside an edge.
    struct Hit {
        double s = 0.0;
        int through = 0;
        bool beside_edge = false;
    };
    static Hit hit(const Facet<3>& triangle, const Vec3& x, const Vec3& d) {
        const Vec3 u = triangle[1] - triangle[0], v = triangle[2] - triangle[0], n = cross(u, v);
        const double across = dot(d, n);
        if (across == 0.0) return {};
        const Vec3 r = x - triangle[0], q = cross(r, d);
        const double a = -dot(v, q) / across, b = dot(u, q) / across, c = 1.0 - a - b;
        const double least = std::min({a, b, c});
        if (least < -on_edge) return {};
        return {-dot(r, n) / across, across > 0.0 ? 1 : -1, least < on_edge};
    }

    static bool meets(const Box<3>& box, const Vec3& x, const Vec3& d) {
        double from = 0.0, to = std::numeric_limits<double>::infinity();
        for (int a = 0; a < 3; ++a) {
            const double s = (box.low[a] - x[a]) / d[a], t = (box.high[a] - x[a]) / d[a];
            from = std::max(from, std::min(s, t)), to = std::min(to, std::max(s, t));
        }
        return from <= to * (1.0 + 1e-12);
    }

    bool count_along(const Vec3& x, const Vec3& d, int& count) const {
        bool clear = true;
        count = 0;
        tree_.visit_all([&](const Box<3>& box) { return meets(box, x, d); },
                        [&](std::uint32_t k) {
                            const Hit found = hit(triangles_[k], x, d);
                            if (found.through == 0 || found.s <= 0.0) return;
                            clear &= !found.beside_edge;
                            count += found.through;
                        });
        return clear;
    }

    void add_cuts(const Vec3& a, const Vec3& b, Cut& found) const {
        Box<3> box = Box<3>::nowhere();
        box.add(a), box.add(b);
        auto overlaps = [&](const Box<3>& other) {
            bool common = true;
            for (int c = 0; c < 3; ++c)
                common &= other.low[c] <= box.high[c] && other.high[c] >= box.low[c];
            return common;
        };
        tree_.visit_all(overlaps, [&](std::uint32_t k) {
            const Facet<3>& triangle = triangles_[k];
            for (const Vec3& corner : triangle)
                if (corner.component == a.component || corner.component == b.component) return;
            const Hit there = hit(triangle, a, b - a);
            if (there.through == 0 || there.beside_edge || there.s <= 0.0 || there.s >= 1.0) return;
            if (found.count++ == 0) found.first = a + there.s * (b - a);
        });
    }

    Array<Facet<3>> triangles_;
    BoxTree<3> tree_;
};

}  // namespace doseki
