#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "base/array.hpp"
#include "bodies/shapes/facet.hpp"

namespace doseki {

/// Where on a facet a point lies: within it, or on its edge or corner of that number; an edge goes
/// from the corner with its number to the next.
enum class Feature : std::uint8_t { edge, corner = 3, face = 6 };

DOSEKI_DEVICE_FN constexpr Feature edge_of(int k) { return static_cast<Feature>(k); }
DOSEKI_DEVICE_FN constexpr Feature corner_of(int k) { return static_cast<Feature>(3 + k); }

template <int D>
struct FacetPoint {
    Vec<double, D> position{};
    Feature feature = Feature::face;
};

/// The point of a facet with normal n that is nearest to x.
template <int D>
DOSEKI_DEVICE_FN FacetPoint<D> nearest_point(const Facet<D>& facet, const Vec<double, D>& n,
                                             const Vec<double, D>& x) {
    auto on_edge = [&](int k) -> FacetPoint<D> {
        const Vec<double, D>&a = facet[static_cast<std::size_t>(k)],
                          &b = facet[static_cast<std::size_t>((k + 1) % D)];
        const Vec<double, D> u = b - a;
        const double t = dot(x - a, u) / dot(u, u);
        if (!(t > 0.0)) return {a, corner_of(k)};
        if (!(t < 1.0)) return {b, corner_of((k + 1) % D)};
        return {a + t * u, D == 2 ? Feature::face : edge_of(k)};
    };
    if constexpr (D == 2)
        return on_edge(0);
    else {
        const Vec3 foot = x - dot(x - facet[0], n) * n;
        bool within = true;
        for (std::size_t k = 0; k < 3; ++k)
            within &= dot(cross(facet[(k + 1) % 3] - facet[k], foot - facet[k]), n) > 0.0;
        if (within) return {foot, Feature::face};
        FacetPoint<D> nearest = on_edge(0);
        for (int k = 1; k < 3; ++k) {
            const FacetPoint<D> other = on_edge(k);
            const Vec3 u = x - other.position, v = x - nearest.position;
            if (dot(u, u) < dot(v, v)) nearest = other;
        }
        return nearest;
    }
}

/// Facets with the normals of their faces, edges and corners. That of an edge is the mean of its
/// faces, that of a corner their mean weighted with the angles there: the sign of the distance of a
/// closed mesh (Baerentzen and Aanaes, IEEE Trans. Vis. Comput. Graph. 11, 2005).
template <int D>
class MeshCorners {
public:
    explicit MeshCorners(const Array<Facet<D>>& facets) : facets_(facets) {
        number_corners();
        corner_normals_.resize(corners_);
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
        for (std::size_t f = 0; f < facets_.size(); ++f) {
            const Vec<double, D> n = normal_of<D>(facets_[f]);
            normals_.push_back(n);
            for (std::size_t k = 0; k < D; ++k) {
                Vec<double, D>& corner = corner_normals_[corner_[f][k]];
                corner = corner + angle(f, k) * n;
            }
            if constexpr (D == 3) edge_.push_back(add_edges(f, edges));
        }
        for (Vec<double, D>& n : corner_normals_) make_unit(n);
        for (Vec<double, D>& n : edge_normals_) make_unit(n);
    }

    DOSEKI_DEVICE_FN FacetPoint<D> nearest(std::uint32_t f, const Vec<double, D>& x) const {
        return nearest_point<D>(facets_[f], normals_[f], x);
    }

    /// Unit vector outwards.
    DOSEKI_DEVICE_FN Vec<double, D> normal(std::uint32_t f, Feature at) const {
        const auto k = static_cast<std::size_t>(at);
        if (at == Feature::face) return normals_[f];
        if (at >= Feature::corner) return corner_normals_[corner_[f][k - 3]];
        return edge_normals_[edge_[f][k]];
    }

private:
    using Numbers = std::array<std::uint32_t, D>;

    /// Corners at the same place get the same number.
    void number_corners() {
        std::map<std::array<double, D>, std::uint32_t> known;
        for (const Facet<D>& facet : facets_) {
            corner_.emplace_back();
            for (std::size_t k = 0; k < D; ++k)
                corner_.back()[k] =
                    known.try_emplace(facet[k].component, static_cast<std::uint32_t>(known.size()))
                        .first->second;
        }
        corners_ = known.size();
    }

    template <class Edges>
    Numbers add_edges(std::size_t f, Edges& edges) {
        Numbers own{};
        for (std::size_t k = 0; k < D; ++k) {
            const std::uint32_t a = corner_[f][k], b = corner_[f][(k + 1) % D];
            const auto found = edges.try_emplace(std::minmax(a, b),
                                                 static_cast<std::uint32_t>(edge_normals_.size()));
            if (found.second) edge_normals_.push_back({});
            own[k] = found.first->second;
            edge_normals_[own[k]] = edge_normals_[own[k]] + normals_[f];
        }
        return own;
    }

    /// Of a facet at its corner; 1 in 2-D.
    double angle(std::size_t f, std::size_t k) const {
        if constexpr (D == 2) return 1.0;
        const Vec<double, D> u = facets_[f][(k + 1) % D] - facets_[f][k],
                             v = facets_[f][(k + 2) % D] - facets_[f][k];
        return std::acos(std::clamp(dot(u, v) / (norm(u) * norm(v)), -1.0, 1.0));
    }

    static void make_unit(Vec<double, D>& n) {
        if (const double length = norm(n); length > 0.0) n = (1.0 / length) * n;
    }

    Array<Facet<D>> facets_;
    Array<Vec<double, D>> normals_, corner_normals_, edge_normals_;
    Array<Numbers> corner_, edge_;
    std::size_t corners_ = 0;
};

}  // namespace doseki
