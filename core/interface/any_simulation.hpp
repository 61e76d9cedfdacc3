#pragma once
// A simulation of any scheme, dimension and precision, as its caller sees it.

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "interface/value.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// Where a run stands, and what it has done so far.
struct Progress {
    double time = 0.0, timestep = 0.0;  // [s]
    std::int64_t steps = 0, rebuilds = 0, updates = 0;
    std::size_t particles = 0;
    double skin = 0.0;  // of the smallest support radius
};

/// Tables of particles are in the order of their ids, those of bodies in the order of adding.
/// What throws std::invalid_argument says which key or array is wrong.
class AnySimulation {
public:
    virtual ~AnySimulation() = default;

    virtual void add_particles(const NamedValues& columns) = 0;
    /// Normals, depths and curvatures of walls, for all particles in the order of adding.
    virtual void set_walls(const NamedValues& columns) = 0;
    /// The nearest faces beside edges of walls, for all particles; after set_walls and before
    /// bind_points.
    virtual void set_edges(const NamedValues& columns) = 0;
    /// Faces between which fluid stands though no particle fits, for all particles; after
    /// set_walls and before bind_points.
    virtual void set_faces(const NamedValues& columns) = 0;
    /// Balls {radius}, the ground {radius, ground}, or convex shapes {vertices, faces, samples},
    /// which bodies name by index.
    virtual void add_shapes(const std::vector<NamedValues>& shapes) = 0;
    virtual void add_rigid_bodies(const NamedValues& columns) = 0;
    /// `body`: index of its rigid body for each particle in the order of adding, or -1; after
    /// set_walls.
    virtual void bind_points(const NamedValues& columns) = 0;
    /// A body of particles that have been added; after set_walls.
    virtual void add_elastic_body(const NamedValues& body) = 0;
    virtual void add_inflow(const NamedValues& inflow) = 0;
    virtual void add_outflow(const std::vector<double>& low, const std::vector<double>& high) = 0;
    /// Counts what crosses a plane; `normal` points downstream.
    virtual void add_plane(const std::vector<double>& point, const std::vector<double>& normal) = 0;
    virtual void move_body(const NamedValues& motion) = 0;
    /// A bed that is a surface, and what its wall particles are like.
    virtual void set_terrain(const NamedValues& field, const NamedValues& wall) = 0;
    /// Where a rank that is to hold only a part of the terrain gets it from, see GroundSource.
    using NumberReader = std::function<Array<double>(const Array<double>&)>;
    virtual void share_terrain(NumberReader read) = 0;
    /// Where bodies stand in the terrain, see Terrain::make_room.
    virtual void make_room_in_terrain(NumberReader remainder) = 0;
    /// Sums what acts on the fixed bodies of these indices, about a point and, with `count`, on
    /// panels.
    virtual void add_load_meter(const NamedValues& meter) = 0;
    /// Deviatoric stresses of all particles in the order of adding, where the scheme evolves them.
    virtual void set_stresses(const NamedValues& columns) = 0;
    /// Sets the clock [s] of a run that goes on from another one; after the inflows.
    virtual void begin_at(double time) = 0;
    /// Makes this one of several ranks.
    virtual void join(std::unique_ptr<Exchange> exchange) = 0;

    virtual void start() = 0;
    virtual void advance(double limit, double pause, std::int64_t max_steps) = 0;

    virtual Progress progress() const = 0;
    virtual double bytes_per_particle() const = 0;
    virtual double entries_per_particle() const = 0;  // of the neighbour lists
    virtual bool has_bodies() const = 0;
    virtual NamedValues state() const = 0;
    virtual NamedValues rates() const = 0;
    virtual NamedValues totals() const = 0;
    virtual NamedValues grains() const = 0;
    /// Deformable bodies that may break, and their parts, by `number`; `centre`, `radius` and what
    /// else grains() has.
    virtual NamedValues fragments() const = 0;
    /// Where the energy of bodies is, see BodyEnergy.
    virtual NamedValues body_energy() = 0;
    /// `label`: of each point of deformable bodies in the order of adding; those with different
    /// ones do not hold together from now on.
    virtual void cut_bodies(const NamedValues& columns) = 0;
    /// What load meters have summed, in the order of adding.
    virtual NamedValues loads() const = 0;
    /// The peak and hit of a meter are those from now on.
    virtual void forget_load_peak(std::size_t meter) = 0;
    /// What gauges read of the particles in a box.
    virtual NamedValues sample(const std::vector<double>& low,
                               const std::vector<double>& high) const = 0;
    /// acceleration and timestep: tables of what acts on the particle of this id, and of what
    /// limits its timestep. All ranks call it; on those without the particle they are empty.
    virtual NamedValues force_terms(std::int64_t id) = 0;
    /// How many other particles are within support of each.
    virtual NamedValues neighbour_counts() const = 0;
    /// What this rank has spent beside its steps, what it has sent, how many particles it holds.
    virtual NamedValues shares() const = 0;

    /// The whole state as arrays in storage order.
    virtual NamedValues checkpoint() = 0;
    /// Names of those of its arrays that have one row for each particle.
    virtual std::vector<std::string> particle_arrays() const = 0;
    /// False where lists had to be made anew, because this module has clusters of another width
    /// (none: the state is that of several ranks).
    virtual bool restore(const NamedValues& arrays) = 0;
    /// The same on several ranks for a state that all of them have read.
    virtual void restore_shared(const NamedValues& arrays) = 0;

    virtual void time_phases(bool on) = 0;
    virtual NamedValues phase_seconds() = 0;
    /// Ordered pairs of different particles within support; fixed-fixed ones not counted.
    virtual double interacting_pairs() const = 0;
    /// Such pairs per second in both sums of one thread over clusters that stay in cache.
    virtual double bare_pair_rate(double seconds) const = 0;
};

/// Makes simulations of one dimension. Each announces itself.
class SimulationKind {
public:
    using Make = std::unique_ptr<AnySimulation>(const std::string& scheme,
                                                const std::string& precision,
                                                const std::vector<NamedValues>& materials,
                                                const NamedValues& options);

    SimulationKind(int dim, Make& make) : dim_(dim), make_(make) { all().push_back(this); }

    /// Throws std::invalid_argument where there is no such kind.
    static std::unique_ptr<AnySimulation> make(const std::string& scheme, int dim,
                                               const std::string& precision,
                                               const std::vector<NamedValues>& materials,
                                               const NamedValues& options) {
        for (const SimulationKind* kind : all())
            if (kind->dim_ == dim) return kind->make_(scheme, precision, materials, options);
        throw std::invalid_argument("no simulation in " + std::to_string(dim) + " dimensions");
    }

private:
    static std::vector<const SimulationKind*>& all() {
        static std::vector<const SimulationKind*> kinds;
        return kinds;
    }

    int dim_;
    Make& make_;
};

}  // namespace doseki
