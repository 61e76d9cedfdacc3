#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/array.hpp"
#include "model/particles.hpp"
#include "physics/viscosity.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// Height over the bed and depth of the flow at each fluid particle, along the last axis, as a
/// mixing length needs them. The plan is cut into columns: the bed is the highest wall particle of
/// a column below its fluid, the depth is that of the volume in it, so that spray counts for what
/// it is.
template <int D>
class FlowDepth {
public:
    /// `width` of a column along each axis of the plan [m].
    FlowDepth(const Particles<D>& particles, std::size_t fluid, const Vec<double, D - 1>& width,
              const Ranks& ranks)
        : width_(width) {
        for (std::size_t p = 0; p < fluid; ++p) {
            Column& column = columns_[key(particles.position[p])];
            column.volume += particles.mass[p] / particles.density[p];
            column.height += particles.position[p][D - 1];
            column.count += 1.0;
        }
        merge(ranks, [](Column& column, const Column& part) {
            column.volume += part.volume, column.height += part.height, column.count += part.count;
        });
        for (std::size_t p = fluid; p < particles.size(); ++p) {
            const auto found = columns_.find(key(particles.position[p]));
            if (found == columns_.end() || particles.is_bound(p) ||
                particles.wall.normal[p][D - 1] < 0.5)
                continue;
            Column& column = found->second;
            const double top = particles.position[p][D - 1] + particles.wall.depth[p];
            if (top < column.height / column.count) column.bed = std::max(column.bed, top);
        }
        merge(ranks, [](Column& column, const Column& part) {
            column.bed = std::max(column.bed, part.bed);
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
        return doseki::mixing_length(x[D - 1] - found->second.bed, depth, min_length);
    }

private:
    struct Column {
        double volume = 0.0, height = 0.0, count = 0.0,
               bed = -std::numeric_limits<double>::infinity();
    };
    using Key = std::array<std::int64_t, D - 1>;

    /// Puts together what each rank knows of a column, in the order of ranks; `add` adds a part to
    /// what there is.
    template <class Add>
    void merge(const Ranks& ranks, Add&& add) {
        if (ranks.alone()) return;
        constexpr std::size_t numbers = D + 3;
        Array<double> part;
        for (const auto& [key, column] : columns_) {
            for (const std::int64_t k : key) part.push_back(static_cast<double>(k));
            part.insert(part.end(), {column.volume, column.height, column.count, column.bed});
        }
        const Array<double> all = ranks.gather(part);
        columns_.clear();
        for (std::size_t row = 0; row < all.size(); row += numbers) {
            Key key;
            for (std::size_t a = 0; a < D - 1; ++a)
                key[a] = static_cast<std::int64_t>(all[row + a]);
            const double* value = &all[row + D - 1];
            add(columns_[key], Column{value[0], value[1], value[2], value[3]});
        }
    }

    Key key(const Vec<double, D>& x) const {
        Key key;
        for (int a = 0; a < D - 1; ++a)
            key[a] = static_cast<std::int64_t>(std::floor(x[a] / width_[a]));
        return key;
    }

    Vec<double, D - 1> width_;
    std::map<Key, Column> columns_;
};

}  // namespace doseki
