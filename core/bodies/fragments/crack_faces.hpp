#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "bodies/fragments/point_faces.hpp"
#include "bodies/shapes/box_tree.hpp"

namespace doseki {

/// Points that have lost neighbours to another part.
template <int D>
Array<std::uint32_t> crack_points(const TotalLagrangian<D>& solids,
                                  std::span<const std::int32_t> before,
                                  std::span<const std::int32_t> after) {
    Array<std::uint32_t> crack;
    for (std::uint32_t p = 0; p < solids.size(); ++p) {
        if (before[p] < 0) continue;
        const Array<std::uint32_t> pairs = solids.pairs_of(p);
        if (std::ranges::any_of(pairs, [&](std::uint32_t j) {
                return before[j] == before[p] && after[j] != after[p];
            }))
            crack.push_back(p);
    }
    return crack;
}

/// What new cracks make of the faces of points, at rest.
template <int D>
class CrackFaces {
public:
    /// `before`, `after`: the body of each point; `number`: that of the faces of each body.
    CrackFaces(const TotalLagrangian<D>& solids, const Array<std::uint32_t>& crack,
               std::span<const std::int32_t> before, std::span<const std::int32_t> after,
               std::span<const std::int32_t> number)
        : solids_(solids),
          crack_(crack),
          before_(before),
          after_(after),
          number_(number),
          tree_(boxes(crack)) {}

    /// Turns normals, outwards, and lessens depths: the faces of new cracks are surfaces too,
    /// halfway to the nearest points beyond. What is near a crack has no edges, for nothing tells
    /// where it meets another face.
    void turn(PointFaces<D>& faces) const {
        constexpr double reach = 4.0;     // spacings: deeper ones meet no fluid
        constexpr double as_near = 0.25;  // spacings: two faces count as equally near
        for (std::uint32_t p = 0; p < solids_.size(); ++p) {
            if (after_[p] < 0) continue;
            const double spacing = solids_.body_of(p).spacing;
            double nearest = reach * spacing;
            Vec<double, D> towards{};
            visit_beyond(p, reach * spacing, [&](double distance, const Vec<double, D>& r) {
                nearest = std::min(nearest, distance);
                towards = towards + (std::pow(spacing / distance, 4) / distance) * r;
            });
            const double below = nearest - 0.5 * spacing;
            double& depth = faces.depth[p];
            if (below < second_row * spacing) faces.edge_normals[p] = {};
            if (!(dot(towards, towards) > 0.0) || below > depth + as_near * spacing) continue;
            towards = (1.0 / norm(towards)) * towards;
            Vec<double, D>& normal = faces.normal[p];
            if (below > depth - as_near * spacing) towards = towards + normal;
            if (dot(towards, towards) > 0.0) normal = (1.0 / norm(towards)) * towards;
            depth = std::min(depth, below);
            faces.face[p] = face(p, depth / spacing);
        }
    }

    /// Eq. (87): what other parts no longer take up of the kernels of points is area of theirs.
    void uncover(PointFaces<D>& faces, const PairArea& pair_area) const {
        const Array<std::uint32_t> near = near_crack(pair_area.support);
        const BoxTree<D> tree(boxes(near));
        for (const std::uint32_t p : near) {
            if (after_[p] < 0 || number_of(p) == Face::none) continue;
            double square = pair_area.support * pair_area.support;
            tree.visit_near(solids_.rest_position(p), square, [&](std::uint32_t k) {
                const std::uint32_t j = near[k];
                if (before_[j] != before_[p] || after_[j] == after_[p]) return;
                const Vec<double, D> r = solids_.rest_position(j) - solids_.rest_position(p);
                const double pair = volume(p) * volume(j) * pair_area.at(dot(r, r));
                faces.area[p] = faces.area[p] - pair * r;
            });
        }
    }

private:
    static constexpr double first_row = 0.75, second_row = 2.0;  // spacings

    Array<Box<D>> boxes(const Array<std::uint32_t>& points) const {
        Array<Box<D>> places;
        for (const std::uint32_t q : points)
            places.push_back({solids_.rest_position(q), solids_.rest_position(q)});
        return places;
    }
    std::int32_t number_of(std::uint32_t p) const {
        return number_[static_cast<std::size_t>(after_[p])];
    }
    double volume(std::uint32_t p) const { return solids_.mass(p) / solids_.body_of(p).rho0; }
    /// Of a crack that goes up and down, the points in its hollows are in the row below.
    std::int32_t face(std::uint32_t p, double rows) const {
        return rows < first_row ? number_of(p) : rows < second_row ? -number_of(p) : Face::none;
    }
    /// Calls f(distance, r) for the points along a crack that p is no longer one body with.
    template <class F>
    void visit_beyond(std::uint32_t p, double reach, const F& f) const {
        double square = reach * reach;
        tree_.visit_near(solids_.rest_position(p), square, [&](std::uint32_t k) {
            const std::uint32_t q = crack_[k];
            const Vec<double, D> r = solids_.rest_position(q) - solids_.rest_position(p);
            const double distance = norm(r);
            if (before_[q] == before_[p] && after_[q] != after_[p] && distance < reach)
                f(distance, r);
        });
    }
    /// Points whose kernels of this support may reach beyond a crack.
    Array<std::uint32_t> near_crack(double support) const {
        Array<std::uint32_t> near;
        if (!(support > 0.0)) return near;
        for (std::uint32_t p = 0; p < solids_.size(); ++p) {
            bool found = false;
            if (before_[p] >= 0)
                visit_beyond(p, support + solids_.body_of(p).spacing,
                             [&](double, const auto&) { found = true; });
            if (found) near.push_back(p);
        }
        return near;
    }

    const TotalLagrangian<D>& solids_;
    const Array<std::uint32_t>& crack_;
    std::span<const std::int32_t> before_, after_, number_;
    BoxTree<D> tree_;
};

}  // namespace doseki
