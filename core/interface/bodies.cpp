#include "interface/bodies.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "bodies/elastic/elastic_law.hpp"
#include "bodies/fragments/rigid_motion.hpp"
#include "interface/reader.hpp"

namespace doseki {
namespace {

template <int D>
void read_facets(ColumnReader& column, Shape<D>& shape) {
    const auto vertices = column.vectors<D>("vertices");
    for (const auto& x : vertices) shape.radius = std::max(shape.radius, norm(x));
    const auto faces = column.numbers<std::int32_t>("faces", D);
    for (std::size_t f = 0; f < faces.size() / D; ++f) {
        Facet<D> facet;
        for (std::size_t a = 0; a < D; ++a)
            facet[a] = vertices.at(static_cast<std::size_t>(faces[f * D + a]));
        shape.facets.push_back(facet);
    }
}

template <int D>
Array<SurfaceVertex<D>> surface_of(const NamedValues& table, const Array<Vec<double, D>>& rest) {
    ColumnReader column(table, "surface of an elastic body");
    const auto place = column.vectors<D>("vertex");
    const auto carrier = column.numbers<std::int32_t>("carrier");
    const auto crease = column.numbers<std::uint8_t>("crease");
    const auto outward = column.vectors<D>("outward");
    const auto share = column.numbers<double>("share"), radius = column.numbers<double>("radius");
    Array<SurfaceVertex<D>> vertices;
    for (std::size_t v = 0; v < place.size(); ++v) {
        const Vec<double, D> point = rest.at(static_cast<std::size_t>(carrier[v]));
        SurfaceVertex<D>& vertex = vertices.emplace_back();
        vertex.point = static_cast<std::uint32_t>(carrier[v]), vertex.offset = place[v] - point;
        vertex.crease = crease[v], vertex.outward = outward[v], vertex.share = share[v];
        vertex.radius = radius[v];
    }
    return vertices;
}

/// None where the table has none.
BodyCells cells_of(const NamedValues& table) {
    BodyCells cells;
    if (!table.find("cell_count")) return cells;
    ColumnReader column(table, "cells of an elastic body", ColumnReader::any_rows);
    cells.count = column.numbers<std::uint32_t>("cell_count");
    cells.node = column.numbers<std::uint32_t>("cell_node");
    return cells;
}

template <class Vector>
void put(NewArray<double>& array, std::size_t k, const Vector& vector) {
    std::copy(vector.component.begin(), vector.component.end(), array.row(k));
}

}  // namespace

DeformableBody read_elastic_body(const NamedValues& table, const Array<const char*>& others) {
    DeformableBody body{};
    std::string law;
    double modulus = 0.0, ratio = 0.0;
    Reader read(table, "elastic body");
    read("rho0", body.rho0), read("elastic_law", law);
    read("young_modulus", modulus), read("poisson_ratio", ratio);
    read("spacing", body.spacing), read("hourglass", body.hourglass), read("damping", body.damping);
    Fracture<double> fracture;
    std::int64_t seed = 0;
    if (table.find("fracture")) read.law("fracture", fracture);
    read("flaw_seed", seed, optional);
    for (const char* key : others) read.allow(key);
    read.finish();
    body.seed = static_cast<std::uint64_t>(std::max<std::int64_t>(0, seed));
    auto chosen = alternative<Hyperelastic<double>>(law);
    with_value(chosen, [&](auto& known) { known.lame = Lame<double>::of(modulus, ratio); });
    body.law = Shared<const ElasticLaw>::make(ElasticLaw{chosen, fracture});
    return body;
}

template <int D>
Shape<D> BodyTables<D>::shape(const NamedValues& table, const SharedSurface<D>& ground) {
    Shape<D> shape;
    if (table.find("radius")) {
        Reader read(table, "shape");
        bool is_ground = false;
        read("radius", shape.radius), read("ground", is_ground, optional);
        read.finish();
        if (is_ground && !ground) throw std::invalid_argument("shape: there is no terrain");
        if (is_ground) shape.kind = ShapeKind::ground;
        shape.enclose(ground);
        return shape;
    }
    ColumnReader column(table, "shape", ColumnReader::any_rows);
    read_facets(column, shape);
    shape.samples = column.vectors<D>("samples");
    shape.kind = ShapeKind::convex;
    if (table.find("thickness")) {
        shape.kind = ShapeKind::mesh;
        shape.thickness = column.numbers<double>("thickness").at(0);
        shape.radius += 0.5 * shape.thickness;
    }
    column.finish();
    shape.enclose(ground);
    return shape;
}

template <int D>
void BodyTables<D>::add_rigid(Bodies<D>& bodies, const NamedValues& columns) {
    ColumnReader column(columns, "rigid bodies");
    const auto shape = column.numbers<std::int32_t>("shape"),
               material = column.numbers<std::int32_t>("material"),
               named = column.numbers<std::int32_t>("body");
    const auto fixed = column.numbers<std::uint8_t>("fixed");
    const auto mass = column.numbers<double>("mass"),
               orientation = column.numbers<double>("orientation", 4),
               inertia = column.numbers<double>("inertia", 9);
    const auto centre = column.vectors<D>("centre"), velocity = column.vectors<D>("velocity");
    const auto spin = column.vectors<3>("spin");
    column.finish();
    for (std::size_t k = 0; k < column.rows(); ++k) {
        RigidBody<D> body{shape[k], material[k], named[k], fixed[k] != 0, mass[k], {}};
        std::copy_n(&inertia[9 * k], 9, body.inertia.element.begin());
        RigidBodyState<D> state{};
        state.centre = centre[k], state.velocity = velocity[k];
        const double* q = &orientation[4 * k];
        state.orientation = {q[0], q[1], q[2], q[3]};
        bodies.rigid.add(body, state, spin[k]);
    }
}

template <int D>
void BodyTables<D>::bind(Bodies<D>& bodies, Particles<D>& particles, const NamedValues& columns) {
    ColumnReader column(columns, "points of bodies");
    const auto index = column.numbers<std::int32_t>("body");
    column.finish();
    if (index.size() != particles.size())
        throw std::invalid_argument("bodies of particles: one index, or -1, for each particle");
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (index[p] >= 0) bodies.bind(particles, p, static_cast<std::size_t>(index[p]));
}

template <int D>
void BodyTables<D>::add_elastic(Bodies<D>& bodies, Particles<D>& particles,
                                const NamedValues& table) {
    const Array<const char*> own{"material", "particles", "rest",       "position",  "velocity",
                                 "clamped",  "vertex",    "carrier",    "crease",    "outward",
                                 "share",    "radius",    "cell_count", "cell_node", "rigid_first"};
    const DeformableBody body = read_elastic_body(table, own);
    if (!particles.wall.in_use) throw std::invalid_argument("the scheme has no bodies");
    std::int32_t material = 0;
    bool rigid_first = false;
    Reader keys(table, "elastic body");
    keys("material", material), keys("rigid_first", rigid_first, optional);
    ColumnReader column(table, "elastic body");
    const auto members = column.numbers<std::int32_t>("particles");
    const SolidPoints<D> points = solid_points<D>(column);
    const std::int32_t rigid =
        rigid_first ? bodies.rigid_body_of(particles, static_cast<std::size_t>(members.at(0))) : -1;
    if (rigid_first && rigid < 0)
        throw std::invalid_argument("elastic body.rigid_first: its particles are of no rigid body");
    bodies.deformable.add(particles, body, material, members, points,
                          surface_of<D>(table, points.rest), cells_of(table), rigid_first);
    if (rigid_first) bodies.make_breakable(static_cast<std::size_t>(rigid));
}

template <int D>
NamedValues BodyTables<D>::rigid(const Bodies<D>& bodies) {
    const RigidBodies<D>& rigid = bodies.rigid;
    const std::size_t n = rigid.size();
    NewArray<double> centre({n, D}), velocity({n, D}), spin({n, 3}), orientation({n, 4}),
        flow_force({n, D}), contact_force({n, D}), flow_impulse({n, D}), contact_impulse({n, D}),
        mass({n}), radius({n}), overlap({n});
    NewArray<std::int32_t> contacts({n}), named({n}), material({n}), number({n}), parent({n});
    NewArray<double> born({n});
    NewArray<bool> fixed({n}), removed({n});
    for (std::size_t k = 0; k < n; ++k) {
        const RigidBody<D>& body = rigid.body(k);
        const RigidBodyState<D>& state = rigid.state(k);
        const Quaternion& q = state.orientation;
        put(centre, k, state.centre), put(velocity, k, state.velocity);
        put(spin, k, rigid.spin(k));
        put(orientation, k, Vec<double, 4>{{q.w, q.x, q.y, q.z}});
        put(flow_force, k, state.flow_force), put(contact_force, k, rigid.contact_force(k));
        put(flow_impulse, k, state.flow_impulse), put(contact_impulse, k, state.contact_impulse);
        mass[k] = body.mass, radius[k] = rigid.shape(k).radius;
        named[k] = body.group, material[k] = body.material, fixed[k] = body.fixed;
        removed[k] = state.is_removed();
        const Origin origin = bodies.deforms(k) ? Origin{} : bodies.rigid_origins()[k];
        number[k] = origin.number, parent[k] = origin.parent, born[k] = origin.born;
    }
    bodies.contacts().for_each_touching([&](std::int32_t a, std::int32_t b, double share) {
        for (const std::int32_t k : {a, b}) {
            if (static_cast<std::size_t>(k) >= n) continue;  // a deformable one
            ++contacts[static_cast<std::size_t>(k)];
            double& largest = overlap[static_cast<std::size_t>(k)];
            largest = std::max(largest, share);
        }
    });
    NamedValues table;
    table["centre"] = centre, table["velocity"] = velocity, table["spin"] = spin;
    table["orientation"] = orientation, table["flow_force"] = flow_force;
    table["flow_impulse"] = flow_impulse, table["contact_impulse"] = contact_impulse;
    table["contact_force"] = contact_force, table["mass"] = mass, table["radius"] = radius;
    table["contacts"] = contacts, table["overlap"] = overlap, table["body"] = named;
    table["material"] = material, table["fixed"] = fixed, table["removed"] = removed;
    table["number"] = number, table["parent"] = parent, table["born"] = born;
    table["worst_overlap"] = Value(bodies.contacts().max_overlap());
    return table;
}

template <int D>
LoadMeter<D> BodyTables<D>::load_meter(const NamedValues& table) {
    LoadMeter<D> meter;
    Reader read(table, "load meter");
    read("bodies", meter.bodies), read("about", meter.about);
    if (table.find("count")) {
        PanelGrid<D>& grid = meter.grid;
        read("origin", grid.origin), read("normal", grid.normal), read("edges", grid.edge);
        read("size", grid.size), read("count", grid.count);
        read("footprint", grid.footprint), read("reach", grid.reach);
        for (const double size : grid.size)
            if (!(size > 0.0)) throw std::invalid_argument("load meter.size: not above 0");
        for (const std::int32_t count : grid.count)
            if (count < 1) throw std::invalid_argument("load meter.count: not above 0");
    }
    read.finish();
    return meter;
}

template <int D>
NamedValues BodyTables<D>::loads(const Bodies<D>& bodies) {
    const Array<LoadMeter<D>>& meters = bodies.loads.all();
    const std::size_t n = meters.size();
    std::size_t panels = 0;
    for (const LoadMeter<D>& meter : meters) panels += meter.grid.panels();
    NewArray<double> flow({n, D}), contact({n, D}), flow_turning({n, 3}), contact_turning({n, 3}),
        peak_force({n, D}), peak_moment({n, 3}), peak_time({n}), hit_speed({n}), hit_radius({n}),
        panel_flow({panels}), panel_contact({panels});
    NewArray<std::int64_t> count({n});
    std::size_t first = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const LoadMeter<D>& meter = meters[k];
        put(flow, k, meter.flow_impulse()), put(contact, k, meter.contact_impulse());
        put(flow_turning, k, meter.flow_turning());
        put(contact_turning, k, meter.contact_turning());
        put(peak_force, k, meter.peak().force), put(peak_moment, k, meter.peak().moment);
        peak_time[k] = meter.peak().time;
        hit_speed[k] = meter.hit().speed, hit_radius[k] = meter.hit().radius;
        count[k] = static_cast<std::int64_t>(meter.grid.panels());
        std::ranges::copy(meter.panels_of_flow(), panel_flow.data() + first);
        std::ranges::copy(meter.panels_of_contacts(), panel_contact.data() + first);
        first += meter.grid.panels();
    }
    NamedValues table;
    table["flow_impulse"] = flow, table["contact_impulse"] = contact;
    table["flow_turning"] = flow_turning, table["contact_turning"] = contact_turning;
    table["peak_force"] = peak_force, table["peak_moment"] = peak_moment;
    table["peak_time"] = peak_time, table["hit_speed"] = hit_speed;
    table["hit_radius"] = hit_radius, table["panels"] = count;
    table["panel_flow"] = panel_flow, table["panel_contact"] = panel_contact;
    return table;
}

template <int D>
NamedValues BodyTables<D>::fragments(const Bodies<D>& bodies) {
    Array<std::size_t> rows;
    std::map<std::int32_t, std::size_t> row_of;  // by the number of the body among those that touch
    for (std::size_t b = 0; b < bodies.deformable_origins().size(); ++b) {
        if (bodies.deformable_origins()[b].number < 0 ||
            (bodies.deformable.solids().is_rigid(b) && !bodies.has_left(b)))
            continue;
        row_of[static_cast<std::int32_t>(bodies.rigid.size() + b)] = rows.size();
        rows.push_back(b);
    }
    const std::size_t n = rows.size();
    NewArray<double> centre({n, D}), velocity({n, D}), spin({n, 3}), orientation({n, 4}), mass({n}),
        radius({n}), overlap({n}), born({n});
    NewArray<std::int32_t> contacts({n}), named({n}), material({n}), number({n}), parent({n});
    NewArray<bool> removed({n});
    const Array<RigidMotion<D>> motions = rigid_motions(bodies.deformable.solids());
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t b = rows[k];
        const RigidMotion<D>& motion = motions[b];
        const Quaternion& q = motion.orientation;
        put(centre, k, motion.centre), put(velocity, k, motion.velocity);
        put(spin, k, motion.spin), put(orientation, k, Vec<double, 4>{{q.w, q.x, q.y, q.z}});
        mass[k] = motion.mass, radius[k] = motion.radius, removed[k] = motion.mass == 0.0;
        named[k] = bodies.deformable.group(b), material[k] = bodies.deformable.material(b);
        const Origin origin = bodies.deformable_origins()[b];
        number[k] = origin.number, parent[k] = origin.parent, born[k] = origin.born;
    }
    std::set<std::pair<std::int32_t, std::int32_t>> touching;
    bodies.contacts().for_each_touching([&](std::int32_t a, std::int32_t b, double share) {
        for (const auto& [own, other] : {std::pair{a, b}, std::pair{b, a}}) {
            const auto found = row_of.find(own);
            if (found == row_of.end()) continue;
            overlap[found->second] = std::max(overlap[found->second], share);
            if (touching.emplace(own, other).second) ++contacts[found->second];
        }
    });
    NamedValues table;
    table["centre"] = centre, table["velocity"] = velocity, table["spin"] = spin;
    table["orientation"] = orientation, table["mass"] = mass, table["radius"] = radius;
    table["contacts"] = contacts, table["overlap"] = overlap, table["body"] = named;
    table["material"] = material, table["removed"] = removed;
    table["number"] = number, table["parent"] = parent, table["born"] = born;
    return table;
}

template <int D>
Value BodyTables<D>::body_number_of(const Bodies<D>& bodies, const Particles<D>& particles,
                                    const Array<std::size_t>& order) {
    NewArray<std::int32_t> grain({order.size()});
    for (std::size_t k = 0; k < order.size(); ++k) grain[k] = bodies.number_of(particles, order[k]);
    return grain;
}

template <int D>
std::optional<Value> BodyTables<D>::damage(const Bodies<D>& bodies, const Particles<D>& particles,
                                           const Array<std::size_t>& order) {
    if (!bodies.deformable.solids().bonds().any()) return std::nullopt;
    NewArray<double> damage({order.size()});
    for (std::size_t k = 0; k < order.size(); ++k) damage[k] = bodies.damage(particles, order[k]);
    return damage;
}

template <int D>
Value BodyTables<D>::stress(const Bodies<D>& bodies, const Particles<D>& particles,
                            const Array<std::size_t>& order, const PointStates<D>& states) {
    NewArray<double> stress({order.size(), 3, 3});
    for (std::size_t k = 0; k < order.size(); ++k) {
        double* const out = stress.data() + 9 * k;
        const PointState<D> state = states(order[k]);
        ParticleTables<D>::fill_stress(out, state.eos.pressure, state.deviator);
        if (bodies.deformable.has(particles, order[k]))
            bodies.deformable.stress(particles, order[k], out);
    }
    return stress;
}

template struct BodyTables<2>;
template struct BodyTables<3>;

}  // namespace doseki
