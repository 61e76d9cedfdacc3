#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/array.hpp"
#include "model/domain.hpp"
#include "model/particles.hpp"
#include "physics/viscosity.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// The axis that is nearest to upwards, and whether it points there: the last one unless gravity is
/// along it or nearly across it.
template <int D>
struct Upwards {
    int axis = D - 1;
    double sign = 1.0;

    explicit Upwards(const Vec<double, D>& gravity) {
        constexpr double across = 0.2;
        const double size = std::sqrt(dot(gravity, gravity));
        if (!(size > 0.0) || gravity[D - 1] < -across * size) return;
        for (int a = 0; a < D; ++a)
            if (std::abs(gravity[a]) > std::abs(gravity[axis])) axis = a;
        sign = gravity[axis] > 0.0 ? -1.0 : 1.0;
    }
    double height(const Vec<double, D>& x) const { return sign * x[axis]; }
};

/// How the plan is cut into columns of a `width` [m]; somewhat more where whole ones fill a period.
template <int D>
struct ColumnsOfPlan {
    Domain<D> domain;
    Upwards<D> up;
    double width;
};

/// Height over the bed and depth of the flow at each fluid particle, along an axis upwards, as a
/// mixing length needs them. The plan is cut into columns: the bed is the highest wall particle of
/// a column below its fluid, the depth is that of the volume in it, so that spray counts for what
/// it is.
template <int D>
class FlowDepth {
public:
    /// z0(p): height in the law of a rough bed of which p is a particle [m], else 0.
    template <class Z0>
    FlowDepth(const Particles<D>& particles, std::size_t fluid, const ColumnsOfPlan<D>& plan,
              const Z0& z0, const Ranks& ranks)
        : domain_(plan.domain), up_(plan.up) {
        for (int b = 0; b < D - 1; ++b) {
            const int a = of_plan(b);
            const double columns = std::max(1.0, std::floor(domain_.length(a) / plan.width));
            width_[b] = domain_.periodic[a] ? domain_.length(a) / columns : plan.width;
            from_[b] = domain_.periodic[a] ? domain_.low[a] : 0.0;
        }
        for (std::size_t p = 0; p < fluid; ++p) {
            Column& column = columns_[key(particles.position[p])];
            column.volume += particles.mass[p] / particles.density[p];
            column.height += up_.height(particles.position[p]);
            column.count += 1.0;
        }
        merge(ranks, [](Column& column, const Column& part) {
            column.volume += part.volume, column.height += part.height, column.count += part.count;
        });
        for (std::size_t p = fluid; p < particles.size(); ++p) {
            const auto found = columns_.find(key(particles.position[p]));
            if (found == columns_.end() || particles.is_bound(p) ||
                up_.height(particles.wall.normal[p]) < 0.5)
                continue;
            Column& column = found->second;
            const double top = up_.height(particles.position[p]) + particles.wall.depth[p];
            if (top < column.height / column.count)
                column.bed = std::max(column.bed, top), column.z0 = std::max(column.z0, z0(p));
        }
        merge(ranks, [](Column& column, const Column& part) {
            column.bed = std::max(column.bed, part.bed), column.z0 = std::max(column.z0, part.z0);
            column.volume = part.volume, column.height = part.height, column.count = part.count;
        });
    }

    /// Mixing length at a fluid particle; `min_length` where there is no bed.
    double mixing_length(const Vec<double, D>& x, double min_length) const {
        const auto found = columns_.find(key(x));
        if (found == columns_.end() || !std::isfinite(found->second.bed)) return min_length;
        double area = 1.0;
        for (int a = 0; a < D - 1; ++a) area *= width_[a];
        const double depth = found->second.volume / area;
        return doseki::mixing_length(up_.height(x) - found->second.bed, depth, min_length,
                                     found->second.z0);
    }

private:
    struct Column {
        double volume = 0.0, height = 0.0, count = 0.0,
               bed = -std::numeric_limits<double>::infinity(), z0 = 0.0;
    };
    using Key = std::array<std::int64_t, D - 1>;

    /// Puts together what each rank knows of a column, in the order of ranks; `add` adds a part to
    /// what there is.
    template <class Add>
    void merge(const Ranks& ranks, Add&& add) {
        if (ranks.alone()) return;
        constexpr std::size_t numbers = D + 4;
        Array<double> part;
        for (const auto& [key, column] : columns_) {
            for (const std::int64_t k : key) part.push_back(static_cast<double>(k));
            part.insert(part.end(),
                        {column.volume, column.height, column.count, column.bed, column.z0});
        }
        const Array<double> all = ranks.gather(part);
        columns_.clear();
        for (std::size_t row = 0; row < all.size(); row += numbers) {
            Key key;
            for (std::size_t a = 0; a < D - 1; ++a)
                key[a] = static_cast<std::int64_t>(all[row + a]);
            const double* value = &all[row + D - 1];
            add(columns_[key], Column{value[0], value[1], value[2], value[3], value[4]});
        }
    }

    Key key(const Vec<double, D>& x) const {
        const Vec<double, D> inside = wrapped(domain_, x);
        Key key;
        for (int b = 0; b < D - 1; ++b)
            key[b] =
                static_cast<std::int64_t>(std::floor((inside[of_plan(b)] - from_[b]) / width_[b]));
        return key;
    }
    /// Axis b of the plan.
    int of_plan(int b) const { return b < up_.axis ? b : b + 1; }

    Domain<D> domain_;
    Upwards<D> up_;
    Vec<double, D - 1> width_, from_;
    std::map<Key, Column> columns_;
};

}  // namespace doseki
