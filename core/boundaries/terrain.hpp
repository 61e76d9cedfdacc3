#pragma once
// A bed that is a surface, with wall particles only where there is flow.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "base/array.hpp"
#include "base/parallel.hpp"
#include "boundaries/fluid_columns.hpp"
#include "boundaries/ground_source.hpp"
#include "boundaries/height_field.hpp"
#include "boundaries/tile_grid.hpp"
#include "boundaries/wall_groups.hpp"
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
    bool faces = false;  // water may stand between it and bodies that lie on it
};

/// A terrain: the surface, and the groups of wall particles below it that are there. A group comes
/// when fluid, or the face of a body, may feel it and goes when all of these have gone, so that
/// memory grows with the flow and not with the map.
template <int D>
class Terrain {
    static constexpr int axes = D - 1;

public:
    bool is_there() const { return wall_.layers > 0; }

    /// `field` has its lean. Throws std::invalid_argument for more columns than have numbers.
    void set(std::shared_ptr<HeightField<D>> field, const TerrainWall& wall) {
        field_ = std::move(field), wall_ = wall;
        grid_ = TileGrid<D>(*field_, wall.dp);
        there_ = WallGroups(wall.layers);
    }

    /// This rank is to hold only the part of the map that it needs, which `source` gives it.
    void share(GroundSource<D> source) { source_ = std::move(source); }
    /// For a place in the ground and the normal there, one after another, the share of a cell of
    /// dp^D around it that no body takes up, and the middle of that.
    using Remainder = std::function<Array<double>(const Array<double>&)>;
    /// Has wall particles only where bodies have none: each would bear a part of the other's load.
    void make_room(Remainder remainder) { remainder_ = std::move(remainder); }
    /// Gets the part of the map that is near particles of this rank and near all bodies. All ranks
    /// call it before they ask for the ground, `reach` [m] away from these at most.
    template <class Largest>
    void fetch(const Particles<D>& particles, double reach, const Largest& largest) {
        if (!source_ || !is_there()) return;
        const double across = reach + field_->lean() * wall_.layers * wall_.dp + grid_.side();
        source_.fetch(*field_, particles, across, largest);
    }

    /// Finds the groups that fluid may feel before it has gone `margin` [m], marks in `removed` the
    /// particles of groups that it has left, and remembers which to add. All ranks call it:
    /// `gather` makes numbers of all ranks of those of one; `rank` is the own one.
    /// True where any rank has groups to add or to drop.
    template <class Gather>
    bool look(const Particles<D>& particles, double support, double margin, int rank,
              const Gather& gather, Array<std::uint8_t>& removed);

    /// Adds the particles of the groups that look() has found; their ids go on from `next_id`.
    /// Each rank adds those whose fluid is its own.
    template <class Gather>
    void fill(Particles<D>& particles, std::int64_t& next_id, int rank, const Gather& gather);

    /// Whether a place is beyond the map, or where the map says nothing: what comes there leaves.
    bool contains(const Vec<double, D>& x) const {
        return is_there() && field_->is_unknown(horizontal(x));
    }

    /// Whether a place is so far below the ground that what is there has gone through it, and
    /// falls.
    bool is_far_below(const Vec<double, D>& x) const {
        return x[axes] < field_->height(horizontal(x)) - far * wall_.layers * wall_.dp;
    }

    void serialise(Archive& archive) {
        if (is_there()) there_.serialise(archive);
    }
    /// Throws std::invalid_argument where what was loaded is none of this terrain.
    void expect_groups(const Particles<D>& particles) const;

private:
    /// How much farther than it takes to make it a group may be from fluid [dp]: what trembles at
    /// an edge must not make and drop particles at each list.
    static constexpr double slack = 0.5;
    static constexpr double min_share = 0.02;  // of a cell, that is worth a particle
    static constexpr double far = 4.0;         // thicknesses of the wall, below the ground

    bool is_own(const Particles<D>& particles, std::size_t p) const {
        return particles.is_fixed(p) && particles.tag[p].body == wall_.body;
    }
    /// Which group a wall particle is of.
    auto group_of(const Particles<D>& particles, std::size_t p) const {
        const std::int32_t column = particles.wall.point[p];
        return WallGroups::Group{column / TileGrid<D>::columns, column % TileGrid<D>::columns,
                                 WallTile<D>::layer_of(particles.wall.depth[p], wall_.dp)};
    }

    double highest(std::int64_t tile) const;
    void lay_out(const FluidColumns<D>& fluid, double reach);
    void cut_at_bodies(std::span<WallTile<D>* const> tiles) const;
    WallGroups felt(const FluidColumns<D>& fluid, double reach) const;
    const WallTile<D>& layout(std::int64_t tile) const {
        return *std::lower_bound(
            layouts_.begin(), layouts_.end(), tile,
            [](const WallTile<D>& each, std::int64_t k) { return each.number < k; });
    }
    /// Calls f(slot) for what is to be added of tile k of wanted_.
    template <class F>
    void for_each_new(std::size_t k, const F& f) const {
        const std::int64_t tile = wanted_.tile(k);
        for (const auto& slot : layout(tile).slots)
            if (wanted_.has(k, slot) && !there_.has({tile, slot.column, slot.layer})) f(slot);
    }
    void add_particle(Particles<D>& particles, std::int64_t tile,
                      const typename WallTile<D>::Slot& slot, std::int64_t id) const;

    std::shared_ptr<HeightField<D>> field_;
    GroundSource<D> source_;  // of the map, where a rank holds a part of it
    Remainder remainder_;     // none: no body stands in the ground
    TerrainWall wall_;
    TileGrid<D> grid_;
    WallGroups there_, wanted_;
    bool changes_ = false;        // wanted_ is not there yet
    Array<WallTile<D>> layouts_;  // of tiles near fluid of this rank, in the order of their numbers
};

template <int D>
void Terrain<D>::expect_groups(const Particles<D>& particles) const {
    there_.expect_fit(grid_.count(), TileGrid<D>::columns);
    if (!is_there() || !particles.wall.in_use) return;
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (is_own(particles, p)) expect_fit(there_.has(group_of(particles, p)), "point");
}

/// No bed in the tile is higher [m]: from samples, with room for what lies between them.
template <int D>
double Terrain<D>::highest(std::int64_t tile) const {
    const int samples = 2 + std::min(30, static_cast<int>(2.0 * grid_.side() / field_->cell));
    double top = -std::numeric_limits<double>::infinity(), low = -top;
    const Horizontal<D> corner = grid_.corner(tile);
    const auto step = [&](int i) { return i * grid_.side() / samples; };
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

/// Lays out the tiles that are near fluid and forgets the others.
template <int D>
void Terrain<D>::lay_out(const FluidColumns<D>& fluid, double reach) {
    Array<std::int64_t> near;
    const auto has_layout = [&](std::int64_t tile) {
        return !layouts_.empty() && layouts_.back().number >= tile && layout(tile).number == tile;
    };
    // Normals lean, so that a particle may lie beside its tile by part of how deep it is.
    const double across = reach + field_->lean() * wall_.layers * wall_.dp;
    for (const auto& over : fluid.tiles()) {
        Horizontal<D> from = over.from, to = over.to;
        for (int a = 0; a < axes; ++a) from[a] -= across, to[a] += across;
        grid_.for_each_tile(from, to, [&](std::int64_t tile) {
            if (has_layout(tile) || over.low - reach < highest(tile)) near.push_back(tile);
        });
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    Array<WallTile<D>> layouts(near.size());
    for_each_task(near.size(), 1, [&](int, std::size_t k) {
        if (has_layout(near[k]))
            layouts[k] = layout(near[k]);
        else
            layouts[k] = WallTile<D>(*field_, grid_, near[k], wall_.layers);
    });
    Array<WallTile<D>*> made;
    for (WallTile<D>& tile : layouts)
        if (!has_layout(tile.number)) made.push_back(&tile);
    cut_at_bodies(made);
    layouts_.swap(layouts);
}

/// Leaves what bodies do not take up; of all tiles at once, for the answer may come from afar.
template <int D>
void Terrain<D>::cut_at_bodies(std::span<WallTile<D>* const> tiles) const {
    if (!remainder_ || tiles.empty()) return;
    Array<double> cells;
    for (const WallTile<D>* tile : tiles)
        for (const auto& slot : tile->slots)
            for (const auto& vector : {slot.position, slot.normal})
                for (const double each : vector.component) cells.push_back(each);
    const Array<double> remainder = remainder_(cells);
    const double* next = remainder.data();
    for (WallTile<D>* tile : tiles) {
        Array<typename WallTile<D>::Slot> left;
        for (auto slot : tile->slots) {
            slot.share = *next++;
            Vec<double, D> middle;
            for (int a = 0; a < D; ++a) middle[a] = *next++;
            slot.depth -= dot(middle - slot.position, slot.normal), slot.position = middle;
            if (slot.share > min_share) left.push_back(slot);
        }
        tile->slots.swap(left);
    }
}

/// The groups that fluid of this rank may feel, or has felt and has hardly left.
template <int D>
WallGroups Terrain<D>::felt(const FluidColumns<D>& fluid, double reach) const {
    const std::size_t layers = static_cast<std::size_t>(wall_.layers);
    Array<WallGroups::Word> words(layouts_.size() * layers, 0);
    for_each_task(layouts_.size(), 1, [&](int, std::size_t k) {
        const WallTile<D>& tile = layouts_[k];
        const typename FluidColumns<D>::Around around(fluid, tile.number);
        const std::size_t own = there_.place(tile.number);
        for (const auto& slot : tile.slots) {
            WallGroups::Word& word = words[k * layers + static_cast<std::size_t>(slot.layer)];
            const WallGroups::Word bit = WallGroups::Word{1} << slot.column;
            if (word & bit) continue;
            const double distance = there_.has(own, slot) ? reach + slack * wall_.dp : reach;
            if (fluid.is_near(around, slot.position, distance)) word |= bit;
        }
    });
    WallGroups felt(wall_.layers);
    for (std::size_t k = 0; k < layouts_.size(); ++k)
        felt.append(layouts_[k].number, {words.data() + k * layers, layers});
    return felt;
}

template <int D>
template <class Gather>
bool Terrain<D>::look(const Particles<D>& particles, double support, double margin, int rank,
                      const Gather& gather, Array<std::uint8_t>& removed) {
    const double reach = support + margin, farthest = reach + slack * wall_.dp;
    const FluidColumns<D> fluid(grid_, particles, farthest, wall_.faces);
    lay_out(fluid, farthest);
    wanted_ = WallGroups::merged(gather(felt(fluid, reach).as_numbers(rank)), wall_.layers);
    const bool adds = !there_.contains(wanted_), drops = !wanted_.contains(there_);
    changes_ = adds || drops;
    if (!drops) return changes_;
    removed.resize(particles.size(), 0);
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (is_own(particles, p) && !wanted_.has(group_of(particles, p))) removed[p] = 1;
    return true;
}

template <int D>
template <class Gather>
void Terrain<D>::fill(Particles<D>& particles, std::int64_t& next_id, int rank,
                      const Gather& gather) {
    if (!changes_) return;
    Array<double> counts;  // place in wanted_, particles
    std::size_t added = 0;
    for (std::size_t k = 0; k < wanted_.size(); ++k) {
        if (wanted_.rank(k) != rank) continue;
        std::size_t count = 0;
        for_each_new(k, [&](const auto&) { ++count; });
        if (count == 0) continue;
        counts.push_back(static_cast<double>(k)), counts.push_back(static_cast<double>(count));
        added += count;
    }
    const Array<double> all = gather(counts);
    Array<std::pair<std::size_t, std::int64_t>> of_tiles;
    for (std::size_t k = 0; k < all.size(); k += 2)
        of_tiles.push_back(
            {static_cast<std::size_t>(all[k]), static_cast<std::int64_t>(all[k + 1])});
    std::sort(of_tiles.begin(), of_tiles.end());
    for (const auto& [k, count] : of_tiles) {
        std::int64_t id = next_id;
        if (wanted_.rank(k) == rank)
            for_each_new(
                k, [&](const auto& slot) { add_particle(particles, wanted_.tile(k), slot, id++); });
        next_id += count;
    }
    there_ = wanted_, changes_ = false;
}

template <int D>
void Terrain<D>::add_particle(Particles<D>& particles, std::int64_t tile,
                              const typename WallTile<D>::Slot& slot, std::int64_t id) const {
    const std::size_t p = particles.size();
    resize(particles, p + 1);
    particles.position[p] = slot.position;
    particles.density[p] = wall_.density;
    particles.mass[p] = slot.share * wall_.density * slot.area * wall_.dp;
    particles.smoothing_length[p] = wall_.smoothing_length;
    particles.tag[p] = {id, wall_.body, wall_.material, Motion::fixed};
    particles.enter(p);
    particles.wall.normal[p] = slot.normal, particles.wall.bend[p] = slot.bend;
    particles.wall.depth[p] = slot.depth, particles.wall.cut[p] = 1.0 - slot.share;
    particles.wall.face[p] = wall_.faces && slot.layer == 0 ? Face::fixed : Face::none;
    particles.wall.point[p] = static_cast<std::int32_t>(tile * TileGrid<D>::columns + slot.column);
}

}  // namespace doseki
