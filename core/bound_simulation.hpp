#pragma once
// Python's view of a simulation: one class per scheme, dimension and precision.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <omp.h>

#include <memory>
#include <numbers>
#include <numeric>

#include "bound_arrays.hpp"
#include "bound_elastic.hpp"
#include "bound_exchange.hpp"
#include "checkpoint.hpp"
#include "pair_probe.hpp"
#include "simulation.hpp"

namespace doseki {

template <int D>
Vec<double, D> vector(const nb::handle& sequence) {
    const auto values = nb::cast<std::vector<double>>(sequence);
    if (values.size() != D) throw nb::value_error("vector of the wrong length");
    Vec<double, D> v;
    for (int a = 0; a < D; ++a) v[a] = values[static_cast<std::size_t>(a)];
    return v;
}

inline Surface surface(const nb::dict& d) {
    const Surface usual;
    return {get(d, "restitution", usual.restitution), get(d, "friction", usual.friction),
            get(d, "rolling_friction", usual.rolling_friction),
            get(d, "young_modulus", usual.young_modulus),
            get(d, "poisson_ratio", usual.poisson_ratio)};
}

inline Material material(const nb::dict& d) {
    auto number = [&d](const char* key, double otherwise = 0.0) {
        return get<double>(d, key, otherwise);
    };
    Material m;
    m.name = get<std::string>(d, "name");
    m.law = get<std::string>(d, "law") == "solid" ? Law::solid : Law::fluid;
    m.rho0 = get<double>(d, "rho0"), m.c0 = get<double>(d, "speedsound");
    m.shear_modulus = get<double>(d, "shear_modulus"), m.nu = get<double>(d, "nu");
    m.yield_strength = number("yield_strength"), m.cohesion = number("cohesion");
    m.friction_angle = number("friction_angle") * std::numbers::pi / 180.0;
    const auto rheology = get<std::string>(d, "rheology", "newtonian");
    m.rheology = rheology == "herschel_bulkley" ? Rheology::herschel_bulkley
                 : rheology == "mu_i"           ? Rheology::mu_i
                                                : Rheology::newtonian;
    const double greatest = number("viscosity_max");
    m.herschel_bulkley = {number("yield_stress"), number("consistency"), number("flow_index", 1.0),
                          number("regularisation"), greatest};
    m.mu_i = {number("mu_s"),           number("mu_2"),          number("inertial_number"),
              number("grain_diameter"), number("grain_density"), greatest};
    m.surface = surface(d);
    return m;
}

inline ContactOptions contact_options(const nb::dict& d) {
    ContactOptions o;
    o.hertz = get<std::string>(d, "law") == "hertz";
    o.softened = get<std::string>(d, "stiffness") == "softened";
    o.overlap = get<double>(d, "overlap");
    o.speed = get<double>(d, "speed");
    o.steps = get<double>(d, "steps");
    return o;
}

inline FlowOptions flow_options(const nb::dict& d) {
    FlowOptions o;
    o.dp = get<double>(d, "dp");
    o.wide_kernel = get<std::string>(d, "kernel") == "wendland_c6";
    o.monaghan_cleary = get<std::string>(d, "viscosity") == "monaghan_cleary";
    o.shifting = get<bool>(d, "shifting");
    o.pressure_law = get<std::string>(d, "eos") == "tait" ? PressureLaw::tait : PressureLaw::linear;
    const auto turbulence = get<std::string>(d, "turbulence");
    o.turbulence = turbulence == "smagorinsky"     ? Turbulence::smagorinsky
                   : turbulence == "mixing_length" ? Turbulence::mixing_length
                                                   : Turbulence::none;
    o.smagorinsky = get<double>(d, "smagorinsky");
    for (const auto& wall : nb::cast<std::vector<nb::dict>>(d["walls"]))
        o.walls.push_back({get<bool>(wall, "stick"), get<double>(wall, "ks")});
    return o;
}

template <int D>
Options<D> options(const nb::dict& d) {
    Options<D> o;
    o.gravity = vector<D>(d["gravity"]);
    o.attraction = get(d, "attraction", 0.0);
    o.eta = get<double>(d, "eta");
    o.alpha = get<double>(d, "alpha");
    o.cflnumber = get<double>(d, "cflnumber");
    o.cfl_force = get<double>(d, "cfl_force");
    o.skin = get<double>(d, "skin");
    o.auto_skin = get(d, "auto_skin", false);
    o.fixed_limits_dt = get(d, "fixed_limits_dt", true);
    o.balsara = get<bool>(d, "balsara");
    o.sym_grad = get<bool>(d, "sym_grad");
    const auto tension = get<std::string>(d, "tension");
    o.tension = tension == "free"        ? Tension::free
                : tension == "clamp_all" ? Tension::clamp_all
                                         : Tension::clamp_fluid;
    o.h_mode = get<std::string>(d, "h_mode") == "eq10" ? SmoothingLengthMode::eq10
                                                       : SmoothingLengthMode::constant;
    if (d.contains("contact")) o.contact = contact_options(nb::cast<nb::dict>(d["contact"]));
    if (d.contains("flow")) o.flow = flow_options(nb::cast<nb::dict>(d["flow"]));
    return o;
}

template <int D>
Domain<D> domain(const nb::dict& d) {
    Domain<D> box;
    box.low = vector<D>(d["domain_min"]);
    box.high = vector<D>(d["domain_max"]);
    const auto periodic = nb::cast<std::vector<bool>>(d["periodic"]);
    for (int a = 0; a < D; ++a) box.periodic[a] = periodic.at(static_cast<std::size_t>(a));
    return box;
}

template <class Scheme>
class Bound {
public:
    using Sim = Simulation<Scheme>;
    static constexpr int D = Scheme::dim;

    Bound(const std::vector<nb::dict>& materials, const nb::dict& o)
        : sim_(make_materials(materials), options<D>(o), domain<D>(o)) {}

    void add_particles(Input<double> position, Input<double> velocity, Input<double> mass,
                       Input<double> density, Input<double> smoothing_length,
                       Input<std::int32_t> material, Input<std::int32_t> body,
                       Input<std::int32_t> motion, Input<std::int64_t> id) {
        const std::size_t first = sim_.particles.size(), n = mass.size();
        if (position.size() != n * D || velocity.size() != n * D || id.size() != n)
            throw nb::value_error("particle arrays of unequal length");
        auto& particles = sim_.particles;
        particles.resize(first + n);
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t p = first + k;
            for (int a = 0; a < D; ++a) {
                particles.position[p][a] = position.data()[k * D + a];
                particles.velocity[p][a] = velocity.data()[k * D + a];
            }
            particles.mass[p] = mass.data()[k];
            particles.density[p] = density.data()[k];
            particles.smoothing_length[p] = smoothing_length.data()[k];
            particles.tag[p] = {id.data()[k], body.data()[k],
                                static_cast<std::int16_t>(material.data()[k]),
                                static_cast<Motion>(motion.data()[k])};
            sim_.sources.next_id = std::max(sim_.sources.next_id, id.data()[k] + 1);
        }
    }

    /// Normals (n, D) and depths (n) of the walls, in the order in which the particles were added.
    void set_walls(Input<double> normal, Input<double> depth) {
        auto& particles = sim_.particles;
        if (normal.size() != particles.size() * D || depth.size() != particles.size())
            throw nb::value_error("wall arrays of the wrong length");
        if (!particles.has_flow) throw nb::value_error("the scheme has no walls");
        for (std::size_t p = 0; p < particles.size(); ++p) {
            for (int a = 0; a < D; ++a) particles.flow.normal[p][a] = normal.data()[p * D + a];
            particles.flow.wall_depth[p] = depth.data()[p];
        }
    }

    /// Balls {radius}, or convex shapes {vertices, faces, samples}, which bodies name by their
    /// index.
    void add_shapes(const std::vector<nb::dict>& dicts) {
        for (const nb::dict& d : dicts) {
            Shape<D> shape;
            if (d.contains("radius"))
                shape.radius = get<double>(d, "radius");
            else
                read_facets(d, shape);
            sim_.bodies.shapes.push_back(std::move(shape));
        }
    }

    void add_rigid_bodies(const nb::dict& d) {
        const auto shape = get<Input<std::int32_t>>(d, "shape"),
                   material = get<Input<std::int32_t>>(d, "material"),
                   named = get<Input<std::int32_t>>(d, "body");
        const auto fixed = get<Input<bool>>(d, "fixed");
        const auto centre = get<Input<double>>(d, "centre"),
                   orientation = get<Input<double>>(d, "orientation"),
                   velocity = get<Input<double>>(d, "velocity"),
                   spin = get<Input<double>>(d, "spin"), mass = get<Input<double>>(d, "mass"),
                   inertia = get<Input<double>>(d, "inertia");
        const std::size_t n = shape.size();
        if (centre.size() != n * D || velocity.size() != n * D || orientation.size() != 4 * n ||
            spin.size() != 3 * n || inertia.size() != 9 * n || mass.size() != n ||
            material.size() != n || named.size() != n || fixed.size() != n)
            throw nb::value_error("arrays of bodies of unequal length");
        for (std::size_t k = 0; k < n; ++k) {
            RigidBody<D> body{shape.data()[k], material.data()[k], named.data()[k],
                              fixed.data()[k], mass.data()[k],     {}};
            BodyState<D> state{};
            Vec3 turn;
            std::copy_n(inertia.data() + 9 * k, 9, body.inertia.element.begin());
            std::copy_n(spin.data() + 3 * k, 3, turn.component.begin());
            std::copy_n(centre.data() + D * k, D, state.centre.component.begin());
            std::copy_n(velocity.data() + D * k, D, state.velocity.component.begin());
            const double* q = orientation.data() + 4 * k;
            state.orientation = {q[0], q[1], q[2], q[3]};
            sim_.bodies.add(body, state, turn);
        }
    }

    /// Index of its rigid body for each particle in the order in which they were added, or -1. Call
    /// after set_walls.
    void bind_points(Input<std::int32_t> body) {
        auto& particles = sim_.particles;
        if (body.size() != particles.size())
            throw nb::value_error("one body, or -1, for each particle");
        for (std::size_t p = 0; p < particles.size(); ++p)
            if (body.data()[p] >= 0)
                sim_.bodies.bind(particles, p, static_cast<std::size_t>(body.data()[p]));
    }

    /// A deformable body of particles that have been added: {material, rho0, young_modulus,
    /// poisson_ratio, law, spacing, damping} and, for each of its particles, its number in the
    /// order of adding, whether it is clamped and whether it is on the surface. Call after
    /// set_walls.
    void add_elastic_body(const nb::dict& d) {
        const auto members = get<Input<std::int32_t>>(d, "particles");
        const auto clamped = get<Input<std::uint8_t>>(d, "clamped"),
                   surface = get<Input<std::uint8_t>>(d, "surface");
        if (clamped.size() != members.size() || surface.size() != members.size())
            throw nb::value_error("arrays of an elastic body of unequal length");
        if (!sim_.particles.has_flow) throw nb::value_error("the scheme has no bodies");
        sim_.bodies.deformable.add(
            sim_.particles, elastic_body(d), get<std::int32_t>(d, "material"),
            {members.data(), members.size()}, {clamped.data(), clamped.size()},
            {surface.data(), surface.size()});
    }

    /// The bodies, in the order in which they were added.
    nb::dict grains() const {
        const Bodies<D>& bodies = sim_.bodies;
        const std::size_t n = bodies.size();
        Output<double> centre({n, D}), velocity({n, D}), spin({n, 3}), orientation({n, 4}),
            flow_force({n, D}), contact_force({n, D}), mass({n}), radius({n}), overlap({n});
        Output<std::int32_t> contacts({n}), named({n}), material({n});
        Output<bool> fixed({n}), removed({n});
        for (std::size_t k = 0; k < n; ++k) {
            const RigidBody<D>& body = bodies.body(k);
            const BodyState<D>& state = bodies.state(k);
            const Vec3 turn = bodies.spin(k);
            std::copy_n(state.centre.component.begin(), D, centre.data + D * k);
            std::copy_n(state.velocity.component.begin(), D, velocity.data + D * k);
            std::copy_n(turn.component.begin(), 3, spin.data + 3 * k);
            std::copy_n(state.flow_force.component.begin(), D, flow_force.data + D * k);
            std::copy_n(bodies.contact_force(k).component.begin(), D, contact_force.data + D * k);
            const double q[] = {state.orientation.w, state.orientation.x, state.orientation.y,
                                state.orientation.z};
            std::copy_n(q, 4, orientation.data + 4 * k);
            mass.data[k] = body.mass,
            radius.data[k] = bodies.shapes[static_cast<std::size_t>(body.shape)].radius;
            named.data[k] = body.body, material.data[k] = body.material, fixed.data[k] = body.fixed;
            removed.data[k] = state.removed != 0.0;
        }
        bodies.contacts().for_each_touching([&](std::int32_t a, std::int32_t b, double share) {
            for (const std::int32_t k : {a, b}) {
                if (static_cast<std::size_t>(k) >= n) continue;  // a deformable one
                ++contacts.data[k];
                overlap.data[k] = std::max(overlap.data[k], share);
            }
        });
        nb::dict d;
        d["centre"] = centre.release(), d["velocity"] = velocity.release(),
        d["spin"] = spin.release();
        d["orientation"] = orientation.release(), d["flow_force"] = flow_force.release();
        d["contact_force"] = contact_force.release(), d["mass"] = mass.release(),
        d["radius"] = radius.release();
        d["contacts"] = contacts.release(), d["overlap"] = overlap.release(),
        d["body"] = named.release();
        d["material"] = material.release(), d["fixed"] = fixed.release(),
        d["removed"] = removed.release();
        d["worst_overlap"] = bodies.contacts().worst_overlap();
        return d;
    }

    void add_inflow(const nb::dict& d) {
        Inflow<D> inflow;
        for (const auto& row : nb::cast<std::vector<std::vector<double>>>(d["layer"])) {
            Vec<double, D> x;
            for (int a = 0; a < D; ++a) x[a] = row.at(static_cast<std::size_t>(a));
            inflow.layer.push_back(x);
        }
        inflow.direction = vector<D>(d["direction"]);
        if (d.contains("times"))
            inflow.speed = {get<Column>(d, "times"), get<Column>(d, "distances"),
                            get<Column>(d, "speeds")};
        else
            inflow.speed = SpeedTable::constant(get<double>(d, "start"), get<double>(d, "stop"),
                                                get<double>(d, "speed"));
        if (inflow.speed.time.size() < 2 ||
            inflow.speed.distance.size() != inflow.speed.time.size() ||
            inflow.speed.speed.size() != inflow.speed.time.size())
            throw nb::value_error(
                "an inflow needs two rows or more of times, distances and speeds");
        inflow.spacing = get<double>(d, "spacing");
        inflow.buffer_layers = get<int>(d, "buffer_layers");
        inflow.jitter = get<double>(d, "jitter");
        inflow.mass = get<double>(d, "mass");
        inflow.density = get<double>(d, "density");
        inflow.smoothing_length = get<double>(d, "smoothing_length");
        inflow.material = static_cast<std::int16_t>(get<int>(d, "material"));
        inflow.body = get<std::int32_t>(d, "body");
        sim_.sources.inflows.push_back(std::move(inflow));
    }

    void add_outflow(const std::vector<double>& low, const std::vector<double>& high) {
        sim_.sources.outflows.push_back({vector<D>(nb::cast(low)), vector<D>(nb::cast(high))});
    }

    void move_body(const nb::dict& d) {
        WallMotion<D> motion;
        motion.body = get<std::int32_t>(d, "body");
        motion.velocity = vector<D>(d["velocity"]);
        const auto spin = vector<3>(d["angular_velocity"]);
        for (int a = 0; a < 3; ++a) motion.spin[static_cast<std::size_t>(a)] = spin[a];
        motion.pivot = vector<D>(d["pivot"]);
        motion.start = get<double>(d, "start"), motion.stop = get<double>(d, "stop");
        motion.removed_at = get<double>(d, "removed_at");
        sim_.walls.add(motion);
    }

    /// Makes this one of several ranks, which `transport` joins.
    void join(nb::object transport) {
        exchange_ = std::make_unique<PythonExchange>(std::move(transport));
        sim_.join(*exchange_);
    }

    bool has_bodies() const { return !sim_.bodies.empty(); }

    /// What this rank has spent beside its steps, what it has sent, how many particles it holds
    /// [s].
    nb::dict shares() const {
        const Halo<D>& halo = sim_.halo();
        nb::dict d;
        for (std::size_t k = 0; k < share_names.size(); ++k)
            d[share_names[k]] = halo.ranks.clock.seconds()[k];
        d["total"] = halo.ranks.clock.total(), d["busy"] = halo.ranks.clock.busy();
        d["bytes_sent"] = halo.bytes_sent(), d["messages_sent"] = halo.messages_sent();
        d["particles"] = sim_.particles.size(), d["ghosts"] = halo.ghosts();
        return d;
    }

    /// Names of the arrays of a checkpoint that have one row for each particle.
    std::vector<std::string> particle_arrays() {
        SavingArchive archive;
        Particles<D> none;
        none.has_strength = sim_.particles.has_strength, none.has_flow = sim_.particles.has_flow;
        none.serialise(archive);
        std::vector<std::string> names;
        for (const auto& item : archive.arrays) names.push_back(nb::cast<std::string>(item.first));
        return names;
    }

    /// By id, how many other particles are within support.
    nb::dict neighbour_counts() const {
        const std::vector<double> of_particle =
            PairCounter(sim_.rates(), sim_.neighbours()).counts();
        const auto order = id_order();
        Output<std::int64_t> id({order.size()}), count({order.size()});
        for (std::size_t k = 0; k < order.size(); ++k)
            id.data[k] = sim_.particles.tag[order[k]].id,
            count.data[k] = static_cast<std::int64_t>(of_particle[order[k]]);
        nb::dict d;
        d["id"] = id.release(), d["count"] = count.release();
        return d;
    }

    /// What gauges read of the particles in a box, in the order of their ids.
    nb::dict sample(const std::vector<double>& low, const std::vector<double>& high) const {
        const auto& particles = sim_.particles;
        const Outflow<D> box{vector<D>(nb::cast(low)), vector<D>(nb::cast(high))};
        std::vector<std::size_t> found;
        for (std::size_t p = 0; p < particles.size(); ++p)
            if (box.contains(particles.position[p])) found.push_back(p);
        std::sort(found.begin(), found.end(), [&](std::size_t p, std::size_t q) {
            return particles.tag[p].id < particles.tag[q].id;
        });
        const std::size_t n = found.size();
        Output<double> position({n, D}), velocity({n, D}), mass({n}), density({n}), pressure({n}),
            h({n});
        Output<std::int32_t> material({n}), motion({n});
        Output<std::int64_t> id({n});
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t p = found[k];
            id.data[k] = particles.tag[p].id;
            for (int a = 0; a < D; ++a) {
                position.data[k * D + a] = particles.position[p][a];
                velocity.data[k * D + a] = particles.velocity[p][a];
            }
            mass.data[k] = particles.mass[p], density.data[k] = particles.density[p];
            pressure.data[k] = eos_of(p).pressure, h.data[k] = particles.smoothing_length[p];
            material.data[k] = particles.tag[p].material;
            motion.data[k] = static_cast<std::int32_t>(particles.tag[p].motion);
        }
        nb::dict d;
        d["position"] = position.release(), d["velocity"] = velocity.release();
        d["mass"] = mass.release(), d["density"] = density.release(),
        d["pressure"] = pressure.release();
        d["smoothing_length"] = h.release(), d["material"] = material.release(),
        d["motion"] = motion.release();
        d["id"] = id.release();
        return d;
    }

    nb::dict state() const {
        const auto& particles = sim_.particles;
        const std::size_t n = particles.size();
        const auto order = id_order();
        Output<double> position({n, D}), velocity({n, D}), mass({n}), density({n}), pressure({n}),
            h({n}), c({n}), deviator({n, 3, 3}), stress({n, 3, 3});
        Output<std::int32_t> material({n}), body({n}), motion({n});
        Output<std::int64_t> id({n});
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t p = order[k];
            const Tag& tag = particles.tag[p];
            for (int a = 0; a < D; ++a) {
                position.data[k * D + a] = particles.position[p][a];
                velocity.data[k * D + a] = particles.velocity[p][a];
            }
            const auto eos = eos_of(p);
            mass.data[k] = particles.mass[p], density.data[k] = particles.density[p];
            pressure.data[k] = eos.pressure, c.data[k] = eos.sound_speed;
            h.data[k] = particles.smoothing_length[p];
            material.data[k] = tag.material, body.data[k] = tag.body;
            motion.data[k] = static_cast<std::int32_t>(tag.motion), id.data[k] = tag.id;
            fill_tensor(deviator.data + 9 * k, 0.0, particles.stress(p));
            fill_tensor(stress.data + 9 * k, eos.pressure, sim_.rates().deviator(particles, p));
            if (const auto& bodies = sim_.bodies.deformable; bodies.has(particles, p))
                bodies.stress(particles, p, stress.data + 9 * k);
        }
        nb::dict d;
        d["position"] = position.release(), d["velocity"] = velocity.release();
        d["mass"] = mass.release(), d["density"] = density.release(),
        d["pressure"] = pressure.release();
        d["sound_speed"] = c.release(), d["smoothing_length"] = h.release();
        d["deviatoric_stress"] = deviator.release(), d["stress"] = stress.release();
        d["material"] = material.release(), d["body"] = body.release(),
        d["motion"] = motion.release();
        d["id"] = id.release();
        if (particles.has_flow) add_flow_state(d, order), add_grain_numbers(d, order);
        return d;
    }

    nb::dict rates() const {
        const auto& particles = sim_.particles;
        const std::size_t n = particles.size();
        const auto order = id_order();
        Output<double> acceleration({n, D}), density_rate({n}), stress_rate({n, 3, 3}),
            balsara({n});
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t p = order[k];
            for (int a = 0; a < D; ++a) acceleration.data[k * D + a] = particles.acceleration[p][a];
            density_rate.data[k] = particles.density_rate[p];
            fill_tensor(stress_rate.data + 9 * k, 0.0, particles.stress_rate(p));
            if constexpr (!Scheme::has_flow)
                balsara.data[k] = static_cast<double>(sim_.rates().stress_records()[p].balsara);
        }
        nb::dict d;
        d["acceleration"] = acceleration.release(), d["density_rate"] = density_rate.release();
        d["deviatoric_stress_rate"] = stress_rate.release(), d["balsara"] = balsara.release();
        d["timestep"] = sim_.next_timestep(), d["av_power"] = sim_.rates().av_power();
        return d;
    }

    nb::dict totals() const {
        const auto sum = sim_.totals();
        const Ledger& ledger = sim_.sources.ledger;
        nb::dict d;
        d["mass"] = sum.mass;
        d["momentum"] =
            std::vector<double>(sum.momentum.component.begin(), sum.momentum.component.end());
        d["kinetic_energy"] = sum.kinetic_energy, d["bulk_energy"] = sum.bulk_energy;
        d["shear_energy"] = sum.shear_energy, d["av_dissipation"] = sim_.av_dissipation();
        d["mass_initial"] = ledger.initial, d["mass_asked"] = ledger.asked;
        d["mass_entered"] = ledger.entered, d["mass_left"] = ledger.left;
        d["count"] = sum.count;
        return d;
    }

    nb::dict checkpoint() {
        SavingArchive archive;
        int width = Sim::width;
        archive("lanes", width);
        sim_.serialise(archive);
        return archive.arrays;
    }

    /// False where lists had to be made anew, because this module has clusters of another width
    /// (none: the state is that of several ranks).
    bool restore(const nb::dict& arrays) {
        LoadingArchive archive(arrays);
        int width = 0;
        archive("lanes", width);
        sim_.serialise(archive);
        if (exchange_ || width == 0) {
            sim_.renew_order();
            return false;
        }
        if (width == Sim::width) return true;
        sim_.renew_lists();
        return false;
    }

    /// The same on several ranks for a state that all of them have read.
    void restore_shared(const nb::dict& arrays) {
        LoadingArchive archive(arrays);
        sim_.serialise(archive);
        sim_.leave_to_first_rank();
        sim_.renew_order();
    }

    void start() {
        guarded([&] { sim_.start(); });
    }
    void advance(double limit, double pause, std::int64_t max_steps) {
        guarded([&] { sim_.advance(limit, pause, max_steps); });
    }
    /// Kind and particle of the failure that ended the last call; "" and -1 without one.
    std::pair<std::string, std::int64_t> failure() const { return failure_; }
    double time() const { return sim_.time(); }
    double timestep() const { return sim_.last_timestep(); }
    std::int64_t steps() const { return sim_.steps(); }
    std::int64_t rebuilds() const { return sim_.rebuilds(); }
    std::int64_t updates() const { return sim_.updates(); }
    std::size_t size() const { return sim_.particles.size(); }
    double skin() const { return sim_.skin(); }
    double bytes_per_particle() const { return sim_.bytes_per_particle(); }
    double entries_per_particle() const {
        return double(sim_.neighbours().entries()) / double(std::max<std::size_t>(1, size()));
    }

    void time_phases(bool on) { sim_.phases().restart(on); }
    nb::dict phase_seconds() {
        const auto seconds = sim_.phases().seconds(omp_get_max_threads());
        nb::dict d;
        for (std::size_t k = 0; k < phase_names.size(); ++k) d[phase_names[k]] = seconds[k];
        return d;
    }
    double interacting_pairs() const {
        return PairCounter(sim_.rates(), sim_.neighbours()).interacting_pairs();
    }
    double bare_pair_rate(double seconds) const {
        if constexpr (Scheme::has_flow)
            throw nb::value_error("only the ueta2022 scheme has a bare rate");
        else
            return PairProbe(sim_.rates(), sim_.neighbours()).bare_rate(seconds);
    }

private:
    auto eos_of(std::size_t p) const { return sim_.rates().thermodynamics(sim_.particles, p); }

    void add_grain_numbers(nb::dict& d, const std::vector<std::size_t>& order) const {
        Output<std::int32_t> grain({order.size()});
        for (std::size_t k = 0; k < order.size(); ++k)
            grain.data[k] = sim_.bodies.body_of(sim_.particles, order[k]);
        d["grain"] = grain.release();
    }

    /// Forces on walls, and the measure of the free surface, by id.
    void add_flow_state(nb::dict& d, const std::vector<std::size_t>& order) const {
        const auto& flow = sim_.particles.flow;
        Output<double> force({order.size(), D}), surface({order.size()}), normal({order.size(), D}),
            gradient({order.size(), D, D});
        for (std::size_t k = 0; k < order.size(); ++k) {
            const std::size_t p = order[k];
            surface.data[k] = flow.surface[p];
            for (int a = 0; a < D; ++a) {
                force.data[k * D + a] = flow.wall_force[p][a],
                                   normal.data[k * D + a] = flow.normal[p][a];
                for (int b = 0; b < D; ++b)
                    gradient.data[(k * D + a) * D + b] = flow.velocity_gradient[p](a, b);
            }
        }
        d["force"] = force.release(), d["surface"] = surface.release(),
        d["normal"] = normal.release();
        d["velocity_gradient"] = gradient.release();
    }

    /// Python's exceptions carry only a text; what else a failure says is kept here.
    template <class F>
    void guarded(F&& work) {
        failure_ = {"", -1};
        try {
            work();
        } catch (const PhysicsFailure& failure) {
            failure_ = {failure.kind, failure.particle};
            throw;
        }
    }

    static void read_facets(const nb::dict& d, Shape<D>& shape) {
        const auto vertices = get<Input<double>>(d, "vertices"),
                   samples = get<Input<double>>(d, "samples");
        const auto faces = get<Input<std::int32_t>>(d, "faces");
        auto row = [](const Input<double>& table, std::size_t k) {
            Vec<double, D> x;
            std::copy_n(table.data() + D * k, D, x.component.begin());
            return x;
        };
        for (std::size_t f = 0; f < faces.size() / D; ++f) {
            typename Shape<D>::Facet facet;
            for (int a = 0; a < D; ++a)
                facet[a] = row(vertices, static_cast<std::size_t>(faces.data()[f * D + a]));
            shape.facets.push_back(facet);
        }
        for (std::size_t k = 0; k < samples.size() / D; ++k)
            shape.samples.push_back(row(samples, k));
        for (std::size_t k = 0; k < vertices.size() / D; ++k)
            shape.radius = std::max(shape.radius, norm(row(vertices, k)));
    }

    static std::vector<Material> make_materials(const std::vector<nb::dict>& dicts) {
        std::vector<Material> materials;
        for (const auto& d : dicts) materials.push_back(material(d));
        return materials;
    }

    std::vector<std::size_t> id_order() const {
        const auto& tag = sim_.particles.tag;
        std::vector<std::size_t> order(tag.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::sort(order.begin(), order.end(),
                  [&](std::size_t p, std::size_t q) { return tag[p].id < tag[q].id; });
        return order;
    }

    static void fill_tensor(double* out, double p, const Deviator<double, D>& S) {
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) out[3 * a + b] = S(std::min(a, b), std::max(a, b));
        out[8] = S.zz();
        for (int a = 0; a < 3; ++a) out[4 * a] -= p;
    }

    std::unique_ptr<Exchange> exchange_;
    Sim sim_;
    std::pair<std::string, std::int64_t> failure_{"", -1};
};

template <class Scheme>
void bind_simulation(nb::module_& m, const char* name) {
    using B = Bound<Scheme>;
    const auto unlocked = nb::call_guard<nb::gil_scoped_release>();
    nb::class_<B>(m, name)
        .def(nb::init<const std::vector<nb::dict>&, const nb::dict&>(), nb::arg("materials"),
             nb::arg("options"))
        .def("add_particles", &B::add_particles, nb::kw_only(), nb::arg("position"),
             nb::arg("velocity"), nb::arg("mass"), nb::arg("density"), nb::arg("smoothing_length"),
             nb::arg("material"), nb::arg("body"), nb::arg("motion"), nb::arg("id"))
        .def("set_walls", &B::set_walls, nb::kw_only(), nb::arg("normal"), nb::arg("depth"))
        .def("add_shapes", &B::add_shapes, nb::arg("shapes"))
        .def("add_rigid_bodies", &B::add_rigid_bodies, nb::arg("bodies"))
        .def("bind_points", &B::bind_points, nb::arg("body"))
        .def("add_elastic_body", &B::add_elastic_body, nb::arg("body"))
        .def("grains", &B::grains,
             "State of the rigid bodies, in the order in which they were added.")
        .def("add_inflow", &B::add_inflow)
        .def("add_outflow", &B::add_outflow, nb::arg("low"), nb::arg("high"))
        .def("move_body", &B::move_body, "Give a fixed body a prescribed motion.")
        .def("sample", &B::sample, nb::arg("low"), nb::arg("high"),
             "Fields of the particles inside a box, in the order of their ids.")
        .def("start", &B::start, unlocked)
        .def("advance", &B::advance, nb::arg("limit"), nb::arg("pause"), nb::arg("max_steps"),
             unlocked)
        .def("checkpoint", &B::checkpoint, "The whole state as arrays in storage order.")
        .def("restore", &B::restore, nb::arg("arrays"),
             "Go on from what checkpoint() gave; false where that changes the order of sums.")
        .def("restore_shared", &B::restore_shared, nb::arg("arrays"),
             "restore() of a state that all ranks have read and that is to be divided among them.")
        .def("join", &B::join, nb::arg("transport"), "Become one of several ranks.")
        .def_prop_ro("has_bodies", &B::has_bodies, "Whether bodies move on their own.")
        .def("shares", &B::shares,
             "Seconds by share, what was sent, particles and ghosts of this rank.")
        .def("neighbour_counts", &B::neighbour_counts,
             "How many others are within support of each particle.")
        .def_prop_ro("particle_arrays", &B::particle_arrays)
        .def_prop_ro("failure", &B::failure)
        .def("time_phases", &B::time_phases, nb::arg("on"),
             "Start timing the phases of steps from zero, or stop.")
        .def("phase_seconds", &B::phase_seconds)
        .def("interacting_pairs", &B::interacting_pairs, unlocked,
             "Ordered pairs of different particles within support; fixed-fixed ones not counted.")
        .def("bare_pair_rate", &B::bare_pair_rate, nb::arg("seconds"), unlocked,
             "Such pairs per second in both sums of one thread over clusters that stay in cache.")
        .def_prop_ro("skin", &B::skin)
        .def("state", &B::state)
        .def("rates", &B::rates)
        .def("totals", &B::totals)
        .def_prop_ro("time", &B::time)
        .def_prop_ro("timestep", &B::timestep)
        .def_prop_ro("steps", &B::steps)
        .def_prop_ro("rebuilds", &B::rebuilds)
        .def_prop_ro("updates", &B::updates)
        .def_prop_ro("bytes_per_particle", &B::bytes_per_particle)
        .def_prop_ro("entries_per_particle", &B::entries_per_particle)
        .def("__len__", &B::size);
}

}  // namespace doseki
