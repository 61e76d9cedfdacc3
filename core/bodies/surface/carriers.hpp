#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "base/array.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "physics/kernel/wendland_c2.hpp"

namespace doseki {

/// The points with which a vertex of a surface goes: the shares of its place, which add up to 1,
/// and how its deformation gradient depends on them.
template <int D>
struct SurfaceCarriers {
    Array<PointShare> shares;
    Array<Vec<double, D>> slopes;  // 3-D: of each of these points

    Mat<double, D> motion(std::span<const Vec<double, D>> x) const {
        Mat<double, D> F{};
        for (std::size_t k = 0; k < slopes.size(); ++k)
            add_outer(F, 1.0, x[shares[k].point], slopes[k]);
        return F;
    }
};

/// Finds the carriers of vertices: in 2-D the point below one and its neighbours, Eq. (84a), in 3-D
/// a mean, which changes smoothly from place to place, of where the points around say that it is,
/// Eq. (165).
template <int D>
class VertexCarriers {
public:
    explicit VertexCarriers(const TotalLagrangian<D>& solids) : solids_(solids) {}

    /// Of the place at `offset` from point p at rest, which is the nearest one.
    SurfaceCarriers<D> of(std::uint32_t p, const Vec<double, D>& offset) {
        if constexpr (D == 2)
            return {solids_.carriers(p, offset), {}};
        else
            return around(p, offset);
    }

private:
    SurfaceCarriers<D> around(std::uint32_t p, const Vec<double, D>& offset) {
        constexpr double reach = 1.75;  // spacings
        const double scale = 1.0 / (reach * solids_.body_of(p).spacing);
        const Vec<double, D> place = solids_.rest_position(p) + offset;
        std::map<std::uint32_t, Share> shares;
        double sum = 0.0;
        for (const std::uint32_t j : points_around(p)) {
            const Vec<double, D> r = place - solids_.rest_position(j);
            const double weight = WendlandC2<D>::value(norm(r), scale);
            if (!(weight > 0.0)) continue;
            sum += weight, shares[j].place += weight;
            for (const auto& [k, slope] : slopes_of(j)) {
                Share& share = shares[k];
                share.place += weight * dot(slope, r);
                share.slope = share.slope + weight * slope;
            }
        }
        SurfaceCarriers<D> carriers;
        for (const auto& [k, share] : shares) {
            carriers.shares.push_back({k, share.place / sum});
            carriers.slopes.push_back((1.0 / sum) * share.slope);
        }
        return carriers;
    }

    struct Share {
        double place = 0.0;
        Vec<double, D> slope{};
    };
    using Slopes = std::map<std::uint32_t, Vec<double, D>>;

    /// Of the body of p, itself among them, no farther than twice the reach of its pairs.
    Array<std::uint32_t> points_around(std::uint32_t p) const {
        Array<std::uint32_t> around;
        for (const std::uint32_t j : solids_.neighbours_of(p))
            for (const std::uint32_t k : solids_.neighbours_of(j)) around.push_back(k);
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        return around;
    }
    /// How the deformation gradient of point p depends on points.
    const Slopes& slopes_of(std::uint32_t p) {
        const auto [found, is_new] = slopes_.try_emplace(p);
        if (!is_new) return found->second;
        for (int a = 0; a < D; ++a) {
            Vec<double, D> along{};
            along[a] = 1.0;
            for (const auto& [j, share] : solids_.carriers(p, along))
                found->second[j][a] = share - (j == p ? 1.0 : 0.0);
        }
        return found->second;
    }

    const TotalLagrangian<D>& solids_;
    std::map<std::uint32_t, Slopes> slopes_;
};

}  // namespace doseki
