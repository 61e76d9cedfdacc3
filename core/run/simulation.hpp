#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "base/array.hpp"
#include "bodies/steps/drain.hpp"
#include "boundaries/moving_walls.hpp"
#include "boundaries/open_boundaries.hpp"
#include "boundaries/terrain.hpp"
#include "run/account.hpp"
#include "run/any_scheme.hpp"
#include "run/diagnostics.hpp"
#include "run/failure.hpp"
#include "run/lists.hpp"
#include "run/settle_films.hpp"
#include "run/terrain_looks.hpp"

namespace doseki {

/// A run: right-hand side (the scheme, which has the state) and clock. Owned by Python, which says
/// until when to go on.
template <class Lists>
class Simulation {
public:
    static constexpr int D = Lists::dim;

    Simulation(std::unique_ptr<AnyScheme<Lists>> scheme, const Options<D>& options,
               const Domain<D>& domain)
        : scheme_(std::move(scheme)),
          particles(scheme_->particles()),
          bodies(domain, options.gravity, options.contact, contact_properties(materials()),
                 averaging_time(materials(), options), scheme_->pair_area()),
          options_(options),
          domain_(domain),
          lists_(*scheme_, domain, options.skin, options.auto_skin),
          terrain_looks_(terrain, lists_.halo().ranks) {
        for (const Material& material : materials()) sound_speed_ = max(sound_speed_, material.c0);
    }

private:
    std::unique_ptr<AnyScheme<Lists>> scheme_;

public:
    Particles<D>& particles;
    OpenBoundaries<D> open_boundaries;
    MovingWalls<D> moving_walls;
    Terrain<D> terrain;
    Bodies<D> bodies;

    /// Makes this one of several ranks. Every call that steps or sorts is then made by all of them.
    void join(Exchange& exchange) {
        ranks().join(&exchange);
        open_boundaries.adds = exchange.rank == 0;
        phases().restart(true);
    }

    /// Leaves a state to rank 0; the next sort sends particles to their owners.
    void leave_to_first_rank() {
        if (ranks().rank() == 0) return;
        resize(particles, 0), scheme_->forget_power();
        open_boundaries.forget(), account_ = {}, dissipation_ = 0.0, updates_ = 0;
    }

    /// Sets the clock [s] of a run that goes on from another; after the inflows, before the start.
    void begin_at(double time) {
        time_ = time;
        open_boundaries.begin_at(time);
    }

    /// Sorts, builds lists and evaluates the right-hand side. Call once, after the particles are
    /// in.
    void start() {
        leave_to_first_rank();  // others were filled for the sake of bodies
        for (std::size_t p = 0; p < particles.size(); ++p)
            if (particles.is_counted(p)) open_boundaries.ledger.initial += particles.mass[p];
        moving_walls.set_velocities(particles, time_);
        open_boundaries.inject(particles, time_);
        bodies.start(particles, moving_walls), bodies.set_velocities(particles, 0.0);
        remove_outflow(0.0);
        look_at_terrain();
        rebuild_lists(0.0);
        for (int n = 0; n < scheme_->first_evaluations(); ++n) evaluate(0.0);
        if (settle_films(*scheme_, lists_.lists(), lists_.halo())) evaluate(0.0);
    }

    /// Steps until `limit` (met exactly), or returns early at the first step at or past `pause`, or
    /// after `max_steps`.
    void advance(double limit, double pause, std::int64_t max_steps) {
        for (std::int64_t n = 0; n < max_steps && time_ < limit && time_ < pause; ++n) step(limit);
    }

    /// What acts on the particle of this id; nothing on ranks that do not have it. All ranks call
    /// it. Where a state was restored, the right-hand side is evaluated first.
    ForceTerms<D> force_terms(std::int64_t id) {
        if (evaluated_at_ != time_) evaluate(0.0);
        std::int64_t p = -1;
        for (std::size_t q = 0; q < particles.size(); ++q)
            if (particles.tag[q].id == id) p = static_cast<std::int64_t>(q);
        return scheme_->force_terms(lists_.lists(), lists_.halo(), p);
    }

    /// What must be kept for the run to go on as if it had not been interrupted.
    void serialise(Archive& archive) {
        archive("time", time_), archive("last_timestep", last_dt_), archive("steps", steps_);
        archive("updates", updates_), archive("av_dissipation", dissipation_);
        archive("moved_since_outflow", moved_since_outflow_);
        terrain_looks_.serialise(archive), archive("account", account_);
        lists_.serialise_wear(archive, steps_);
        particles.serialise(archive);
        if (archive.loads()) expect_particles();
        open_boundaries.serialise(archive);
        terrain.serialise(archive);
        if (archive.loads()) terrain.expect_groups(particles);
        bodies.serialise(archive, moving_walls);
        if (archive.loads()) bodies.expect_points(particles);
        scheme_->serialise(archive);
        lists_.serialise_lists(archive, particles);
    }

    /// Throws std::invalid_argument where restored lists are not those of clusters of this width.
    void expect_lists() const { lists_.expect_fit_of(particles); }

    /// Makes lists anew for a state that keeps its rates: only the order of sums changes.
    void renew_order() { rebuild_lists(0.0); }

    double time() const { return time_; }
    double last_timestep() const { return last_dt_; }
    double next_timestep() const { return min(scheme_->timestep(), bodies.timestep()); }
    /// By viscosity, of the particles of this rank, as are updates() and totals().
    double dissipation() const { return dissipation_; }
    const Account<D>& account() const { return account_; }
    std::int64_t steps() const { return steps_; }
    std::int64_t rebuilds() const { return lists_.rebuilds(); }
    /// Particles stepped, summed over the steps.
    std::int64_t updates() const { return updates_; }
    const auto& neighbours() const { return lists_.lists(); }
    AnyScheme<Lists>& scheme() const { return *scheme_; }
    const Options<D>& options() const { return options_; }
    PhaseTimer& phases() { return scheme_->phases(); }
    const Halo<D>& halo() const { return lists_.halo(); }
    /// Margin of the lists over the smallest support radius, as a fraction of it.
    double skin() const { return lists_.skin(); }

    Totals<D> totals() const {
        Totals<D> sum = doseki::totals(*scheme_);
        if (halo().ranks.rank() > 0) return sum;  // every rank has all bodies
        sum.kinetic_energy += bodies.kinetic_energy();
        sum.deformable = deformable_totals(bodies);
        return sum;
    }

    /// Bytes held per particle: state, records, lists.
    double bytes_per_particle() const {
        const std::size_t bytes = lists_.bytes() + scheme_->bytes() + scheme_->state_bytes();
        return static_cast<double>(bytes) /
               static_cast<double>(max<std::size_t>(1, particles.size()));
    }

private:
    /// Abort limits: Mach number, and dt relative to the acoustic dt at rest.
    static constexpr double max_mach = 10.0, min_relative_timestep = 1e-4;
    /// How far a particle goes, in supports, between two looks for what has left. When lists are
    /// built does not matter, for that follows the skin and the ranks.
    static constexpr double outflow_distance = 0.2;

    static auto contact_properties(const Array<Material>& materials) {
        Array<ContactProperties> contact;
        for (const Material& material : materials) contact.push_back(material.contact);
        return contact;
    }
    /// Several times what sound takes from one particle to the next.
    static double averaging_time(const Array<Material>& materials, const Options<D>& options) {
        double c = 0.0;
        for (const Material& material : materials)
            if (material.law == Law::fluid) c = max(c, material.c0);
        return c > 0.0 ? 5.0 * options.flow.dp / c : 0.0;
    }

    /// That the fields of a restored state fit one another and the materials and bodies of the run.
    void expect_particles() {
        const std::size_t n = particles.size(), walls = options_.flow.walls.size();
        for (const auto& [name, memory] : particles.fields()) expect_fit(memory->size() == n, name);
        for (const Tag& tag : particles.tag) {
            expect_index(tag.material, materials().size(), "material");
            expect_fit(tag.body >= 0, "body");
            if (walls > 0) expect_index(tag.body, walls, "body");
            expect_fit(tag.motion <= Motion::bound, "motion");
        }
    }

    const Array<Material>& materials() const { return scheme_->materials(); }
    /// The smallest step [s] that a run goes on with.
    double least_timestep() const {
        return min_relative_timestep * options_.cflnumber * lists_.min_support() /
               (scheme_->kernel_support() * sound_speed_);
    }
    Ranks& ranks() { return lists_.halo().ranks; }
    Array<double> supports() {
        return support_radii(particles, materials(), options_, scheme_->kernel_support());
    }

    auto pushes() { return scheme_->pushes(lists_.lists(), evaluated_at_ == time_); }
    template <class Work>
    void timed(Phase phase, const Work& work) {
        const auto timing = phases().measure(phase);
        work();
    }
    void step(double limit);
    void kick(double half_dt);
    double drift(double dt);
    double drift_bodies(double dt);
    double next_end(double limit, double longest) const;
    void update_lists(double before, double moved);
    void evaluate(double half_dt);

    /// After a step in which none has gone farther than `moved`: half a step back, no two were
    /// nearer by more than that.
    void rebuild_lists(double moved);
    bool look_at_terrain() {
        return terrain_looks_.look(
            particles, [this] { return supports(); }, open_boundaries.removed);
    }
    /// Bodies leave with the velocity that they have when the fluid has acted for `ahead` more.
    bool remove_outflow(double ahead);
    void drop_removed();
    [[noreturn]] void fail(FailureKind kind, std::int64_t p);

    Options<D> options_;
    Domain<D> domain_;
    RunLists<Lists> lists_;
    TerrainLooks<D> terrain_looks_;
    double time_ = 0.0, last_dt_ = 0.0, dissipation_ = 0.0;
    double evaluated_at_ = std::numeric_limits<double>::quiet_NaN();  // time [s]
    Account<D> account_;
    double moved_since_outflow_ = 0.0;  // the fastest of each step, summed [m]
    double sound_speed_ = 0.0;          // of the stiffest material at rest [m/s]
    std::int64_t steps_ = 0, updates_ = 0;
};

/// Kick, drift, kick. The velocities that the second evaluation sees are those predicted for the
/// end of the step.
template <class Lists>
void Simulation<Lists>::step(double limit) {
    const auto timing = ranks().clock.measure_step();
    constexpr double almost = 1.0 - 1e-12;  // a step that ends there would leave one of rounding
    const double before = time_, longest = next_timestep(), end = next_end(limit, longest),
                 dt = before + longest < almost * end ? longest : end - before,
                 power = scheme_->dissipated_power();
    bodies.loads.begin_step(particles, ranks(), pushes());
    kick(0.5 * dt);
    account_.add_forces(scheme_->wall_push(), scheme_->work(), 0.5 * dt);
    const double own_moved = drift(dt), moved = ranks().largest(own_moved);
    time_ = dt < end - before ? before + dt : end;
    if (moved > max_mach * sound_speed_ * dt)
        fail(FailureKind::speed, own_moved < moved ? -1 : fastest_particle(particles));
    open_boundaries.impose_velocity(particles, time_);
    update_lists(before, moved);
    evaluate(0.5 * dt);
    bodies.loads.end_step(particles, ranks(), pushes(), dt, time_);
    account_.add_evaluated(scheme_->wall_push(), scheme_->work(), 0.5 * dt);
    kick(0.5 * dt);
    scheme_->end_step();
    timed(Phase::bodies, [&] { bodies.set_velocities(particles, 0.0); });
    dissipation_ += 0.5 * dt * (power + scheme_->dissipated_power());
    last_dt_ = dt, ++steps_;
    updates_ += static_cast<std::int64_t>(particles.size());
}

template <class Lists>
void Simulation<Lists>::kick(double half_dt) {
    timed(Phase::integrate, [&] { scheme_->kick(half_dt); });
    timed(Phase::bodies, [&] { bodies.kick(half_dt); });
}

/// Returns the largest distance that a particle went.
template <class Lists>
double Simulation<Lists>::drift(double dt) {
    open_boundaries.planes.look(particles);
    const double of_bodies = drift_bodies(dt);
    const auto timing = phases().measure(Phase::integrate);
    open_boundaries.impose_mean_velocity(particles, time_, dt);
    account_.add_weight(scheme_->weight(), options_.gravity, dt);
    return max(max(scheme_->drift(dt), moving_walls.move(particles, time_, dt)), of_bodies);
}

/// The same of the particles of bodies, which also get the velocities of the way they went.
template <class Lists>
double Simulation<Lists>::drift_bodies(double dt) {
    const auto timing = phases().measure(Phase::bodies);
    const BodyStep<D> step = bodies.advance(moving_walls, time_, dt);  // the same on every rank
    if (ranks().rank() == 0) account_.add(step);
    return bodies.place(particles, dt);
}

/// A step ends there at the latest: at an event, or at the limit, where one just before it is, too.
template <class Lists>
double Simulation<Lists>::next_end(double limit, double longest) const {
    constexpr double at_once = 1e-6;  // steps
    const double inflow = open_boundaries.next_event(),
                 event = min(moving_walls.next_event(time_), inflow > time_ ? inflow : limit);
    return event < limit - at_once * min(longest, limit - time_) ? event : limit;
}

template <class Lists>
void Simulation<Lists>::update_lists(double before, double moved) {
    open_boundaries.planes.count(particles);
    const bool faces = bodies.take_new_faces(), worn = lists_.wear(particles, moved) || faces;
    const bool added = open_boundaries.inject(particles, time_);
    bool changed = moving_walls.remove(particles, before, time_, open_boundaries.removed) || added;
    moved_since_outflow_ += moved;
    if (moved_since_outflow_ >= outflow_distance * lists_.min_support()) {
        moved_since_outflow_ = 0.0;
        changed |= remove_outflow(0.5 * (time_ - before));
    }
    const bool looks = terrain_looks_.wear(moved, lists_.min_support());
    if (added || looks) changed |= look_at_terrain();
    if (changed || worn) rebuild_lists(moved);
}

template <class Lists>
void Simulation<Lists>::evaluate(double half_dt) {
    evaluated_at_ = time_;
    scheme_->advance_density(lists_.lists(), lists_.halo(), 2.0 * half_dt);
    moving_walls.set_velocities(particles, time_);
    timed(Phase::bodies, [&] { bodies.set_velocities(particles, half_dt); });
    scheme_->evaluate(lists_.lists(), lists_.halo(), half_dt, lists_.take_news());
    timed(Phase::bodies, [&] { bodies.gather(particles, ranks()); });
    if (const Fault& fault = scheme_->fault(); fault.rank != Fault::none)
        fail(fault.rank == Fault::density ? FailureKind::density : FailureKind::not_finite,
             fault.particle);
    if (scheme_->timestep() < least_timestep() &&
        ranks().largest(static_cast<double>(scheme_->limiting_particle())) >= 0.0)
        fail(FailureKind::timestep, scheme_->limiting_particle());
}

template <class Lists>
void Simulation<Lists>::rebuild_lists(double moved) {
    const std::int64_t lost = lost_particle(particles, domain_);
    if (ranks().largest(static_cast<double>(lost)) >= 0.0) fail(FailureKind::outside, lost);
    open_boundaries.planes.wrap(particles, domain_);
    bodies.loads.lose_members();
    lists_.cut_space(particles, phases());
    drop_removed();
    terrain_looks_.fill(particles, open_boundaries.next_id);
    const bool more_comes = std::isfinite(open_boundaries.next_event());
    if (!more_comes && ranks().sum(static_cast<double>(particles.size())) == 0.0)
        throw PhysicsFailure("no particle is left in the domain", FailureKind::empty);
    lists_.send_to_owners(particles);
    const auto supports = [this] { return this->supports(); };
    terrain_looks_.fetch(particles, supports);
    lists_.rebuild(particles, supports, scheme_->looks_back() ? moved : 0.0, steps_, phases());
}

/// True where any rank has particles that left.
template <class Lists>
bool Simulation<Lists>::remove_outflow(double ahead) {
    if (open_boundaries.outflows.empty() && !terrain.is_there()) return false;
    const Array<Vec<double, D>> way(particles.velocity.begin(), particles.velocity.end());
    bodies.set_velocities(particles, ahead);
    double elastic = 0.0;  // all ranks have all bodies
    open_boundaries.removed.resize(particles.size(), 0);
    if (terrain.is_there()) {
        elastic = bodies.drain(particles, terrain, open_boundaries.removed);
        open_boundaries.remove_fallen(particles, terrain);
    }
    auto leaves = [&](auto p) {
        return particles.is_free(p) && terrain.contains(particles.position[p]);
    };
    auto drain = [&](const auto& at, auto& left) { elastic += bodies.drain(particles, at, left); };
    const double any = open_boundaries.remove_outflow(particles, leaves, drain) ? 1.0 : 0.0;
    if (ranks().rank() == 0) open_boundaries.ledger.outflow.energy += elastic;
    std::copy(way.begin(), way.end(), particles.velocity.begin());
    return ranks().largest(any) > 0.0;
}

template <class Lists>
void Simulation<Lists>::drop_removed() {
    auto& removed = open_boundaries.removed;
    if (std::ranges::find(removed, 1) == removed.end()) return removed.clear();
    removed.resize(particles.size(), 0);
    Array<std::uint32_t> kept;
    for (std::uint32_t p = 0; p < particles.size(); ++p)
        if (!removed[p]) kept.push_back(p);
    if (kept.size() < particles.size()) reorder(particles, kept);
    removed.clear();
}

/// Throws the same on all ranks; `p` is -1 on those that have not the particle to blame.
template <class Lists>
void Simulation<Lists>::fail(FailureKind kind, std::int64_t p) {
    const FailureSite own = p < 0 ? FailureSite{} : site_of(particles, static_cast<std::size_t>(p));
    FailureSite site = first_site(ranks(), own);
    for (std::size_t a = 0; a < D; ++a) site.position[a] += options_.origin[static_cast<int>(a)];
    throw PhysicsFailure(described(site, D, time_, steps_ + 1, materials()), kind, site);
}

}  // namespace doseki
