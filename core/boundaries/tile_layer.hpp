#pragma once
#include <algorithm>
#include <cmath>

#include "base/array.hpp"
#include "boundaries/height_field.hpp"

namespace doseki {

/// One layer of particles of a tile, so deep below the surface: they stand for equal areas of the
/// layer, so that each has the volume dp^D, in hollows and on ridges too.
template <int D>
class TileLayer {
public:
    struct Foot {
        Horizontal<D> place;  // of the surface above it
        double area;          // of the layer that it stands for [m^(D-1)]
    };

    TileLayer(const HeightField<D>& field, const Horizontal<D>& low, double side, double dp,
              double depth)
        : field_(field), low_(low), side_(side), dp_(dp), depth_(depth) {
        if constexpr (D == 2)
            add_row(low, 0, 1.0);
        else
            add_rows();
    }

    const Array<Foot>& feet() const { return feet_; }

private:
    static constexpr int probes = 4;  // of the slope, along each side of a tile

    /// Rows run along the steeper axis and are dp apart on the surface.
    void add_rows()
        requires(D == 3)
    {
        const Horizontal<D> steepness = mean_steepness();
        const int along = steepness[0] >= steepness[1] ? 0 : 1, across = 1 - along;
        const double width = side_ * std::sqrt(1.0 + steepness[across]);
        const double rows = std::max(1.0, std::round(width / dp_));
        for (int j = 0; j < static_cast<int>(rows); ++j) {
            Horizontal<D> start = low_;
            start[across] += (j + 0.5) * side_ / rows;
            add_row(start, along, side_ / rows);
        }
    }

    /// Mean square slope along each axis.
    Horizontal<D> mean_steepness() const
        requires(D == 3)
    {
        Horizontal<D> sum{};
        for (int i = 0; i < probes; ++i)
            for (int j = 0; j < probes; ++j) {
                Horizontal<D> place = low_;
                place[0] += (i + 0.5) * side_ / probes, place[1] += (j + 0.5) * side_ / probes;
                const Horizontal<D> slope = field_.at(place).slope;
                for (int a = 0; a < 2; ++a) sum[a] += slope[a] * slope[a] / (probes * probes);
            }
        return sum;
    }

    /// Along one row, which is `width` wide in plan.
    void add_row(const Horizontal<D>& start, int along, double width) {
        const int parts = 4 * static_cast<int>(std::ceil(side_ / dp_));
        const double step = side_ / parts;
        Array<double> area(static_cast<std::size_t>(parts) + 1);  // up to the end of each part
        Horizontal<D> place = start;
        for (int k = 0; k < parts; ++k) {
            place[along] = start[along] + (k + 0.5) * step;
            area[k + 1] = area[k] + field_.at(place).area * spread(place) * step * width;
        }
        const double total = area.back();
        const double count = std::max(1.0, std::round(total / std::pow(dp_, D - 1)));
        int part = 0;
        for (int k = 0; k < static_cast<int>(count); ++k) {
            const double middle = (k + 0.5) * total / count;
            while (area[part + 1] < middle) ++part;
            const double inside = (middle - area[part]) / (area[part + 1] - area[part]);
            place[along] = start[along] + (part + inside) * step;
            feet_.push_back({place, total / count});
        }
    }

    /// The area of the layer over that of the surface: below a hollow it is larger. Below a sharp
    /// ridge normals would cross, and there is next to none.
    double spread(const Horizontal<D>& place) const {
        if (depth_ == 0.0) return 1.0;
        const double step = 0.25 * dp_;
        double divergence = 0.0;
        for (int a = 0; a < D - 1; ++a) {
            Horizontal<D> ahead = place, behind = place;
            ahead[a] += step, behind[a] -= step;
            divergence += (field_.at(ahead).normal[a] - field_.at(behind).normal[a]) / (2.0 * step);
        }
        return std::max(1.0 - depth_ * divergence, 0.05);
    }

    const HeightField<D>& field_;
    Horizontal<D> low_;
    double side_, dp_, depth_;
    Array<Foot> feet_;
};

}  // namespace doseki
