#pragma once
#include <algorithm>
#include <cmath>

#include "base/array.hpp"
#include "bodies/contact_points.hpp"
#include "bodies/deformable/surfaces.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "bodies/fragments/dust.hpp"
#include "bodies/fragments/point_faces.hpp"
#include "bodies/fragments/rigid_motion.hpp"
#include "bodies/loads/flow_on_points.hpp"
#include "model/domain.hpp"
#include "model/particles.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// Cells of a 2-D body that may break, see Cells: how many corners each has, and these: points of
/// the body, then vertices of its surface.
struct BodyCells {
    Array<std::uint32_t> count, node;
};

/// What a division made of bodies.
template <int D>
struct Fragments {
    Array<std::int32_t> parent;  // deformable bodies that are new, by those they come from
    Array<DustGrain<D>> dust;
    Array<Array<Vec<double, D>>> dust_normals;  // of the points of each grain
    Array<std::int32_t> dust_parent;
    Array<std::uint8_t> divided;       // each body that was there
    Array<std::int32_t> vertex;        // new numbers of vertices of surfaces
    std::size_t first_contact_point;   // of surfaces before
    Array<std::int32_t> surface_body;  // of each of them
    double lost;  // energy of deformable bodies, that of dust among it [J], 2-D: [J/m]

    bool any() const { return !parent.empty() || !dust.empty(); }
};

/// A point as its particle shows it to the fluid.
template <int D>
struct ShownPoint {
    Vec<double, D> place, normal, area, acceleration, velocity;
    double depth;
};

/// Deformable bodies among water and other bodies: each of their points is a bound particle, which
/// the fluid meets as a wall, and their surfaces touch other bodies.
template <int D>
class DeformableBodies {
public:
    bool empty() const { return solids_.size() == 0; }
    /// Points of all bodies.
    std::size_t size() const { return solids_.size(); }

    /// Makes the particles `members`, with the faces that they have, the points of one body.
    /// Vertices of its surface are carried by points numbered within the body. Where it is to be
    /// rigid at first, `is_rigid`, the particles stay points of the rigid body that they are of.
    void add(Particles<D>& particles, const DeformableBody& body, std::int32_t material,
             std::span<const std::int32_t> members, const SolidPoints<D>& points,
             std::span<const SurfaceVertex<D>> surface, const BodyCells& cells, bool is_rigid) {
        const auto first = static_cast<std::uint32_t>(solids_.size()),
                   first_vertex = CellNode::outline | static_cast<std::uint32_t>(surfaces_.size()),
                   own = static_cast<std::uint32_t>(members.size());
        Array<std::uint32_t> nodes;
        for (const std::uint32_t node : cells.node)
            nodes.push_back(node < own ? first + node : first_vertex + (node - own));
        for (std::size_t cell = 0, at = 0; cell < cells.count.size(); at += cells.count[cell++])
            surfaces_.add_cell(std::span(nodes).subspan(at, cells.count[cell]));
        for (SurfaceVertex<D> vertex : surface) {
            vertex.point += static_cast<std::uint32_t>(solids_.size());
            surfaces_.add(vertex);
        }
        for (std::size_t k = 0; k < members.size(); ++k) {
            const auto p = static_cast<std::size_t>(members[k]);
            rigid_point_.push_back(is_rigid ? static_cast<std::int32_t>(particles.point(p)) : -1);
            if (!is_rigid) particles.set_point(p, BodyKind::deformable, solids_.size() + k);
            faces_.add(particles.wall, p);
        }
        solids_.add(body, points, is_rigid);
        material_.push_back(material), unwetted_.push_back(0.0);
        group_.push_back(
            members.empty() ? 0 : particles.tag[static_cast<std::size_t>(members[0])].body);
    }

    /// Share of its area that water around a body does not see, Eq. (152), also of one that is
    /// rigid where this is told.
    double unwetted(std::size_t body) const { return unwetted_[body]; }
    void set_unwetted(std::size_t body, double share) { unwetted_[body] = share; }
    /// Of each point: its number among those of rigid bodies, of which it is one while its body is
    /// rigid; -1: none.
    const Array<std::int32_t>& rigid_points() const { return rigid_point_; }
    /// The point that point p is of the rigid body that its body may become.
    void set_rigid_point(std::size_t p, std::size_t number) {
        rigid_point_[p] = static_cast<std::int32_t>(number);
    }
    /// The shape of a body that keeps the one it has, in the frame of `motion`; `shown`: its number
    /// among those that contacts have been shown.
    Shape<D> shape_of(const ContactBodies<D>& contact, std::int32_t shown, std::size_t body,
                      const RigidMotion<D>& motion) const {
        return surfaces_.shape_of(contact, shown, solids_, body, motion);
    }
    /// See TotalLagrangian; the fluid sees an acceleration from then on.
    void make_deformable(std::size_t body, const RigidPlacement<D>& placement,
                         const Vec<double, D>& acceleration) {
        solids_.make_deformable(body, placement);
        for (const std::uint32_t p : solids_.points_of(body))
            flow_force_[p] = sudden_[p] = owed_[p] = {}, acceleration_[p] = acceleration,
            before_[p] = solids_.v[p];
    }
    void make_rigid(std::size_t body, const RigidMotion<D>& motion, double kinetic) {
        solids_.make_rigid(body, motion, kinetic);
    }
    /// Bodies that have left, and the energy that they had beside that of motion [J], 2-D: [J/m].
    struct Leaving {
        Array<std::uint8_t> is_body;
        double energy = 0.0;

        bool any() const { return std::ranges::find(is_body, 1) != is_body.end(); }
    };
    /// Removes those whose centre is in the region, but what is clamped.
    template <class Region>
    Leaving remove_inside(const Region& region) {
        Leaving leaving;
        leaving.is_body.assign(bodies(), 0);
        const Array<RigidMotion<D>> motions = rigid_motions(solids_);
        for (std::size_t k = 0; k < bodies(); ++k) {
            if (!(motions[k].mass > 0.0) || !region.contains(motions[k].centre) ||
                solids_.is_clamped(k))
                continue;
            leaving.is_body[k] = 1, leaving.energy += solids_.take_out(k);
        }
        return leaving;
    }
    /// Numbers contacts as if no body had changed, for those that do not part.
    Fragments<D> as_they_are() const {
        Fragments<D> fragments{};
        fragments.first_contact_point = surfaces_.first_contact_point();
        fragments.surface_body = surfaces_.bodies(solids_);
        fragments.divided.assign(bodies(), 0);
        fragments.vertex = surfaces_.shown();
        return fragments;
    }
    /// Particle p, a point of a body that has changed, as a point of what it is now.
    void rebind(Particles<D>& particles, std::size_t p, const Array<std::int32_t>& of_rigid) const;
    /// Whether any body is deformable now.
    bool any_deforms() const { return solids_.stepped().any(); }
    std::size_t bodies() const { return solids_.bodies(); }
    /// Whether a body may come apart.
    bool breaks(std::size_t body) const { return solids_.breaks(body); }
    std::int32_t material(std::size_t body) const { return material_[body]; }
    /// The [body.NAME] of the scenario that a body belongs to.
    std::int32_t group(std::size_t body) const { return group_[body]; }
    /// With what cracks and damping took of them, and how many bonds bear no tension.
    const TotalLagrangian<D>& solids() const { return solids_; }
    std::int32_t body_of_point(std::size_t k) const { return solids_.body(k); }

    /// Whether parts may come off: the last push has broken bonds or ended broken ones, or some
    /// were pressed too hard before.
    bool has_cracked() const {
        return waits_ || solids_.bonds().change().broken > 0 || solids_.bonds().change().gone > 0;
    }
    /// Makes bodies of the parts of those that do not hold together any more, where there are any,
    /// in a step `dt` whose forces have acted.
    Fragments<D> divide(double dt, const PairArea& pair_area);
    /// Ends the bonds between points with different labels, in the order of adding; only bodies
    /// that may break have bonds.
    void cut(std::span<const std::int32_t> label);

    /// Call once, after all bodies are in.
    void start(Particles<D>& particles, const Vec<double, D>& gravity);
    /// Adds surfaces to those that may touch; `first_body` is the number of the first of these
    /// bodies among all bodies that do.
    void add_to(ContactBodies<D>& contact, std::int32_t first_body) {
        surfaces_.add_to(contact, first_body, solids_, material_);
    }

    bool has(const Particles<D>& particles, std::size_t p) const {
        return particles.is_point_of(p, BodyKind::deformable);
    }
    /// Cauchy stress of a particle, all nine components; in 2-D that along z keeps the strain
    /// plane.
    void stress(const Particles<D>& particles, std::size_t p, double* out) const;

    /// See Bodies. In deformable_particles.cpp, with what puts the particles where points are.
    void gather(const Particles<D>& particles, const Ranks& ranks);
    /// Half a step of the forces of the fluid.
    void kick(double half_dt) {
        solids_.push_by(flow_force_, half_dt), solids_.push_by(sudden_, -half_dt);
        for (const std::uint32_t p : solids_.stepped().points())
            owed_[p] = owed_[p] + half_dt * sudden_[p];
    }
    /// Begins a step of length dt after the first kick: what these forces have been so far acts all
    /// through it instead, so that only their changes kick, and of these the sudden ones do not.
    void begin_step(double dt) {
        before_.resize(size()), step_ = dt;
        for (const std::uint32_t p : solids_.stepped().points()) before_[p] = solids_.v[p];
        solids_.follow(flow_force_, 0.0);
        solids_.push_by(solids_.steady, -0.5 * dt);
        for (const std::uint32_t p : solids_.stepped().points())
            owed_[p] = (1.0 / dt) * owed_[p], solids_.steady[p] = solids_.steady[p] + owed_[p];
    }
    /// Ends it before the second kick. Averages accelerations, as the fluid sees them, over
    /// `memory`, and its forces over twice as long.
    void end_step(double dt, double memory);
    /// Shows the contacts where the points are, and takes their forces.
    void show(ContactBodies<D>& contact) const { surfaces_.show(contact, solids_); }
    /// Shows from now on only what these contact points may need, see DeformableSurfaces.
    void choose(const ContactBodies<D>& contact, std::span<const std::int32_t> touching) {
        surfaces_.choose(contact, touching);
    }
    void choose_all() { surfaces_.choose_all(); }
    void collect(ContactBodies<D>& contact) { surfaces_.collect(contact, solids_); }
    double place(Particles<D>& particles, const Domain<D>& domain, double dt);
    void set_velocities(Particles<D>& particles, double ahead);

    double drift(double dt) { return solids_.drift(dt); }
    BodyStep<D> push(double dt, const Vec<double, D>& gravity) { return solids_.push(dt, gravity); }
    /// The longest stable step, infinite without bodies [s].
    double timestep() const {
        return empty() ? std::numeric_limits<double>::infinity() : solids_.timestep();
    }
    /// The same of unstrained ones, also of those that are rigid [s].
    double unstrained_timestep() const {
        return empty() ? std::numeric_limits<double>::infinity() : solids_.unstrained_timestep();
    }
    double kinetic_energy() const { return solids_.kinetic_energy(); }
    ElasticEnergy elastic_energy() const { return solids_.elastic_energy(); }
    double max_speed() const {
        double square = 0.0;
        for (const std::uint32_t p : solids_.stepped().points())
            square = std::max(square, dot(solids_.v[p], solids_.v[p]));
        return std::sqrt(square);
    }
    /// Of the ball around a body [m].
    double radius(std::size_t body) const {
        return rigid_motion<D>(solids_, solids_.points_of(body)).radius;
    }
    /// The smallest of their points [m]; infinite without any.
    double smallest_radius() const {
        double smallest = std::numeric_limits<double>::infinity();
        for (const std::uint32_t p : solids_.stepped().points())
            smallest = std::min(smallest, 0.5 * solids_.body_of(p).spacing);
        return smallest;
    }

    void serialise(Archive& archive, const Vec<double, D>& gravity) {
        solids_.serialise(archive, gravity);
        surfaces_.serialise(archive, solids_);
        archive.nested("deformable_face_", faces_);
        archive("deformable_material", material_), archive("deformable_group", group_);
        archive("deformable_rigid_point", rigid_point_), archive("deformable_unwetted", unwetted_);
        archive("deformable_flow_force", flow_force_),
            archive("deformable_steady_force", solids_.steady),
            archive("deformable_acceleration", acceleration_);
        archive("deformable_sudden_force", sudden_), archive("deformable_owed", owed_);
        if (archive.loads()) {
            const std::size_t n = solids_.size();
            expect_fit(faces_.fit(n) && flow_force_.size() == n && solids_.steady.size() == n &&
                           sudden_.size() == n && owed_.size() == n && acceleration_.size() == n &&
                           rigid_point_.size() == n && material_.size() == solids_.bodies() &&
                           group_.size() == solids_.bodies() &&
                           unwetted_.size() == solids_.bodies(),
                       "deformable_face_normal");
        }
    }

    /// Of a point now: its normal, its area, and in rows the normals of the faces beside an edge.
    Vec<double, D> normal(std::size_t k) const { return turned(k, faces_.normal[k]); }
    Vec<double, D> area(std::size_t k) const { return turned(k, faces_.area[k]); }
    Mat<double, D> edge_normals(std::size_t k) const {
        return each_row(faces_.edge_normals[k], [&](const auto& n) { return turned(k, n); });
    }
    bool have_faces() const { return faces_.any(); }
    /// The surfaces as contacts have them.
    const DeformableSurfaces<D>& surfaces() const { return surfaces_; }

private:
    TotalLagrangian<D> solids_;
    Division division();
    void find_sudden_forces();
    void wet();
    Vec<double, D> seen_area(std::size_t k) const {
        return (1.0 - unwetted_[static_cast<std::size_t>(solids_.body(k))]) * area(k);
    }
    /// As the surface turns at a point.
    Vec<double, D> turned(std::size_t k, const Vec<double, D>& at_rest) const;

    PointFaces<D> faces_;
    Array<std::int32_t> rigid_point_;       // see rigid_points
    Array<std::int32_t> material_, group_;  // by body
    Array<double> unwetted_;                // the same
    Array<FlowOnPoint<D>> flow_;            // as it was last gathered
    Array<Vec<double, D>> flow_force_, acceleration_, before_;
    Array<Vec<double, D>> sudden_;  // of flow_force_, see SuddenForces
    Array<Vec<double, D>> owed_;    // impulse of it, within a step the force that gives it
    double step_ = 0.0;             // the last one [s]
    bool waits_ = true;             // a part for its pressure to go, as far as is known
    Array<ShownPoint<D>> shown_;
    DeformableSurfaces<D> surfaces_;
};

// Compiled once: deformable.cpp.
extern template class DeformableBodies<2>;
extern template class DeformableBodies<3>;

}  // namespace doseki
