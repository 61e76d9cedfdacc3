#pragma once
#include <cmath>
#include <limits>
#include <string>

#include "base/array.hpp"
#include "base/error.hpp"
#include "boundaries/counting_planes.hpp"
#include "boundaries/speed_table.hpp"
#include "model/particles.hpp"

namespace doseki {

/// A number in (-1, 1) that depends on its arguments alone, so that a run can be repeated and
/// resumed (the finaliser of SplitMix64, Steele et al. 2014).
inline double symmetric_noise(std::int64_t id, int axis) {
    auto z =
        static_cast<std::uint64_t>(id) * 4 + static_cast<std::uint64_t>(axis) + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return static_cast<double>(static_cast<std::int64_t>(z)) * 0x1p-63;
}

/// An inflow section: layers of particles, dp apart, pushed through it at a prescribed speed.
/// Behind the section a buffer of driven layers carries the flow's pressure upstream; a layer that
/// has crossed the section is set free and a new one joins at the back. The rate is therefore exact
/// to one layer.
template <int D>
struct Inflow {
    Array<Vec<double, D>> layer;  // positions of one layer in the plane of the section
    Vec<double, D> direction{};   // unit vector of the flow
    SpeedTable speed;             // from the start of the inflow to its end
    double spacing = 0.0;         // between layers [m]
    int buffer_layers = 4;
    double jitter = 0.0;  // random displacement of a particle, in spacings (< 1/2)
    double mass = 0.0, density = 0.0, smoothing_length = 0.0;  // of one particle
    std::int16_t material = 0;
    std::int32_t body = 0;
    // Of a flow that rises and falls: its heights from which a layer has each point, and those at
    // the times of `speed` [m]. Empty: every layer is whole.
    Array<double> row_height, thickness;

    // State: layers set free so far, and whether the buffer exists.
    std::int64_t released = 0;
    bool open = false, closed = false;

    double mass_per_layer() const { return mass * static_cast<double>(layer.size()); }
    /// The height of the flow as layer k crosses the section.
    double height_of_layer(std::int64_t k) const {
        if (thickness.empty()) return std::numeric_limits<double>::infinity();
        return speed.value_at(thickness, speed.time_at((static_cast<double>(k) + 0.5) * spacing));
    }
    bool has_row(std::size_t row, double height) const {
        return thickness.empty() || row_height[row] < height;
    }
    std::size_t rows_below(double height) const {
        std::size_t count = 0;
        for (std::size_t row = 0; row < layer.size(); ++row) count += has_row(row, height);
        return count;
    }
    double mass_of_layer(std::int64_t k) const {
        return mass * static_cast<double>(rows_below(height_of_layer(k)));
    }
    /// Mass that was to enter until time t, which does not go back.
    double requested_mass(double t) {
        const double gone = speed.distance_at(t);
        if (thickness.empty()) return mass_per_layer() * gone / spacing;
        const double layers = gone / spacing;
        while (static_cast<double>(counted_ + 1) <= layers)
            counted_mass_ += mass_of_layer(counted_), ++counted_;
        return counted_mass_ + (layers - static_cast<double>(counted_)) * mass_of_layer(counted_);
    }

    /// The next time at which particles appear, are set free or vanish.
    double next_event() const {
        if (closed) return std::numeric_limits<double>::infinity();
        if (!open) return speed.start();
        const double layers = static_cast<double>(released) + 0.5 - rounding;
        return min(speed.stop(), speed.time_at(layers * spacing));
    }

    void serialise(Archive& archive) {
        archive("inflow_released", released), archive("inflow_open", open),
            archive("inflow_closed", closed);
        if (archive.loads()) expect_fit(released >= 0, "inflow_released");
    }

    /// Stands where it would at time t had it been there from the start; before it has opened.
    void begin_at(double t) {
        const double until = min(t, speed.stop());
        while (has_crossed(released, until)) ++released;
        open = closed = t >= speed.stop();
    }

    /// Distance of layer k beyond the section at time t (< 0: still in the buffer).
    double advance(std::int64_t k, double t) const {
        return speed.distance_at(t) - (static_cast<double>(k) + 0.5) * spacing;
    }
    bool has_crossed(std::int64_t k, double t) const {
        return advance(k, t) >= -2.0 * rounding * spacing;
    }
    /// Whether something happens at time t. Steps end at next_event(), to rounding.
    bool is_due(double t) const {
        if (closed || !open || t >= speed.stop()) return t >= next_event();
        return has_crossed(released, t);
    }

    // Spacings. Of a layer that is due at the very time of a step, as steps and speeds of round
    // numbers make it, rounding must not decide in which step it enters: steps end this much
    // before it is due, and twice as much before it is due it enters.
    static constexpr double rounding = 1e-9;

private:
    std::int64_t counted_ = 0;  // whole layers, of requested_mass()
    double counted_mass_ = 0.0;
};

/// Particles inside the box are removed and counted.
template <int D>
struct Outflow {
    Vec<double, D> low{}, high{};
    bool contains(const Vec<double, D>& x) const {
        for (int a = 0; a < D; ++a)
            if (x[a] < low[a] || x[a] > high[a]) return false;
        return true;
    }
};

/// What came in or went out: mass [kg], momentum [kg m/s], kinetic energy [J]; 2-D: per metre. What
/// compression stores is smaller by the square of the Mach number and is left out.
template <int D>
struct Passed {
    double mass = 0.0;
    Vec<double, D> momentum{};
    double energy = 0.0;
    double volume = 0.0;  // [m^3], 2-D: [m^2]

    void add(const Particles<D>& particles, std::size_t p) {
        const double m = particles.mass[p];
        const Vec<double, D>& v = particles.velocity[p];
        mass += m, momentum = momentum + m * v, energy += 0.5 * m * dot(v, v);
        volume += m / particles.density[p];
    }
};

/// Gives the particles that the inflow of this body drives a velocity. In driven_particles.cpp.
template <int D>
void drive(Particles<D>& particles, std::int32_t body, const Vec<double, D>& velocity);

/// Account of what passes open boundaries; masses [kg], 2-D: [kg/m].
template <int D>
struct Ledger {
    double initial = 0.0, requested = 0.0;
    double requested_before = 0.0;  // of inflows, by the time at which the run begins
    Passed<D> inflow, outflow;
    double through_ground = 0.0;  // of what is in outflow
};

/// Everything that adds or removes particles, with its account.
template <int D>
class OpenBoundaries {
public:
    Array<Inflow<D>> inflows;
    Array<Outflow<D>> outflows;
    CountingPlanes<D> planes;
    Ledger<D> ledger;  // of the particles of this rank
    std::int64_t next_id = 0;
    bool adds = true;  // on one rank only; from there particles go to their owners

    double next_event() const {
        double next = std::numeric_limits<double>::infinity();
        for (const Inflow<D>& inflow : inflows) next = min(next, inflow.next_event());
        return next;
    }

    /// Another rank keeps the account.
    void forget() { ledger = {}, planes.forget(); }

    /// Goes on from time t in place of the start; the account begins there.
    void begin_at(double t) {
        for (Inflow<D>& inflow : inflows) {
            inflow.begin_at(t);
            ledger.requested_before += inflow.requested_mass(t);
        }
    }

    /// Carries out all events up to time t; true if particles came or changed their motion, so that
    /// neighbours must be sorted anew. Particles to remove are left in `removed`.
    bool inject(Particles<D>& particles, double t);

    /// Gives driven particles the mean velocity from t to t + dt, so that a drift takes them
    /// exactly as far as the table of their inflow says; nothing to do for one of constant speed.
    void impose_mean_velocity(Particles<D>& particles, double t, double dt) const {
        set_speeds(particles, [t, dt](const SpeedTable& table) {
            return dt > 0.0 ? (table.distance_at(t + dt) - table.distance_at(t)) / dt
                            : table.speed_at(t);
        });
    }

    /// Gives driven particles their velocity at time t.
    void impose_velocity(Particles<D>& particles, double t) const {
        set_speeds(particles, [t](const SpeedTable& table) { return table.speed_at(t); });
    }

    /// Marks in `removed` the free particles inside an outflow or for which `leaves(p)`, and what
    /// `remove_bodies(outflow, removed)` marks there; true if there is any.
    template <class Leaves, class RemoveBodies>
    bool remove_outflow(const Particles<D>& particles, const Leaves& leaves,
                        const RemoveBodies& remove_bodies);
    /// Marks in `removed`, which is as long, the free particles that have gone through the ground:
    /// they would fall for ever, and ask for ever shorter steps.
    template <class Ground>
    void remove_fallen(const Particles<D>& particles, const Ground& ground) {
        for (std::size_t p = 0; p < particles.size(); ++p)
            if (particles.is_free(p) && ground.is_far_below(particles.position[p]))
                removed[p] = 1, ledger.through_ground += particles.mass[p];
    }

    Array<std::uint8_t> removed;

    /// What changes during a run; `removed` is empty between steps.
    void serialise(Archive& archive);

private:
    template <class Speed>
    void set_speeds(Particles<D>& particles, Speed&& speed_of) const;
    void add_layer(Particles<D>& particles, const Inflow<D>& inflow, std::int64_t k, double t);
    void release(Particles<D>& particles, Inflow<D>& inflow, double t);
};

template <int D>
void OpenBoundaries<D>::serialise(Archive& archive) {
    archive("mass_initial", ledger.initial), archive("mass_asked", ledger.requested);
    archive("entered", ledger.inflow), archive("left", ledger.outflow);
    archive("through_ground", ledger.through_ground);
    archive("mass_asked_before", ledger.requested_before);
    archive("next_id", next_id);
    planes.serialise(archive);
    for (std::size_t k = 0; k < inflows.size(); ++k)
        archive.nested(std::to_string(k) + "_", inflows[k]);
}

template <int D>
template <class Speed>
void OpenBoundaries<D>::set_speeds(Particles<D>& particles, Speed&& speed_of) const {
    for (const Inflow<D>& inflow : inflows) {
        if (inflow.speed.steady() || !inflow.open || inflow.closed) continue;
        drive(particles, inflow.body, speed_of(inflow.speed) * inflow.direction);
    }
}

template <int D>
void OpenBoundaries<D>::add_layer(Particles<D>& particles, const Inflow<D>& inflow, std::int64_t k,
                                  double t) {
    const double height = inflow.height_of_layer(k);
    const std::size_t count = inflow.rows_below(height);
    if (!adds) {
        next_id += static_cast<std::int64_t>(count);
        return;
    }
    std::size_t p = particles.size() - 1;
    resize(particles, particles.size() + count);
    for (std::size_t row = 0; row < inflow.layer.size(); ++row) {
        if (!inflow.has_row(row, height)) continue;
        ++p;
        particles.position[p] = inflow.layer[row] + inflow.advance(k, t) * inflow.direction;
        for (int a = 0; a < D; ++a)
            particles.position[p][a] +=
                inflow.jitter * inflow.spacing * symmetric_noise(next_id, a);
        particles.velocity[p] = inflow.speed.speed_at(t) * inflow.direction;
        particles.acceleration[p] = {};
        particles.density[p] = inflow.density;
        particles.density_rate[p] = 0.0;
        particles.mass[p] = inflow.mass;
        particles.smoothing_length[p] = inflow.smoothing_length;
        particles.tag[p] = {next_id++, inflow.body, inflow.material, Motion::driven};
        particles.enter(p);
    }
}

template <int D>
void OpenBoundaries<D>::release(Particles<D>& particles, Inflow<D>& inflow, double t) {
    for (; inflow.has_crossed(inflow.released, t); ++inflow.released)
        add_layer(particles, inflow, inflow.released + inflow.buffer_layers, t);
    for (std::size_t p = 0; p < particles.size(); ++p) {
        Tag& tag = particles.tag[p];
        if (tag.motion != Motion::driven || tag.body != inflow.body) continue;
        const double beyond = dot(particles.position[p] - inflow.layer[0], inflow.direction);
        // Half the way to the next layer at most: a layer is set free as a whole.
        if (beyond >= -(inflow.jitter + 3.0 * Inflow<D>::rounding) * inflow.spacing) {
            tag.motion = Motion::free;
            ledger.inflow.add(particles, p), planes.enters(particles, p);
        }
    }
}

template <int D>
bool OpenBoundaries<D>::inject(Particles<D>& particles, double t) {
    bool changed = false;
    for (Inflow<D>& inflow : inflows) {
        if (!inflow.is_due(t)) continue;
        changed = true;
        if (!inflow.open) {
            inflow.open = true;
            for (std::int64_t k = 0; k < inflow.buffer_layers; ++k)
                add_layer(particles, inflow, inflow.released + k, t);
        }
        release(particles, inflow, min(t, inflow.speed.stop()));
        if (t >= inflow.speed.stop()) {
            inflow.closed = true;
            removed.resize(particles.size(), 0);
            for (std::size_t p = 0; p < particles.size(); ++p)
                if (particles.tag[p].motion == Motion::driven &&
                    particles.tag[p].body == inflow.body)
                    removed[p] = 1;
        }
    }
    ledger.requested = -ledger.requested_before;
    for (Inflow<D>& inflow : inflows) ledger.requested += inflow.requested_mass(t);
    return changed;
}

template <int D>
template <class Leaves, class RemoveBodies>
bool OpenBoundaries<D>::remove_outflow(const Particles<D>& particles, const Leaves& leaves,
                                       const RemoveBodies& remove_bodies) {
    bool any = false;
    removed.resize(particles.size(), 0);
    for (const Outflow<D>& outflow : outflows) remove_bodies(outflow, removed);
    for (std::size_t p = 0; p < particles.size(); ++p) {
        for (const Outflow<D>& outflow : outflows)
            if (particles.is_free(p) && outflow.contains(particles.position[p])) removed[p] = 1;
        if (leaves(p)) removed[p] = 1;
        if (removed[p] && particles.is_counted(p))
            ledger.outflow.add(particles, p), planes.leaves(particles, p);
        any |= removed[p] != 0;
    }
    return any;
}

}  // namespace doseki
