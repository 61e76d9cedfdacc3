#pragma once
#include <cmath>
#include <numeric>
#include <string>

#include <omp.h>

#include "bodies/bodies.hpp"
#include "diagnostics.hpp"
#include "domain.hpp"
#include "halo.hpp"
#include "integrate.hpp"
#include "rates.hpp"
#include "skin.hpp"
#include "sources.hpp"
#include "walls.hpp"

namespace doseki {

/// A run: state, right-hand side (the scheme) and clock. Owned by Python, which says until when to
/// go on.
template <class Scheme>
class Simulation {
public:
    static constexpr int D = Scheme::dim;
    static constexpr int width = lanes<typename Scheme::Real>;

    Simulation(std::vector<Material> materials, const Options<D>& options, const Domain<D>& domain)
        : bodies(domain, options.gravity, options.contact, surfaces_of(materials),
                 memory_of(materials, options)),
          options_(options),
          domain_(domain),
          neighbours_(domain),
          halo_(domain),
          rates_(std::move(materials), options, domain.any_periodic()) {
        particles.has_strength = false;
        particles.has_flow = Scheme::has_flow;
        for (const Material& material : rates_.materials()) {
            sound_speed_ = max(sound_speed_, material.c0);
            particles.has_strength |= !Scheme::has_flow && material.shear_modulus > 0.0;
        }
    }

    Particles<D> particles;
    Sources<D> sources;
    Walls<D> walls;
    Bodies<D> bodies;

    /// Makes this one of several ranks. Every call that steps or sorts is then made by all of them.
    void join(Exchange& exchange) {
        halo_.ranks.join(&exchange);
        sources.adds = exchange.rank == 0;
        phases().restart(true);
    }

    /// Leaves a restored state to rank 0; the next sort sends particles to their owners.
    void leave_to_first_rank() {
        if (halo_.ranks.rank() == 0) return;
        particles.resize(0);
        sources.ledger = {}, av_dissipation_ = 0.0, updates_ = 0;
    }

    /// Sorts, builds lists and takes the first rates. Call once, after the particles are in.
    void start() {
        if (halo_.ranks.rank() > 0) particles.resize(0);  // was filled for the sake of bodies
        for (std::size_t p = 0; p < particles.size(); ++p)
            if (particles.is_counted(p)) sources.ledger.initial += particles.mass[p];
        walls.set_velocities(particles, time_);
        sources.feed(particles, time_);
        bodies.start(particles);
        bodies.set_velocities(particles, 0.0);
        rebuild_neighbours();
        first_rates();
    }

    /// Steps until `limit` (met exactly), or returns early at the first step at or past `pause`, or
    /// after `max_steps`.
    void advance(double limit, double pause, std::int64_t max_steps) {
        for (std::int64_t n = 0; n < max_steps && time_ < limit && time_ < pause; ++n) step(limit);
    }

    /// What must be kept for the run to go on as if it had not been interrupted.
    template <class Archive>
    void serialise(Archive& archive) {
        archive("time", time_), archive("last_timestep", last_dt_), archive("steps", steps_);
        archive("rebuilds", rebuilds_), archive("updates", updates_);
        archive("av_dissipation", av_dissipation_);
        archive("moved", moved_), archive("skin_width", skin_width_), archive("skin", skin_),
            archive("rebuild_step", rebuild_step_), archive("least_timestep", least_timestep_);
        particles.serialise(archive);
        sources.serialise(archive);
        bodies.serialise(archive);
        rates_.serialise(archive);
        neighbours_.serialise(archive);
        neighbours_.set_size(particles.size());
    }

    /// Makes lists anew, for a state that was saved with clusters of another width. The run goes on
    /// with sums in another order.
    void renew_lists() {
        rebuild_neighbours();
        first_rates();
    }

    /// The same for a state that keeps its rates: only the order of sums changes.
    void renew_order() { rebuild_neighbours(); }

    double time() const { return time_; }
    double last_timestep() const { return last_dt_; }
    double next_timestep() const { return min(rates_.timestep(), bodies.timestep()); }
    /// Of the particles of this rank, as are updates() and totals().
    double av_dissipation() const { return av_dissipation_; }
    std::int64_t steps() const { return steps_; }
    std::int64_t rebuilds() const { return rebuilds_; }
    /// Particles stepped, summed over the steps.
    std::int64_t updates() const { return updates_; }
    const Neighbours<D>& neighbours() const { return neighbours_; }
    const Scheme& rates() const { return rates_; }
    const Options<D>& options() const { return options_; }
    PhaseTimer& phases() { return rates_.phases(); }
    const Halo<D>& halo() const { return halo_; }
    /// Margin of the lists over the smallest support radius, as a fraction of it.
    double skin() const { return skin_; }

    Totals<D> totals() const {
        Totals<D> sum = doseki::totals(particles, rates_);
        if (halo_.ranks.rank() > 0) return sum;  // every rank has all bodies
        sum.kinetic_energy += bodies.kinetic_energy();
        sum.shear_energy += bodies.deformable.elastic.strain_energy();
        return sum;
    }

    /// Bytes held per particle: state, records, lists.
    double bytes_per_particle() const;

private:
    static std::vector<Surface> surfaces_of(const std::vector<Material>& materials) {
        std::vector<Surface> surfaces;
        for (const Material& material : materials) surfaces.push_back(material.surface);
        return surfaces;
    }
    /// Several times what sound takes from one particle to the next.
    static double memory_of(const std::vector<Material>& materials, const Options<D>& options) {
        double c = 0.0;
        for (const Material& material : materials)
            if (material.law == Law::fluid) c = max(c, material.c0);
        return c > 0.0 ? 5.0 * options.flow.dp / c : 0.0;
    }
    void step(double limit);
    void kick(double half_dt);
    double drift(double dt);
    double cheapest_skin(double smallest_support) const;
    double next_event() const;
    void update_neighbours(double before, double moved);
    void rebuild_neighbours();
    void build_lists();
    void build_lists_with_ghosts();
    std::vector<std::uint8_t> fixed_ones() const;
    void cut_space();
    void update_rates(double half_dt);
    /// Twice where a pass reads what the one before has left.
    void first_rates() {
        update_rates(0.0);
        if (Scheme::has_flow) update_rates(0.0);
    }
    void wrap_positions();
    void drop_removed();
    std::vector<double> support_radii() const;
    void check_positions() const;
    std::int64_t fastest_particle() const;
    std::string described(std::int64_t p) const;
    [[noreturn]] void report_failure(const char* kind, std::int64_t p) const;

    /// Beyond these nothing is believed: speeds over the largest sound speed, timesteps over the
    /// one that matter at rest allows.
    static constexpr double largest_mach = 10.0, smallest_timestep = 1e-4;

    Options<D> options_;
    Domain<D> domain_;
    Neighbours<D> neighbours_;
    Halo<D> halo_;
    Scheme rates_;
    double time_ = 0.0, last_dt_ = 0.0;
    double av_dissipation_ = 0.0;
    double moved_ = 0.0;           // since the lists were built
    double skin_ = 0.0;            // of the smallest support radius
    double skin_width_ = 0.0;      // [m]
    double sound_speed_ = 0.0;     // of the stiffest material at rest [m/s]
    double least_timestep_ = 0.0;  // [s]
    std::int64_t steps_ = 0, rebuilds_ = 0, updates_ = 0;
    std::int64_t rebuild_step_ = 0;  // when the lists were built
    bool new_lists_ = false;         // since the last rates
    double cut_busy_ = 0.0;          // of the clock, when it was last asked whether to cut [s]
};

template <class Scheme>
void Simulation<Scheme>::step(double limit) {
    const auto timing = halo_.ranks.clock.measure_total();
    const double before = time_, end = min(limit, next_event());
    const double dt = min(next_timestep(), end - time_), old_power = rates_.av_power();
    kick(0.5 * dt);
    const double own_moved = drift(dt), moved = halo_.ranks.largest(own_moved);
    time_ = dt < end - time_ ? time_ + dt : end;
    if (moved > largest_mach * sound_speed_ * dt)
        report_failure("speed", own_moved < moved ? -1 : fastest_particle());
    walls.set_velocities(particles, time_);
    bodies.set_velocities(particles, 0.5 * dt);
    sources.settle(particles, time_);
    update_neighbours(before, moved);
    update_rates(0.5 * dt);
    kick(0.5 * dt);
    if constexpr (!Scheme::has_flow) rates_.yield(particles);
    bodies.set_velocities(particles, 0.0);
    av_dissipation_ += 0.5 * dt * (old_power + rates_.av_power());
    last_dt_ = dt;
    ++steps_;
    updates_ += static_cast<std::int64_t>(particles.size());
}

template <class Scheme>
void Simulation<Scheme>::kick(double half_dt) {
    const auto timing = phases().measure(Phase::integrate);
    doseki::kick(particles, half_dt);
    bodies.kick(half_dt);
}

template <class Scheme>
double Simulation<Scheme>::drift(double dt) {
    const auto timing = phases().measure(Phase::integrate);
    sources.drive(particles, time_, dt);
    bodies.advance(walls, time_, dt);
    return max(max(doseki::drift(particles, dt), walls.move(particles, time_, dt)),
               bodies.place(particles));
}

/// The next time that a step must meet exactly.
template <class Scheme>
double Simulation<Scheme>::next_event() const {
    const double source = sources.next_event();
    return min(walls.next_event(time_),
               source > time_ ? source : std::numeric_limits<double>::infinity());
}

/// From what the lists that end now have lasted.
template <class Scheme>
double Simulation<Scheme>::cheapest_skin(double smallest_support) const {
    const std::int64_t lasted = steps_ - rebuild_step_;
    if (!options_.auto_skin || skin_ == 0.0) return options_.skin;
    if (lasted == 0) return skin_;
    return CheapestSkin<D>::at(moved_ / (static_cast<double>(lasted) * smallest_support));
}

/// Lists hold as long as no two particles can have come nearer by more than the skin.
template <class Scheme>
void Simulation<Scheme>::update_neighbours(double before, double moved) {
    moved_ += moved;
    bool changed = sources.feed(particles, time_);
    changed |= walls.remove(particles, before, time_, sources.removed);
    if (changed || !(2.0 * moved_ < skin_width_)) rebuild_neighbours();
}

template <class Scheme>
void Simulation<Scheme>::rebuild_neighbours() {
    check_positions();
    wrap_positions();
    sources.drain(particles, bodies);
    cut_space();
    drop_removed();
    if (halo_.ranks.sum(static_cast<double>(particles.size())) == 0.0)
        throw PhysicsFailure("no particle is left in the domain", "empty", -1);
    if (!halo_.alone()) {
        const auto timing = halo_.ranks.clock.measure(Share::migrate);
        migrate(particles, halo_.ranks.exchange());
    }
    build_lists();
    moved_ = 0.0;
    new_lists_ = true;
    ++rebuilds_;
    rebuild_step_ = steps_;
}

/// Space is cut anew where that pays.
template <class Scheme>
void Simulation<Scheme>::cut_space() {
    if (halo_.alone()) return;
    const auto timing = halo_.ranks.clock.measure(Share::balance);
    Exchange& exchange = halo_.ranks.exchange();
    const double busy = halo_.ranks.clock.busy() - cut_busy_;
    cut_busy_ += busy;
    if (!exchange.wants_cuts(busy)) return;
    std::vector<std::uint32_t> everyone(particles.size());
    std::iota(everyone.begin(), everyone.end(), 0u);
    const auto costs =
        particle_costs(neighbours_.clusters(), width, neighbours_.moving(), particles.size(),
                       phases(), omp_get_max_threads(), Scheme::has_flow);
    exchange.cut(coordinates_of(particles, everyone), costs);
    phases().restart(true);
}

template <class Scheme>
void Simulation<Scheme>::build_lists() {
    std::vector<std::uint8_t> fixed = fixed_ones();
    const auto support = support_radii();
    const double own_support = support.empty() ? std::numeric_limits<double>::max()
                                               : *std::min_element(support.begin(), support.end());
    const double least_support = halo_.ranks.least(own_support);
    skin_ = cheapest_skin(least_support);
    skin_width_ = skin_ * least_support;
    least_timestep_ = smallest_timestep * options_.cflnumber * least_support /
                      (rates_.kernel_support() * sound_speed_);
    if (!halo_.alone()) {
        const auto timing = halo_.ranks.clock.measure(Share::halo);
        halo_.find_exports(particles.position, support, fixed, skin_width_);
    }
    {
        const auto timing = phases().measure(Phase::sort);
        const auto order = neighbours_.sort(particles.position, support, fixed, halo_.exported());
        particles.reorder(order);
        halo_.renumber(order);
    }
    if (halo_.alone()) {
        const auto timing = phases().measure(Phase::list_build);
        neighbours_.template build<width>(particles.position, support_radii(), skin_width_);
        return;
    }
    build_lists_with_ghosts();
}

template <class Scheme>
void Simulation<Scheme>::build_lists_with_ghosts() {
    std::vector<Vec<double, D>> position = particles.position;
    std::vector<double> support = support_radii();
    std::vector<std::uint32_t> order;
    {
        const auto timing = halo_.ranks.clock.measure(Share::halo);
        const auto ghosts = halo_.announce(position, support, fixed_ones());
        order = neighbours_.sort_ghosts(ghosts.position, ghosts.support, ghosts.is_fixed);
        halo_.place(order, position.size());
        for (const std::uint32_t k : order)
            position.push_back(ghosts.position[k]), support.push_back(ghosts.support[k]);
    }
    const auto timing = phases().measure(Phase::list_build);
    neighbours_.template build<width>(position, support, skin_width_);
}

template <class Scheme>
std::vector<std::uint8_t> Simulation<Scheme>::fixed_ones() const {
    std::vector<std::uint8_t> fixed(particles.size());
    for (std::size_t p = 0; p < particles.size(); ++p) fixed[p] = particles.is_wall(p);
    return fixed;
}

template <class Scheme>
void Simulation<Scheme>::drop_removed() {
    std::vector<std::uint32_t> kept;
    for (std::uint32_t p = 0; p < particles.size(); ++p)
        if (!sources.removed[p]) kept.push_back(p);
    if (kept.size() < particles.size()) particles.reorder(kept);
    sources.removed.clear();
}

template <class Scheme>
std::vector<double> Simulation<Scheme>::support_radii() const {
    std::vector<double> support(particles.size());
    const bool grows = options_.h_mode == SmoothingLengthMode::eq10;
    for (std::size_t p = 0; p < support.size(); ++p) {
        double h = particles.smoothing_length[p];
        if (grows) {
            const double rho0 = rates_.materials()[particles.tag[p].material].rho0;
            h = max(h, 1.25 * options_.eta * std::pow(particles.mass[p] / rho0, 1.0 / D));
        }
        support[p] = rates_.kernel_support() * h;
    }
    return support;
}

template <class Scheme>
void Simulation<Scheme>::wrap_positions() {
    for (int a = 0; a < D; ++a) {
        if (!domain_.periodic[a]) continue;
        const double length = domain_.length(a);
        for (auto& x : particles.position)
            x[a] -= length * std::floor((x[a] - domain_.low[a]) / length);
    }
}

template <class Scheme>
void Simulation<Scheme>::update_rates(double half_dt) {
    rates_.compute(particles, neighbours_, halo_, half_dt, new_lists_);
    new_lists_ = false;
    bodies.gather(particles, halo_.ranks);
    if (const Fault& fault = rates_.fault(); fault.rank != Fault::none)
        report_failure(fault.rank == Fault::density ? "density" : "not_finite", fault.particle);
    if (rates_.timestep() < least_timestep_ &&
        halo_.ranks.largest(static_cast<double>(rates_.limiting_particle())) >= 0.0)
        report_failure("timestep", rates_.limiting_particle());
}

/// No particle may be lost: outside the world, or a whole box away from a domain that is given.
template <class Scheme>
void Simulation<Scheme>::check_positions() const {
    std::int64_t outside = -1;
    for (std::size_t p = 0; p < particles.size() && outside < 0; ++p)
        for (int a = 0; a < D; ++a) {
            const double x = particles.position[p][a], length = domain_.length(a);
            const bool bounded = !domain_.periodic[a] && length > 0.0;
            const bool strayed =
                bounded && (x < domain_.low[a] - length || x > domain_.high[a] + length);
            if (!(std::abs(x) < 1e9) || strayed) outside = static_cast<std::int64_t>(p);
        }
    if (halo_.ranks.largest(static_cast<double>(outside)) >= 0.0)
        report_failure("outside", outside);
}

template <class Scheme>
std::int64_t Simulation<Scheme>::fastest_particle() const {
    std::size_t fastest = 0;
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (dot(particles.velocity[p], particles.velocity[p]) >
            dot(particles.velocity[fastest], particles.velocity[fastest]))
            fastest = p;
    return particles.size() > 0 ? static_cast<std::int64_t>(fastest) : -1;
}

template <class Scheme>
std::string Simulation<Scheme>::described(std::int64_t p) const {
    if (p < 0) return "";
    const auto k = static_cast<std::size_t>(p);
    const Tag& tag = particles.tag[k];
    const Material& material = rates_.materials()[tag.material];
    auto text = [](double value) {
        char buffer[32];
        std::snprintf(buffer, sizeof buffer, "%.6g", value);
        return std::string(buffer);
    };
    std::string where;
    for (int a = 0; a < D; ++a) where += (a ? ", " : "") + text(particles.position[k][a]);
    const double speed = sqrt(dot(particles.velocity[k], particles.velocity[k]));
    return std::to_string(tag.id) + " at t = " + text(time_) + " s, step " +
           std::to_string(steps_ + 1) + ": particle " + std::to_string(tag.id) + " (" +
           material.name + ") at (" + where + ") m has speed " + text(speed) + " m/s, density " +
           text(particles.density[k]) + " kg/m^3 (at rest " + text(material.rho0) + ")";
}

/// Throws the same on all ranks; `p` is -1 on those that have not the particle to blame.
template <class Scheme>
void Simulation<Scheme>::report_failure(const char* kind, std::int64_t p) const {
    const std::string said = halo_.ranks.first_said(described(p));
    const std::size_t id_end = said.find(' ');
    throw PhysicsFailure(said.substr(id_end + 1), kind, std::stoll(said.substr(0, id_end)));
}

template <class Scheme>
double Simulation<Scheme>::bytes_per_particle() const {
    std::size_t bytes = neighbours_.bytes() + rates_.bytes();
    auto& fields = const_cast<Particles<D>&>(particles);
    fields.for_each_field(
        [&bytes](const auto& field) { bytes += field.capacity() * sizeof(field[0]); });
    return static_cast<double>(bytes) / static_cast<double>(max<std::size_t>(1, particles.size()));
}

}  // namespace doseki
