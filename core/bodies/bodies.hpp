#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "bodies/body_energy.hpp"
#include "bodies/breakable/breakable_bodies.hpp"
#include "bodies/breakable/companions.hpp"
#include "bodies/contacts.hpp"
#include "bodies/deformable/deformable_bodies.hpp"
#include "bodies/fragments/origins.hpp"
#include "bodies/loads/load_meters.hpp"
#include "bodies/particles/rigid_particles.hpp"
#include "bodies/rigid_bodies.hpp"
#include "physics/wall.hpp"

namespace doseki {

/// Bodies that move on their own: rigid and deformable ones, and the contacts among them and with
/// walls. They are kicked by the fluid together with it; gravity and contacts, which are stiffer,
/// act in steps of their own within the drift.
template <int D>
class Bodies {
public:
    /// `memory`: time over which accelerations are averaged, as the fluid sees them [s].
    Bodies(const Domain<D>& domain, const Vec<double, D>& gravity, const ContactOptions& options,
           Array<ContactProperties> materials, double memory, const PairArea& pair_area)
        : gravity_(gravity),
          memory_(memory),
          pair_area_(pair_area),
          contacts_(domain, options, std::move(materials)) {}

    RigidBodies<D> rigid;
    DeformableBodies<D> deformable;
    LoadMeters<D> loads;  // on fixed ones

    bool empty() const { return rigid.size() == 0 && deformable.empty(); }
    bool any_moves() const { return rigid.any_moves() || !deformable.empty(); }
    const Contacts<D>& contacts() const { return contacts_; }

    /// Makes particle p, where it is now and with the normal that it has, a point of rigid body k.
    void bind(Particles<D>& particles, std::size_t p, std::size_t k) {
        rigid_particles_.bind(particles, p, rigid, k, contacts_.domain());
    }
    /// Index of the rigid body of a particle; -1: none.
    std::int32_t rigid_body_of(const Particles<D>& particles, std::size_t p) const {
        return rigid_particles_.body_of(particles, p);
    }

    /// Makes the last deformable body, which was added as rigid, what rigid body k becomes when it
    /// is struck.
    void make_breakable(std::size_t k) {
        breakable_.add(k, deformable.bodies() - 1, rigid.state(k));
    }
    /// Whether deformable body b has left, and no row of the rigid bodies says so.
    bool has_left(std::size_t b) const {
        const std::int32_t n = breakable_.of_deformable(b);
        return deformable.solids().has_left(b) &&
               (n < 0 || !breakable_[static_cast<std::size_t>(n)].has_rigid());
    }
    /// Whether rigid body k is deformable now.
    bool deforms(std::size_t k) const {
        const BreakableBody<D>* body = breakable_.of_rigid(k);
        return body && !deformable.solids().is_rigid(body->deformable);
    }

    /// Call once after everything is in.
    void start(Particles<D>& particles, const MovingWalls<D>& walls) {
        rigid.find_seams(walls.motions(), contacts_.domain());
        deformable.start(particles, gravity_);
        number_bodies();
        breakable_.measure_strengths(deformable);
        start_breakable();
        prepare_contacts(), find_contacts();
        rest_in_holders();
    }

    /// Where bodies come from, by their index of a kind.
    const Origins& rigid_origins() const { return rigid_origins_; }
    const Origins& deformable_origins() const { return deformable_origins_; }
    /// Number of the body of a particle, see Origin; -1: none.
    std::int32_t number_of(const Particles<D>& particles, std::size_t p) const {
        if (deformable.has(particles, p))
            return deformable_origins_[static_cast<std::size_t>(
                                           deformable.body_of_point(particles.point(p)))]
                .number;
        const std::int32_t k = rigid_body_of(particles, p);
        return k < 0 ? -1 : rigid_origins_[static_cast<std::size_t>(k)].number;
    }
    /// Eq. (127); 1 of dust.
    double damage(const Particles<D>& particles, std::size_t p) const {
        const auto& bonds = deformable.solids().bonds();
        if (deformable.has(particles, p)) return bonds.damage(particles.point(p));
        const std::int32_t k = rigid_body_of(particles, p);
        if (k < 0) return 0.0;
        const std::int32_t own = breakable_.deformable_point(particles.point(p));
        if (own >= 0) return bonds.damage(static_cast<std::size_t>(own));
        return is_dust(static_cast<std::size_t>(k)) ? 1.0 : 0.0;
    }

    /// Cuts deformable bodies at a time [s] between steps: points, in the order of adding, with
    /// different labels do not hold together any more.
    void cut(Particles<D>& particles, std::span<const std::int32_t> label, double time) {
        if (label.size() != deformable.size())
            throw std::invalid_argument("cut: one label for each point of deformable bodies");
        deformable.cut(label);
        part(time, 0.0, {});
        place(particles, 0.0);
    }

    /// Largest step that motion without a fluid may have.
    double timestep() const {
        if (!any_moves()) return std::numeric_limits<double>::infinity();
        if (breakable_.any())
            return std::min(max_contact_steps * contacts_.timestep(PairKind::slow),
                            breakable_.longest_look(deformable));
        return max_contact_steps * std::min(contacts_.timestep(PairKind::all), deformable_step_);
    }

    /// Takes over what the fluid does to the particles of bodies.
    void gather(const Particles<D>& particles, const Ranks& ranks) {
        if (!any_moves()) return;
        rigid_particles_.gather(particles, rigid, ranks);
        breakable_.feel_flow(rigid_particles_, rigid, deformable);
        deformable.gather(particles, ranks);
    }
    void kick(double half_dt) {
        if (!deformable.empty()) deformable.kick(half_dt);
        rigid.kick(half_dt);
    }
    /// From t to t + dt, through as many contact steps as it takes. Tells what that gave to bodies.
    BodyStep<D> advance(const MovingWalls<D>& walls, double t, double dt);
    /// Puts particles where their bodies are, with the velocity that has taken them there in `dt`;
    /// returns the largest distance that one went.
    double place(Particles<D>& particles, double dt) {
        if (!any_moves()) return 0.0;
        rebind(particles), bind_dust(particles);
        const double bent = deformable.place(particles, contacts_.domain(), dt);
        return std::max(bent, rigid_particles_.place(particles, rigid, contacts_.domain(), dt));
    }
    /// Whether lists know too few faces to meet one another: parts have got some.
    bool take_new_faces() { return std::exchange(new_faces_, false); }
    /// Gives particles the velocity that they have when the fluid will have acted for `ahead` more.
    void set_velocities(Particles<D>& particles, double ahead) {
        if (!any_moves()) return;
        deformable.set_velocities(particles, ahead);
        rigid_particles_.set_velocities(particles, rigid, ahead);
    }

    /// Removes the bodies whose centre is in the region and marks their particles in `removed`;
    /// returns the elastic energy that went with them [J], 2-D: [J/m].
    template <class Region>
    double drain(const Particles<D>& particles, const Region& region, Array<std::uint8_t>& removed);

    double kinetic_energy() const { return deformable.kinetic_energy() + rigid.kinetic_energy(); }
    /// Parts that came off bodies which broke: those that are deformable, and grains of dust.
    PartCounts parts() const {
        std::size_t dust = 0;
        for (std::size_t k = 0; k < rigid_origins_.size(); ++k) dust += is_dust(k);
        return {deformable_origins_.parts(), dust};
    }

    /// Where the energy is: velocities are those of now, forces those last evaluated.
    BodyEnergy energy() const {
        return {kinetic_energy(), deformable.elastic_energy().sum(), contacts_.stored_energy()};
    }

    void serialise(Archive& archive, const MovingWalls<D>& walls);
    /// Throws std::invalid_argument unless restored particles are points of these bodies.
    void expect_points(const Particles<D>& particles) const {
        if (!particles.wall.in_use) return;
        for (std::size_t p = 0; p < particles.size(); ++p) {
            if (particles.is_point_of(p, BodyKind::rigid))
                expect_index(particles.wall.point[p], rigid_particles_.size(), "point");
            else if (particles.is_point_of(p, BodyKind::deformable))
                expect_index(particles.wall.point[p], deformable.size(), "point");
        }
    }

private:
    /// Contact steps in one step of the run, where no fluid asks for shorter ones.
    static constexpr double max_contact_steps = 50.0;
    /// More in one step come of speeds or strains that have gone wrong.
    static constexpr double most_contact_steps = 1e6;

    template <class Region>
    double drain_deformable(const Particles<D>& particles, const Region& region,
                            Array<std::uint8_t>& removed);
    void number_bodies();
    /// Whether rigid body k is a grain of dust.
    bool is_dust(std::size_t k) const {
        return rigid_origins_[k].parent >= 0 && !breakable_.of_rigid(k);
    }
    std::int32_t number_of_deformable(std::size_t body) {
        const std::int32_t n = breakable_.of_deformable(body);
        if (n >= 0) return rigid_origins_[breakable_[static_cast<std::size_t>(n)].rigid].number;
        return deformable.breaks(body) ? numbers_++ : -1;
    }
    /// What came of parts that are bodies now: what dust brings to the rigid bodies, and the energy
    /// that was lost [J], 2-D: [J/m].
    struct Parted {
        BodySums<D> born;
        double work = 0.0;
    };
    /// A step of the run, as far as it has come.
    struct Course {
        BodySums<D> before;   // of rigid bodies at its start, with those that have become one since
        BodyStep<D> given{};  // to deformable bodies
        double half = 0.0;    // of the step, for which the fluid has kicked bodies in these sums
        // Times for which gravity and the fluid have acted on rigid bodies and on deformable ones.
        double on_rigid = 0.0, on_points = 0.0;
    };
    /// Makes bodies of parts that hold together no more, after the forces of a step `dt`.
    Parted part(double time, double dt, const Course& course);
    void add_dust(const DustGrain<D>& grain, const Array<Vec<double, D>>& normals,
                  const Origin& origin);
    void shrink_dust(std::size_t first);
    void divide_breakable(const Fragments<D>& fragments);
    /// `solids`: how many rigid bodies with surfaces there were before.
    void renumber_contacts(const Fragments<D>& fragments, std::size_t solids);
    void accept_overlaps(const Fragments<D>& fragments, std::size_t first_dust);
    void rest_in_holders();
    Array<std::int32_t> bodies_before(const Fragments<D>& fragments, std::size_t first_dust) const;
    /// Particles of what has become dust are points of rigid bodies from now on.
    void bind_dust(Particles<D>& particles);
    /// Particles of breakable bodies are points of what those are now.
    void rebind(Particles<D>& particles);

    void start_breakable() {
        if (!breakable_.any()) return;
        breakable_.start(rigid.size(), deformable);
        contacts_.tell_kinds_apart(static_cast<std::size_t>(rigid_at_start_));
    }
    /// In how many steps, none longer than `longest`, a time passes.
    static double steps_of(double time, double longest);
    void part_if_cracked(double time, double dt, Course& course) {
        if (!deformable.has_cracked()) return;
        const Parted parted = part(time, dt, course);
        course.before = course.before + parted.born;
        course.given.parting_work += parted.work;
    }
    /// In steps of all bodies.
    void advance_together(const MovingWalls<D>& walls, double t, double dt, Course& course);
    /// In steps of contacts of rigid bodies, within which deformable ones and what they may touch
    /// have steps of their own.
    void advance_apart(const MovingWalls<D>& walls, double t, double dt, Course& course);
    double step_apart(double shorter) const;
    void drift_apart(const MovingWalls<D>& walls, double t, double dt, Course& course);
    void step_at_once(const MovingWalls<D>& walls, double t, double dt, Course& course);
    void push_slow(double dt, Course& course);
    void push_fast(double t, double dt, Course& course);
    void push_deformable(double dt, Course& course);
    /// Forces of contacts of a kind; makes bodies deformable that are struck.
    void touch(PairKind kind, double dt, Course& course);
    void show(PairKind kind) {
        rigid.show(contact_, contacts_.points(kind));
        if (kind != PairKind::slow) deformable.show(contact_);
    }
    void make_deformable(const Array<std::size_t>& struck, Course& course);
    void make_rigid_again(double dt, Course& course);
    void make_rigid(std::size_t n, std::int32_t shown);
    void add_rigid(std::size_t n, const RigidMotion<D>& motion, std::int32_t shown);
    bool becomes_still(BreakableBody<D>& body, double dt);
    void change_breakable(const Array<std::size_t>& which, const Fragments<D>& before);
    /// Which rigid bodies move in the short steps: dust, and those that may touch what does.
    void find_companions();

    void prepare_contacts() {
        contact_ = {};
        rigid.add_to(contact_);
        for (std::size_t c = 0; c < contact_.points.size(); ++c)
            contact_.points.dust[c] = is_dust(static_cast<std::size_t>(contact_.points.body[c]));
        deformable.add_to(contact_, static_cast<std::int32_t>(rigid.size()));
        choose_margin();
        deformable_step_ = deformable.timestep();
        all_points_ = ShownPoints::all_of(contact_.points);
        show_bodies(all_points_);
    }
    void choose_margin();
    void show_bodies(const ShownPoints& points) {
        rigid.show(contact_, points);
        deformable.choose_all(), deformable.show(contact_);
    }
    /// Looks for contacts that a step would meet; returns whether it had to.
    bool look_ahead(double step);
    void find_contacts() {
        moved_ = 0.0, companions_.count_anew();
        contacts_.find(contact_, margin_);
        deformable.choose(contact_, contacts_.points_of_deformable());
        find_companions();
    }
    /// Also short against the smallest bodies, at the speed of now and in a fall from rest.
    double contact_step() const { return std::min(longest_step(PairKind::all), deformable_step_); }
    void measure_speed() {
        speed_ = std::max({deformable.max_speed(), rigid.max_speed(), wall_speed_});
    }
    /// The same of contacts of a kind alone.
    double longest_step(PairKind kind) const {
        const double pull = norm(gravity_);
        return std::min({contacts_.timestep(kind), longest_way_ / std::max(speed_, 1e-300),
                         std::sqrt(longest_way_ / std::max(pull, 1e-300))});
    }
    /// That of what is deformable and of dust, and of what that may strike.
    double shorter_step() const {
        if (companions_.none() && !deformable.any_deforms())
            return std::numeric_limits<double>::infinity();
        return std::min(
            {longest_step(PairKind::fast), deformable_step_, deformable.unstrained_timestep()});
    }
    /// Of the ball around a body, as contacts number them [m].
    double radius_of(std::size_t k) const {
        return k < rigid.size() ? rigid.shape(k).radius : deformable.radius(k - rigid.size());
    }
    /// Contacts that have pressed on fixed bodies for dt.
    void add_loads(PairKind kind, double dt) {
        if (loads.empty()) return;
        contacts_.for_each_push(
            contact_, kind,
            [&](std::int32_t on, std::int32_t by, const Vec<double, D>& place,
                const Vec<double, D>& force, const Vec3& moment, double approach) {
                const auto k = static_cast<std::size_t>(on), other = static_cast<std::size_t>(by);
                if (k >= rigid.size() || !rigid.body(k).fixed) return;
                const Hit hit{approach, approach > 0.0 ? radius_of(other) : 0.0};
                loads.add_contact(rigid.body(k).group, {place, force, moment}, hit, dt);
            });
    }
    void drift(const MovingWalls<D>& walls, double t, double dt);
    void follow_walls(const MovingWalls<D>& walls, double t, double dt);

    Vec<double, D> gravity_;
    double memory_;
    PairArea pair_area_;
    Contacts<D> contacts_;
    BreakableBodies<D> breakable_;
    Companions companions_;
    bool rebinds_ = false;    // whether bodies have changed since place()
    bool new_faces_ = false;  // whether parts have got some since take_new_faces()
    RigidParticles<D> rigid_particles_;
    Origins rigid_origins_, deformable_origins_;
    std::int32_t numbers_ = 0;                        // of bodies, given so far
    std::int32_t rigid_at_start_ = 0;                 // how many
    std::map<std::size_t, std::size_t> dust_points_;  // of deformable bodies: points of rigid ones
    ContactBodies<D> contact_;  // the bodies as contacts see them: rigid ones, then deformable ones
    ShownPoints all_points_;
    double wall_speed_ = 0.0, speed_ = 0.0;  // of fixed bodies that move, and of all
    double moved_ = 0.0;        // bound on the distance gone since contacts were looked for
    double margin_ = 0.0;       // twice the distance after which they are looked for again
    double longest_way_ = 0.0;  // in a step, after which no overlap is deep at once
    double deformable_step_ = std::numeric_limits<double>::infinity();  // stable [s]
};

template <int D>
void Bodies<D>::serialise(Archive& archive, const MovingWalls<D>& walls) {
    rigid.serialise(archive), rigid_particles_.serialise(archive);
    archive("bodies_moved", moved_);
    deformable.serialise(archive, gravity_);
    breakable_.serialise(archive);
    contacts_.serialise(archive);
    loads.serialise(archive);
    archive.nested("rigid_origin_", rigid_origins_);
    archive.nested("deformable_origin_", deformable_origins_);
    archive("body_numbers", numbers_), archive("bodies_at_start", rigid_at_start_);
    if (archive.loads()) {
        dust_points_.clear(), rebinds_ = new_faces_ = false,
                              companions_ = {};  // of the state that was there
        expect_fit(rigid_origins_.size() == rigid.size() &&
                       deformable_origins_.size() == deformable.bodies(),
                   "body_numbers");
        expect_fit(
            rigid_at_start_ >= 0 && static_cast<std::size_t>(rigid_at_start_) <= rigid.size(),
            "bodies_at_start");
        rigid_particles_.expect_points_of(rigid.size());
        breakable_.expect_bodies_of(rigid.size(), deformable, rigid_particles_.size());
        start_breakable();
        rigid.find_seams(walls.motions(), contacts_.domain());
        prepare_contacts();
        contacts_.restore(contact_);
        deformable.choose(contact_, contacts_.points_of_deformable());
        find_companions();
    }
}

// Compiled once: bodies.cpp.
extern template class Bodies<2>;
extern template class Bodies<3>;

}  // namespace doseki
