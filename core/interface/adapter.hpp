#pragma once
// A simulation of one dimension and kind of lists, of any scheme, as its caller sees it.

#include <memory>
#include <numeric>

#include "base/phase_timer.hpp"
#include "bodies/shapes/ground_surface.hpp"
#include "interface/any_simulation.hpp"
#include "interface/archive.hpp"
#include "interface/bodies.hpp"
#include "interface/boundaries.hpp"
#include "interface/options.hpp"
#include "interface/particles.hpp"
#include "run/simulation.hpp"

namespace doseki {

template <class Lists>
class Adapter final : public AnySimulation {
    static constexpr int D = Lists::dim;
    using Corner = std::vector<double>;

public:
    Adapter(const SchemeKind<Lists>& scheme, Setup<D> setup)
        : sim_(scheme.make(std::move(setup.materials), setup.options), setup.options,
               setup.domain) {}

    static std::unique_ptr<AnySimulation> make(const std::string& scheme,
                                               const std::string& precision,
                                               const std::vector<NamedValues>& materials,
                                               const NamedValues& options) {
        return std::make_unique<Adapter>(SchemeKind<Lists>::of(scheme, precision),
                                         Setup<D>::read(materials, options));
    }

    void add_particles(const NamedValues& columns) override {
        const std::size_t first = sim_.particles.size();
        resize(sim_.particles, first + ParticleTables<D>::count(columns));
        const std::int64_t next = ParticleTables<D>::set(sim_.particles, first, columns);
        sim_.open_boundaries.next_id = std::max(sim_.open_boundaries.next_id, next);
    }
    void set_walls(const NamedValues& columns) override {
        ParticleTables<D>::set_walls(sim_.particles, columns);
    }
    void set_edges(const NamedValues& columns) override {
        ParticleTables<D>::set_edges(sim_.particles, columns);
    }
    void set_faces(const NamedValues& columns) override {
        ParticleTables<D>::set_faces(sim_.particles, columns);
    }
    void add_shapes(const std::vector<NamedValues>& shapes) override {
        for (const NamedValues& shape : shapes)
            sim_.bodies.rigid.shapes.push_back(
                BodyTables<D>::shape(shape, sim_.bodies.rigid.ground));
    }
    void add_rigid_bodies(const NamedValues& columns) override {
        BodyTables<D>::add_rigid(sim_.bodies, columns);
    }
    void bind_points(const NamedValues& columns) override {
        BodyTables<D>::bind(sim_.bodies, sim_.particles, columns);
    }
    void add_elastic_body(const NamedValues& body) override {
        BodyTables<D>::add_elastic(sim_.bodies, sim_.particles, body);
    }
    void add_inflow(const NamedValues& inflow) override {
        sim_.open_boundaries.inflows.push_back(BoundaryTables<D>::inflow(inflow));
    }
    void add_outflow(const Corner& low, const Corner& high) override {
        sim_.open_boundaries.outflows.push_back(BoundaryTables<D>::outflow(low, high));
    }
    void add_plane(const Corner& point, const Corner& normal) override {
        sim_.open_boundaries.planes.push_back(BoundaryTables<D>::plane(point, normal));
    }
    void move_body(const NamedValues& motion) override {
        sim_.moving_walls.add(BoundaryTables<D>::motion(motion));
    }
    void set_terrain(const NamedValues& field, const NamedValues& wall) override {
        auto bed = std::allocate_shared<HeightField<D>>(Memory<HeightField<D>>(),
                                                        BoundaryTables<D>::height_field(field));
        bed->measure_lean(), bed->hold_all();
        sim_.bodies.rigid.ground = SharedSurface<D>::make(GroundSurface<D>(bed));
        sim_.terrain.set(std::move(bed), BoundaryTables<D>::terrain_wall(wall));
    }
    void share_terrain(NumberReader read) override {
        sim_.terrain.share(GroundSource<D>(std::move(read)));
    }
    void make_room_in_terrain(NumberReader remainder) override {
        sim_.terrain.make_room(std::move(remainder));
    }
    void add_load_meter(const NamedValues& meter) override {
        sim_.bodies.loads.add(BodyTables<D>::load_meter(meter));
    }
    void set_stresses(const NamedValues& columns) override {
        if (auto* const stress = sim_.scheme().own_fields().deviatoric_stress)
            stress->assign(ParticleTables<D>::deviators(columns, sim_.particles.size()));
    }
    void begin_at(double time) override { sim_.begin_at(time); }
    void join(std::unique_ptr<Exchange> exchange) override {
        exchange_ = std::move(exchange);
        sim_.join(*exchange_);
    }

    void start() override { sim_.start(); }
    void advance(double limit, double pause, std::int64_t max_steps) override {
        sim_.advance(limit, pause, max_steps);
    }

    Progress progress() const override {
        Progress now;
        now.time = sim_.time(), now.timestep = sim_.last_timestep(), now.steps = sim_.steps();
        now.rebuilds = sim_.rebuilds(), now.updates = sim_.updates();
        now.particles = sim_.particles.size(), now.skin = sim_.skin();
        return now;
    }
    double bytes_per_particle() const override { return sim_.bytes_per_particle(); }
    double entries_per_particle() const override {
        const auto particles = std::max<std::size_t>(1, sim_.particles.size());
        return static_cast<double>(sim_.neighbours().entries()) / static_cast<double>(particles);
    }
    bool has_bodies() const override { return !sim_.bodies.empty(); }

    NamedValues state() const override {
        const auto order = ParticleTables<D>::id_order(sim_.particles);
        NamedValues table = ParticleTables<D>::fields(sim_.particles, order, states());
        table["stress"] = BodyTables<D>::stress(sim_.bodies, sim_.particles, order, states());
        if (const auto& wall = sim_.particles.wall; wall.in_use) {
            table["force"] = ParticleTables<D>::column(wall.force, order);
            table["moment"] = ParticleTables<D>::column(wall.moment, order);
            table["normal"] = ParticleTables<D>::column(wall.normal, order);
            table["grain"] = BodyTables<D>::body_number_of(sim_.bodies, sim_.particles, order);
            if (auto damage = BodyTables<D>::damage(sim_.bodies, sim_.particles, order))
                table["damage"] = *damage;
        }
        const OwnFields<D> own = sim_.scheme().own_fields();
        if (own.surface) table["surface"] = ParticleTables<D>::column(*own.surface, order);
        if (own.velocity_gradient)
            table["velocity_gradient"] = ParticleTables<D>::column(*own.velocity_gradient, order);
        return table;
    }

    NamedValues rates() const override {
        const auto order = ParticleTables<D>::id_order(sim_.particles);
        NamedValues table = ParticleTables<D>::rates(sim_.particles, order);
        table["deviatoric_stress_rate"] = ParticleTables<D>::stresses(
            order, [this](std::size_t p) { return sim_.scheme().stress_rate(p); });
        NewArray<double> balsara({order.size()});
        for (std::size_t k = 0; k < order.size(); ++k) balsara[k] = sim_.scheme().balsara(order[k]);
        table["balsara"] = balsara, table["timestep"] = sim_.next_timestep();
        table["av_power"] = sim_.scheme().dissipated_power();
        return table;
    }

    NamedValues totals() const override {
        const auto sum = sim_.totals();
        const Ledger<D>& ledger = sim_.open_boundaries.ledger;
        NamedValues table;
        table["mass"] = sum.mass;
        table["momentum"] = list_of(sum.momentum);
        table["kinetic_energy"] = sum.kinetic_energy, table["bulk_energy"] = sum.bulk_energy;
        table["shear_energy"] = sum.shear_energy, table["av_dissipation"] = sim_.dissipation();
        table["mass_initial"] = ledger.initial, table["mass_asked"] = ledger.requested;
        table["mass_entered"] = ledger.inflow.mass, table["mass_left"] = ledger.outflow.mass;
        table["mass_through_ground"] = ledger.through_ground;
        table["volume_entered"] = ledger.inflow.volume;
        table["volume_left"] = ledger.outflow.volume;
        table["momentum_entered"] = list_of(ledger.inflow.momentum);
        table["momentum_left"] = list_of(ledger.outflow.momentum);
        table["energy_entered"] = ledger.inflow.energy;
        table["energy_left"] = ledger.outflow.energy;
        List passed, volume, supplied;
        for (const CountingPlane<D>& plane : sim_.open_boundaries.planes) {
            passed.push_back(plane.passed.mass), volume.push_back(plane.passed.volume);
            supplied.push_back(plane.supplied);
        }
        table["plane_mass"] = passed, table["plane_volume"] = volume;
        table["plane_supplied"] = supplied;
        const Account<D>& account = sim_.account();
        table["impulse"] = list_of(account.impulse);
        table["gravity_work"] = account.gravity_work, table["wall_work"] = account.wall_work;
        table["contact_work"] = account.contact_work, table["scheme_work"] = account.scheme_work;
        table["relaxation_work"] = account.relaxation_work;
        table["parting_work"] = account.parting_work;
        const DeformableTotals& of_bodies = sum.deformable;
        table["elastic_energy"] = of_bodies.elastic_energy;
        table["fracture_work"] = of_bodies.fracture_work;
        table["damping_work"] = of_bodies.damping_work;
        table["broken_bonds"] = of_bodies.broken_bonds;
        table["parts"] = of_bodies.parts, table["dust_grains"] = of_bodies.dust;
        table["count"] = List(sum.count.begin(), sum.count.end());
        return table;
    }

    NamedValues grains() const override { return BodyTables<D>::rigid(sim_.bodies); }
    NamedValues fragments() const override { return BodyTables<D>::fragments(sim_.bodies); }
    NamedValues body_energy() override {
        NamedValues table;
        sim_.bodies.energy().members(
            [&](const char* name, double joules) { table[name] = joules; });
        return table;
    }
    void cut_bodies(const NamedValues& columns) override {
        ColumnReader column(columns, "cut");
        const auto label = column.numbers<std::int32_t>("label");
        column.finish();
        sim_.bodies.cut(sim_.particles, label, sim_.time());
    }

    NamedValues loads() const override { return BodyTables<D>::loads(sim_.bodies); }
    void forget_load_peak(std::size_t meter) override { sim_.bodies.loads.forget_peak(meter); }

    NamedValues sample(const Corner& low, const Corner& high) const override {
        const auto order = ParticleTables<D>::inside(sim_.particles, low, high);
        NamedValues table = ParticleTables<D>::sample(sim_.particles, order, states());
        if (const auto& wall = sim_.particles.wall; wall.in_use) {
            table["normal"] = ParticleTables<D>::column(wall.normal, order);
            table["depth"] = ParticleTables<D>::column(wall.depth, order);
        }
        if (const OwnFields<D> own = sim_.scheme().own_fields(); own.shift)
            table["shift"] = ParticleTables<D>::column(*own.shift, order);
        return table;
    }

    NamedValues force_terms(std::int64_t id) override {
        const ForceTerms<D> terms = sim_.force_terms(id);
        NamedValues acceleration, timestep, table;
        for (const auto& [name, term] : terms.acceleration) {
            NewArray<double> values({static_cast<std::size_t>(D)});
            std::copy(term.component.begin(), term.component.end(), values.data());
            acceleration[name] = values;
        }
        for (const auto& [name, limit] : terms.timestep) timestep[name] = limit;
        table["acceleration"] = acceleration, table["timestep"] = timestep;
        return table;
    }

    NamedValues neighbour_counts() const override {
        const auto counts = sim_.scheme().pair_counts(sim_.neighbours());
        const auto order = ParticleTables<D>::id_order(sim_.particles);
        NewArray<std::int64_t> id({order.size()}), count({order.size()});
        for (std::size_t k = 0; k < order.size(); ++k) {
            id[k] = sim_.particles.tag[order[k]].id;
            count[k] = static_cast<std::int64_t>(counts[order[k]]);
        }
        NamedValues table;
        table["id"] = id, table["count"] = count;
        return table;
    }

    NamedValues shares() const override {
        const Halo<D>& halo = sim_.halo();
        const RankClock& clock = halo.ranks.clock;
        NamedValues table;
        for (std::size_t k = 0; k < share_names.size(); ++k)
            table[share_names[k]] = clock.seconds()[k];
        table["total"] = clock.total(), table["busy"] = clock.busy();
        table["bytes_sent"] = halo.bytes_sent(), table["messages_sent"] = halo.messages_sent();
        table["particles"] = static_cast<std::int64_t>(sim_.particles.size());
        table["ghosts"] = static_cast<std::int64_t>(halo.ghosts());
        return table;
    }

    NamedValues checkpoint() override {
        SavingArchive archive;
        int width = sim_.scheme().width();
        archive("lanes", width);
        sim_.serialise(archive);
        return archive.arrays;
    }

    std::vector<std::string> particle_arrays() const override {
        NamingArchive archive;
        sim_.particles.serialise(archive);
        return archive.names;
    }

    bool restore(const NamedValues& arrays) override {
        LoadingArchive archive(arrays);
        int width = 0;
        archive("lanes", width);
        sim_.serialise(archive);
        if (!exchange_ && width == sim_.scheme().width()) {
            sim_.expect_lists();
            return true;
        }
        sim_.renew_order();
        return false;
    }

    void restore_shared(const NamedValues& arrays) override {
        LoadingArchive archive(arrays);
        sim_.serialise(archive);
        sim_.leave_to_first_rank();
        sim_.renew_order();
    }

    void time_phases(bool on) override { sim_.phases().restart(on); }
    NamedValues phase_seconds() override {
        const auto seconds = sim_.phases().seconds(thread_count());
        NamedValues table;
        for (std::size_t k = 0; k < phase_names.size(); ++k) table[phase_names[k]] = seconds[k];
        return table;
    }
    double interacting_pairs() const override {
        const Array<double> counts = sim_.scheme().pair_counts(sim_.neighbours());
        return std::accumulate(counts.begin(), counts.end(), 0.0);
    }
    double bare_pair_rate(double seconds) const override {
        return sim_.scheme().bare_pair_rate(sim_.neighbours(), seconds);
    }

private:
    static List list_of(const Vec<double, D>& v) {
        return List(v.component.begin(), v.component.end());
    }

    PointStates<D> states() const {
        return [this](std::size_t p) -> PointState<D> {
            return {sim_.scheme().equation_of_state(p), sim_.scheme().deviator(p),
                    sim_.scheme().stress(p)};
        };
    }

    std::unique_ptr<Exchange> exchange_;
    Simulation<Lists> sim_;
};

}  // namespace doseki
