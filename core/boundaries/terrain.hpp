#pragma once
// A bed that is a surface, with wall particles only where there is flow.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>

#include "base/array.hpp"
#include "boundaries/height_field.hpp"
#include "model/archive.hpp"
#include "model/particles.hpp"

namespace doseki {

/// What wall particles of a terrain are like.
struct TerrainWall {
    double dp = 0.0;                // their spacing [m]
    int layers = 0;                 // below the surface
    double density = 0.0;           // [kg/m^3]
    double smoothing_length = 0.0;  // [m]
    std::int16_t material = 0;
    std::int32_t body = 0;
};

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

/// A terrain: the surface, and the tiles of it that have wall particles. A tile gets them when
/// fluid comes near and loses them when all fluid has gone, so that memory grows with the flow and
/// not with the map.
template <int D>
class Terrain {
    static constexpr int axes = D - 1;
    static constexpr int tile_columns = D == 2 ? 16 : 8;

public:
    bool is_there() const { return wall_.layers > 0; }

    /// `field` has its lean.
    void set(std::shared_ptr<const HeightField<D>> field, const TerrainWall& wall) {
        field_ = std::move(field), wall_ = wall;
        side_ = tile_columns * wall.dp;
        for (int a = 0; a < axes; ++a) {
            // One tile more on each side, for what flows along the edge of the map.
            low_[a] = field_->origin[a] - side_;
            const double tiles = std::ceil((field_->end(a) + side_ - low_[a]) / side_);
            tiles_[a] = static_cast<std::int64_t>(tiles);
        }
    }

    /// Finds the tiles that fluid may reach before it has gone `margin` [m], marks in `removed` the
    /// particles of tiles that it has left, and remembers which tiles to fill. All ranks call it:
    /// `gather` makes numbers of all ranks of those of one.
    template <class Gather>
    void look(const Particles<D>& particles, double support, double margin, const Gather& gather,
              Array<std::uint8_t>& removed);

    /// Adds the particles of the tiles that look() has found; their ids go on from `next_id`. Where
    /// `adds` is false another rank adds them.
    void fill(Particles<D>& particles, std::int64_t& next_id, bool adds);

    /// Whether a place is beyond the map, or where the map says nothing: what comes there leaves.
    bool contains(const Vec<double, D>& x) const {
        return is_there() && field_->is_unknown(horizontal(x));
    }

    void serialise(Archive& archive) {
        if (is_there()) archive("terrain_tiles", active_);
    }
    /// Throws std::invalid_argument where what was loaded is none of this terrain.
    void expect_tiles(const Particles<D>& particles) const;

private:
    /// A tile with fluid above it: what of it that is, in plan, and where the lowest is [m].
    struct Occupied {
        std::int64_t tile;
        Horizontal<D> from, to;
        double low;

        void add(const Occupied& other) {
            for (int a = 0; a < axes; ++a) {
                from[a] = std::min(from[a], other.from[a]);
                to[a] = std::max(to[a], other.to[a]);
            }
            low = std::min(low, other.low);
        }
    };

    bool is_own(const Particles<D>& particles, std::size_t p) const {
        return particles.is_fixed(p) && particles.tag[p].body == wall_.body;
    }
    bool is_active(std::int64_t tile) const {
        return std::binary_search(active_.begin(), active_.end(), tile);
    }
    std::int64_t tile_count() const {
        std::int64_t count = 1;
        for (int a = 0; a < axes; ++a) count *= tiles_[a];
        return count;
    }

    /// The tile above which a place is; those beyond the map belong to its edge.
    std::int64_t tile_at(const Horizontal<D>& place) const {
        std::int64_t tile = 0, stride = 1;
        for (int a = 0; a < axes; ++a) {
            const double u = std::floor((place[a] - low_[a]) / side_);
            const double last = static_cast<double>(tiles_[a] - 1);
            tile += static_cast<std::int64_t>(std::clamp(u, 0.0, last)) * stride;
            stride *= tiles_[a];
        }
        return tile;
    }
    Horizontal<D> corner_of(std::int64_t tile) const {
        Horizontal<D> corner = low_;
        for (int a = 0; a < axes; ++a) {
            corner[a] += static_cast<double>(tile % tiles_[a]) * side_;
            tile /= tiles_[a];
        }
        return corner;
    }

    /// Calls f(tile) for the tiles no farther than `distance` [m] from the fluid.
    template <class F>
    void for_each_near(const Occupied& fluid, double distance, const F& f) const {
        Horizontal<D> from = fluid.from, to = fluid.to;
        for (int a = 0; a < axes; ++a) from[a] -= distance, to[a] += distance;
        const std::int64_t first = tile_at(from), last = tile_at(to), width = tiles_[0];
        for (std::int64_t row = first / width; row <= last / width; ++row)
            for (std::int64_t column = first % width; column <= last % width; ++column)
                f(row * width + column);
    }

    static Array<double> as_numbers(const Array<Occupied>& tiles);
    static Array<Occupied> from_numbers(const Array<double>& numbers);
    Array<Occupied> occupied(const Particles<D>& particles) const;
    static Array<Occupied> merged(Array<Occupied> tiles);
    double highest(std::int64_t tile) const;
    void add_particle(Particles<D>& particles, std::int64_t tile, double depth,
                      const typename TileLayer<D>::Foot& foot, std::int64_t id) const;

    std::shared_ptr<const HeightField<D>> field_;
    TerrainWall wall_;
    double side_ = 0.0;                       // of a tile [m]
    Horizontal<D> low_{};                     // corner of the first tile
    std::array<std::int64_t, axes> tiles_{};  // along each axis
    Array<std::int64_t> active_;              // tiles that have their particles, in order
    Array<std::int64_t> to_fill_;
};

template <int D>
void Terrain<D>::expect_tiles(const Particles<D>& particles) const {
    for (std::size_t k = 0; k < active_.size(); ++k) {
        expect_index(active_[k], static_cast<std::size_t>(tile_count()), "terrain_tiles");
        expect_fit(k == 0 || active_[k - 1] < active_[k], "terrain_tiles");
    }
    if (!is_there() || !particles.wall.in_use) return;
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (is_own(particles, p)) expect_fit(is_active(particles.wall.point[p]), "point");
}

/// A tile may be among them several times.
template <int D>
auto Terrain<D>::occupied(const Particles<D>& particles) const -> Array<Occupied> {
    Array<Occupied> found;
    for (std::size_t p = 0; p < particles.size(); ++p) {
        if (particles.is_wall(p)) continue;
        const Vec<double, D>& x = particles.position[p];
        const Horizontal<D> place = horizontal(x);
        const Occupied own{tile_at(place), place, place, x[axes]};
        if (!found.empty() && found.back().tile == own.tile)
            found.back().add(own);
        else
            found.push_back(own);
    }
    return found;
}

/// In the order of tiles, each once.
template <int D>
auto Terrain<D>::merged(Array<Occupied> tiles) -> Array<Occupied> {
    std::sort(tiles.begin(), tiles.end(),
              [](const Occupied& a, const Occupied& b) { return a.tile < b.tile; });
    Array<Occupied> found;
    for (const Occupied& each : tiles) {
        if (!found.empty() && found.back().tile == each.tile)
            found.back().add(each);
        else
            found.push_back(each);
    }
    return found;
}

template <int D>
Array<double> Terrain<D>::as_numbers(const Array<Occupied>& tiles) {
    Array<double> numbers;
    for (const Occupied& each : tiles) {
        numbers.push_back(static_cast<double>(each.tile)), numbers.push_back(each.low);
        for (int a = 0; a < axes; ++a)
            numbers.push_back(each.from[a]), numbers.push_back(each.to[a]);
    }
    return numbers;
}

template <int D>
auto Terrain<D>::from_numbers(const Array<double>& numbers) -> Array<Occupied> {
    Array<Occupied> tiles;
    for (std::size_t k = 0; k < numbers.size(); k += 2 * axes + 2) {
        Occupied each{static_cast<std::int64_t>(numbers[k]), {}, {}, numbers[k + 1]};
        for (std::size_t a = 0; a < axes; ++a) {
            each.from[static_cast<int>(a)] = numbers[k + 2 + 2 * a];
            each.to[static_cast<int>(a)] = numbers[k + 3 + 2 * a];
        }
        tiles.push_back(each);
    }
    return tiles;
}

/// No bed in the tile is higher [m]: from samples, with room for what lies between them.
template <int D>
double Terrain<D>::highest(std::int64_t tile) const {
    const int samples = 2 + std::min(30, static_cast<int>(2.0 * side_ / field_->cell));
    double top = -std::numeric_limits<double>::infinity(), low = -top;
    const Horizontal<D> corner = corner_of(tile);
    const auto step = [&](int i) { return i * side_ / samples; };
    for (int i = 0; i <= samples; ++i)
        for (int j = 0; j <= (D == 3 ? samples : 0); ++j) {
            Horizontal<D> place = corner;
            place[0] += step(i);
            if constexpr (D == 3) place[1] += step(j);
            const double height = field_->height(place);
            top = std::max(top, height), low = std::min(low, height);
        }
    return top + 0.25 * (top - low);
}

template <int D>
template <class Gather>
void Terrain<D>::look(const Particles<D>& particles, double support, double margin,
                      const Gather& gather, Array<std::uint8_t>& removed) {
    // Normals lean, so that a particle may lie beside its tile by part of how deep it is.
    const double reach = support + margin + field_->lean() * wall_.layers * wall_.dp;
    Array<std::int64_t> kept;
    to_fill_.clear();
    const Array<double> numbers = gather(as_numbers(occupied(particles)));
    for (const Occupied& each : merged(from_numbers(numbers))) {
        for_each_near(each, reach, [&](std::int64_t tile) {
            if (!is_active(tile) && each.low - reach < highest(tile)) to_fill_.push_back(tile);
        });
        // Farther: particles that tremble on an edge must not make and drop tiles.
        for_each_near(each, reach + 0.5 * side_, [&](std::int64_t tile) {
            if (is_active(tile)) kept.push_back(tile);
        });
    }
    for (Array<std::int64_t>* tiles : {&to_fill_, &kept}) {
        std::sort(tiles->begin(), tiles->end());
        tiles->erase(std::unique(tiles->begin(), tiles->end()), tiles->end());
    }
    if (kept.size() == active_.size()) return;
    active_.swap(kept);
    removed.resize(particles.size(), 0);
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (is_own(particles, p) && !is_active(particles.wall.point[p])) removed[p] = 1;
}

template <int D>
void Terrain<D>::fill(Particles<D>& particles, std::int64_t& next_id, bool adds) {
    for (const std::int64_t tile : to_fill_)
        for (int layer = 0; layer < wall_.layers; ++layer) {
            const double depth = (layer + 0.5) * wall_.dp;
            const TileLayer<D> made(*field_, corner_of(tile), side_, wall_.dp, depth);
            for (const auto& foot : made.feet()) {
                if (adds) add_particle(particles, tile, depth, foot, next_id);
                ++next_id;
            }
        }
    active_.insert(active_.end(), to_fill_.begin(), to_fill_.end());
    std::sort(active_.begin(), active_.end());
    to_fill_.clear();
}

template <int D>
void Terrain<D>::add_particle(Particles<D>& particles, std::int64_t tile, double depth,
                              const typename TileLayer<D>::Foot& foot, std::int64_t id) const {
    const auto surface = field_->at(foot.place);
    Vec<double, D> x{};
    for (int a = 0; a < axes; ++a) x[a] = foot.place[a];
    x[axes] = surface.height;
    const std::size_t p = particles.size();
    resize(particles, p + 1);
    particles.position[p] = x - depth * surface.normal;
    particles.density[p] = wall_.density;
    particles.mass[p] = wall_.density * foot.area * wall_.dp;
    particles.smoothing_length[p] = wall_.smoothing_length;
    particles.tag[p] = {id, wall_.body, wall_.material, Motion::fixed};
    particles.enter(p);
    particles.wall.normal[p] = surface.normal;
    particles.wall.depth[p] = depth;
    particles.wall.point[p] = static_cast<std::int32_t>(tile);
}

}  // namespace doseki
