#pragma once
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>

#include "base/array.hpp"
#include "base/field.hpp"
#include "base/vec.hpp"
#include "model/archive.hpp"
#include "physics/wall.hpp"

namespace doseki {

/// How a particle's position changes. Fixed particles give interactions but never move (the paper's
/// slope); driven ones move with a prescribed velocity (the inflow buffer); bound ones are points
/// of a body that moves as a whole.
enum class Motion : std::uint8_t { free, fixed, driven, bound };

/// The kind of body that a bound particle is a point of.
enum class BodyKind : std::uint8_t { none, rigid, deformable };

/// What a particle is, in one machine word and a half.
struct Tag {
    std::int64_t id;
    std::int32_t body;
    std::int16_t material;
    Motion motion;
};

/// What wall particles have: those of fixed bodies and the points of bodies that move.
template <int D>
struct WallState {
    bool in_use = false;  // of schemes that tell walls from particles; else all are empty
    WallField<Vec<double, D>> normal;  // into the fluid
    WallField<Sym<double, D>>
        bend;                 // how the normal turns along the surface, where it curves [1/m]
    WallField<double> depth;  // below the surface of the wall [m]
    // Near an edge of the wall, else zero: normals of the nearest faces in rows, of which `normal`
    // is the mean where they are as near, and the depths below them [m].
    WallField<Mat<double, D>> edge_normals;
    WallField<Vec<double, D>> edge_depths;
    WallField<double> cut;              // share of its volume, of a terrain's, that a body takes up
    WallField<Vec<double, D>> force;    // of the fluid on it [N], 2-D: [N/m]
    WallField<Turn<double, D>> moment;  // of that about the particle [N m], 2-D: [N]
    WallField<Turn<double, D>> spin;    // of its body, which the fluid meets [rad/s]
    WallField<double> pressure;         // of the fluid at its place [Pa]
    // Of faces between which fluid stands though no particle fits (physics/wall.hpp):
    WallField<std::int32_t> face;    // see Face
    WallField<Vec<double, D>> area;  // of a body that moves, outwards [m^2], 2-D: [m]
    WallField<double> wetted;        // share of it that fluid sees where nothing else does, else 0
    WallField<double> film_change;   // of its pressure in the last step [Pa]
    WallField<double> film_cover;    // share of it that other faces cover
    WallField<double> film_density;  // of the fluid that presses on it [kg/m^3]; 0: dry
    // Force on it over the sum of weights of other faces; at edges, see is_at_edge, that along each
    // face over how much others are in front of it, and what those in front of its other faces bear
    // along it.
    WallField<Vec<double, D>> film_traction, film_aside;
    WallField<BodyKind> body_kind;  // of bound particles
    // Index among the points of bodies of that kind; of a terrain's particle, its tile.
    WallField<std::int32_t> point;

    template <class F>
    void for_each_field(F&& f) {
        if (!in_use) return;
        f("normal", normal), f("wall_bend", bend), f("wall_depth", depth), f("wall_cut", cut);
        f("edge_normals", edge_normals), f("edge_depths", edge_depths);
        f("wall_force", force), f("wall_moment", moment), f("wall_spin", spin);
        f("wall_pressure", pressure);
        f("face", face), f("face_area", area), f("face_wetted", wetted);
        f("film_change", film_change), f("film_density", film_density), f("film_cover", film_cover),
            f("film_traction", film_traction), f("film_aside", film_aside);
        f("body_kind", body_kind), f("point", point);
    }
};

/// The state that every scheme has, one field per quantity, sorted in space by Neighbours.
/// Everything is double: the precision of a run is that of its pair sums. A scheme's own State
/// derives from this and adds what else it keeps of a particle; StateOf makes one of it that others
/// can grow, sort, send and save.
template <int D>
struct Particles {
    static constexpr int dim = D;

    Particles() = default;
    Particles(const Particles&) = delete;
    Particles& operator=(const Particles&) = delete;
    virtual ~Particles() = default;

    /// All fields, those of the scheme among them.
    virtual Array<NamedField> fields() = 0;
    virtual void serialise(Archive& archive) = 0;
    /// A particle that an inflow has just added, whose common fields are set.
    virtual void enter(std::size_t p) = 0;

    Field<Vec<double, D>> position;      // [m]
    Field<Vec<double, D>> velocity;      // [m/s]
    Field<Vec<double, D>> acceleration;  // [m/s^2]
    Field<double> density;               // [kg/m^3]
    Field<double> density_rate;          // [kg/m^3/s]
    Field<double> mass;                  // [kg], 2-D: [kg/m]
    Field<double> smoothing_length;      // [m]
    Field<Tag> tag;
    WallState<D> wall;

    std::size_t size() const { return tag.size(); }

    DOSEKI_DEVICE_FN bool is_free(std::size_t p) const { return tag[p].motion == Motion::free; }
    DOSEKI_DEVICE_FN bool is_fixed(std::size_t p) const { return tag[p].motion == Motion::fixed; }
    DOSEKI_DEVICE_FN bool is_bound(std::size_t p) const { return tag[p].motion == Motion::bound; }
    /// One that fluid meets as it meets a wall.
    DOSEKI_DEVICE_FN bool is_wall(std::size_t p) const { return is_fixed(p) || is_bound(p); }
    /// Whether particle p is a point of a body of that kind.
    DOSEKI_DEVICE_FN bool is_point_of(std::size_t p, BodyKind kind) const {
        return wall.in_use && is_bound(p) && wall.body_kind[p] == kind;
    }
    /// Its number among the points of bodies of its kind.
    DOSEKI_DEVICE_FN std::size_t point(std::size_t p) const {
        return static_cast<std::size_t>(wall.point[p]);
    }
    void set_point(std::size_t p, BodyKind kind, std::size_t point) {
        wall.body_kind[p] = kind, wall.point[p] = static_cast<std::int32_t>(point);
    }
    /// One that is in the account of masses.
    DOSEKI_DEVICE_FN bool is_counted(std::size_t p) const { return is_free(p) || is_bound(p); }

protected:
    /// Calls f(name, field) for the fields above.
    template <class F>
    void for_each_common_field(F&& f) {
        f("position", position), f("velocity", velocity), f("acceleration", acceleration);
        f("density", density), f("density_rate", density_rate);
        f("mass", mass), f("smoothing_length", smoothing_length), f("tag", tag);
        wall.for_each_field(f);
    }

    double sum_of_common_fields(std::size_t p) const {
        double sum = density[p];
        for (int a = 0; a < D; ++a) sum += position[p][a] + velocity[p][a];
        return sum;
    }
};

/// The state of a scheme, which lists its fields, those of Particles among them, in
/// for_each_field(f(name, field)); what others do with all of them follows from that one list.
template <class State>
struct StateOf final : State {
    using State::State;

    Array<NamedField> fields() override {
        Array<NamedField> fields;
        this->for_each_field(
            [&fields](const char* name, auto& field) { fields.push_back({name, &field}); });
        return fields;
    }
    void serialise(Archive& archive) override { this->for_each_field(archive); }
};

template <int D>
void resize(Particles<D>& particles, std::size_t n) {
    for (const NamedField& field : particles.fields()) field.memory->resize(n);
}

}  // namespace doseki
