#include "interface/particles.hpp"

#include <algorithm>
#include <numeric>

#include "interface/boundaries.hpp"
#include "interface/reader.hpp"

namespace doseki {
namespace {

template <std::size_t n>
void put_row(NewArray<double>& array, std::size_t k, const std::array<double, n>& row) {
    std::copy(row.begin(), row.end(), array.row(k));
}

template <int D>
void sort_by_id(const Particles<D>& particles, Array<std::size_t>& order) {
    std::sort(order.begin(), order.end(), [&particles](std::size_t p, std::size_t q) {
        return particles.tag[p].id < particles.tag[q].id;
    });
}

}  // namespace

template <int D>
std::size_t ParticleTables<D>::count(const NamedValues& columns) {
    ColumnReader column(columns, "particles");
    return column.numbers<std::int64_t>("id").size();
}

template <int D>
std::int64_t ParticleTables<D>::set(Particles<D>& particles, std::size_t first,
                                    const NamedValues& columns) {
    ColumnReader column(columns, "particles");
    const auto position = column.vectors<D>("position"), velocity = column.vectors<D>("velocity");
    const auto mass = column.numbers<double>("mass"), density = column.numbers<double>("density"),
               smoothing_length = column.numbers<double>("smoothing_length");
    const auto material = column.numbers<std::int32_t>("material"),
               body = column.numbers<std::int32_t>("body"),
               motion = column.numbers<std::int32_t>("motion");
    const auto id = column.numbers<std::int64_t>("id");
    column.finish();
    std::int64_t next_id = 0;
    for (std::size_t k = 0; k < column.rows(); ++k) {
        const std::size_t p = first + k;
        particles.position[p] = position[k], particles.velocity[p] = velocity[k];
        particles.mass[p] = mass[k], particles.density[p] = density[k];
        particles.smoothing_length[p] = smoothing_length[k];
        particles.tag[p] = {id[k], body[k], static_cast<std::int16_t>(material[k]),
                            static_cast<Motion>(motion[k])};
        next_id = std::max(next_id, id[k] + 1);
    }
    return next_id;
}

template <int D>
void ParticleTables<D>::set_walls(Particles<D>& particles, const NamedValues& columns) {
    ColumnReader column(columns, "walls");
    const auto normal = column.vectors<D>("normal");
    const auto depth = column.numbers<double>("depth"),
               curvature = column.numbers<double>("curvature");
    column.finish();
    if (column.rows() != particles.size())
        throw std::invalid_argument("walls: one row for each particle");
    if (!particles.wall.in_use) throw std::invalid_argument("the scheme has no walls");
    particles.wall.normal.assign(normal);
    particles.wall.depth.assign(depth);
    for (std::size_t p = 0; p < particles.size(); ++p)
        particles.wall.bend[p] = bend_of_ball(particles.wall.normal[p], curvature[p]);
}

template <int D>
void ParticleTables<D>::set_edges(Particles<D>& particles, const NamedValues& columns) {
    ColumnReader column(columns, "edges");
    const auto normals = column.numbers<double>("normals", D * D);
    const auto depths = column.vectors<D>("depths");
    column.finish();
    if (column.rows() != particles.size())
        throw std::invalid_argument("edges: one row for each particle");
    if (!particles.wall.in_use) throw std::invalid_argument("the scheme has no walls");
    for (std::size_t p = 0; p < particles.size(); ++p)
        std::copy_n(&normals[p * D * D], D * D, particles.wall.edge_normals[p].element.data());
    particles.wall.edge_depths.assign(depths);
}

template <int D>
void ParticleTables<D>::set_faces(Particles<D>& particles, const NamedValues& columns) {
    ColumnReader column(columns, "faces");
    const auto face = column.numbers<std::int32_t>("face");
    const auto area = column.vectors<D>("area");
    column.finish();
    if (column.rows() != particles.size())
        throw std::invalid_argument("faces: one row for each particle");
    if (!particles.wall.in_use) throw std::invalid_argument("the scheme has no walls");
    particles.wall.face.assign(face);
    particles.wall.area.assign(area);
}

template <int D>
Array<std::size_t> ParticleTables<D>::id_order(const Particles<D>& particles) {
    Array<std::size_t> order(particles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    sort_by_id(particles, order);
    return order;
}

template <int D>
Array<std::size_t> ParticleTables<D>::inside(const Particles<D>& particles,
                                             std::span<const double> low,
                                             std::span<const double> high) {
    const Outflow<D> box = BoundaryTables<D>::outflow(low, high);
    Array<std::size_t> found;
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (box.contains(particles.position[p])) found.push_back(p);
    sort_by_id(particles, found);
    return found;
}

template <int D>
NamedValues ParticleTables<D>::sample(const Particles<D>& particles,
                                      const Array<std::size_t>& order,
                                      const PointStates<D>& states) {
    const std::size_t n = order.size();
    NewArray<double> position({n, D}), velocity({n, D}), mass({n}), density({n}), pressure({n}),
        h({n});
    NewArray<std::int32_t> material({n}), motion({n}), body({n});
    NewArray<std::int64_t> id({n});
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t p = order[k];
        put_row(position, k, particles.position[p].component);
        put_row(velocity, k, particles.velocity[p].component);
        mass[k] = particles.mass[p], density[k] = particles.density[p];
        pressure[k] = states(p).eos.pressure, h[k] = particles.smoothing_length[p];
        material[k] = particles.tag[p].material, id[k] = particles.tag[p].id;
        motion[k] = static_cast<std::int32_t>(particles.tag[p].motion);
        body[k] = particles.tag[p].body;
    }
    NamedValues table;
    table["position"] = position, table["velocity"] = velocity;
    table["mass"] = mass, table["density"] = density, table["pressure"] = pressure;
    table["smoothing_length"] = h, table["material"] = material, table["motion"] = motion;
    table["id"] = id, table["body"] = body;
    return table;
}

template <int D>
NamedValues ParticleTables<D>::fields(const Particles<D>& particles,
                                      const Array<std::size_t>& order,
                                      const PointStates<D>& states) {
    const std::size_t n = order.size();
    NewArray<double> c({n});
    for (std::size_t k = 0; k < n; ++k) c[k] = states(order[k]).eos.sound_speed;
    NamedValues table = sample(particles, order, states);
    table["sound_speed"] = c;
    table["deviatoric_stress"] =
        stresses(order, [&states](std::size_t p) { return states(p).elastic; });
    return table;
}

template <int D>
NamedValues ParticleTables<D>::rates(const Particles<D>& particles,
                                     const Array<std::size_t>& order) {
    NamedValues table;
    table["acceleration"] = column(particles.acceleration, order);
    table["density_rate"] = column(particles.density_rate, order);
    return table;
}

template <int D>
Value ParticleTables<D>::stresses(const Array<std::size_t>& order,
                                  const std::function<Deviator<double, D>(std::size_t)>& deviator) {
    NewArray<double> column({order.size(), 3, 3});
    for (std::size_t k = 0; k < order.size(); ++k)
        fill_stress(column.data() + 9 * k, 0.0, deviator(order[k]));
    return column;
}

template <int D>
Array<Deviator<double, D>> ParticleTables<D>::deviators(const NamedValues& columns,
                                                        std::size_t count) {
    ColumnReader column(columns, "stresses");
    const auto numbers = column.numbers<double>("deviatoric_stress", 9);
    column.finish();
    if (column.rows() != count) throw std::invalid_argument("stresses: one row for each particle");
    Array<Deviator<double, D>> rows(count);
    for (std::size_t k = 0; k < count; ++k)
        for (int a = 0; a < D; ++a)
            for (int b = a; b < D; ++b)
                if (a < 2)  // zz follows from the others
                    rows[k].element[static_cast<std::size_t>(Deviator<double, D>::index(a, b))] =
                        numbers[9 * k + static_cast<std::size_t>(3 * a + b)];
    return rows;
}

template struct ParticleTables<2>;
template struct ParticleTables<3>;

}  // namespace doseki
