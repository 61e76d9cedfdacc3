// Bodies, compiled once for all schemes, and how they become parts and dust.

#include "bodies/bodies.hpp"

#include <numeric>

#include "bodies/contact_forces.hpp"
#include "bodies/deformable/rigid_shape.hpp"
#include "bodies/fragments/dust_room.hpp"
#include "bodies/steps/advance.hpp"

namespace doseki {

template <int D>
void Bodies<D>::number_bodies() {
    rigid_at_start_ = static_cast<std::int32_t>(rigid.size());
    for (std::size_t k = 0; k < rigid.size(); ++k)
        rigid_origins_.add({rigid.body(k).fixed ? -1 : numbers_++, -1, 0.0});
    for (std::size_t k = 0; k < deformable.bodies(); ++k)
        deformable_origins_.add({number_of_deformable(k), -1, 0.0});
}

template <int D>
auto Bodies<D>::part(double time, double dt, const Course& course) -> Parted {
    const Fragments<D> fragments = deformable.divide(dt, pair_area_);
    if (!fragments.any()) return {};
    new_faces_ |= deformable.have_faces();
    auto origin = [&](std::int32_t parent) -> Origin {
        return {numbers_++, deformable_origins_[static_cast<std::size_t>(parent)].number, time};
    };
    for (const std::int32_t parent : fragments.parent) deformable_origins_.add(origin(parent));
    divide_breakable(fragments);
    const BodySums<D> before = rigid.sums();
    const std::size_t first = rigid.size();
    for (std::size_t k = 0; k < fragments.dust.size(); ++k)
        add_dust(fragments.dust[k], fragments.dust_normals[k], origin(fragments.dust_parent[k]));
    const double kinetic = rigid.kinetic_energy() - before.kinetic_energy;
    for (std::size_t k = first; k < rigid.size(); ++k)
        rigid.push_by_flow(k, course.half - course.on_points);
    const BodySums<D> born = rigid.sums().less(before);
    for (std::size_t k = first; k < rigid.size(); ++k) {
        rigid.push_by_flow(k, course.on_rigid - course.half);
        rigid.push_by_gravity(k, gravity_, course.on_rigid - course.on_points);
    }
    prepare_contacts();
    if constexpr (D == 2) {
        shrink_dust(first);
        prepare_contacts();
    }
    renumber_contacts(fragments, contact_.solids.size());
    accept_overlaps(fragments, first);
    return {born, fragments.lost - kinetic};
}

/// The rigid bodies of those that divide have not their shape.
template <int D>
void Bodies<D>::divide_breakable(const Fragments<D>& fragments) {
    const std::size_t first = deformable.bodies() - fragments.parent.size();
    for (std::size_t b = 0; b < first; ++b) {
        const std::int32_t n = fragments.divided[b] ? breakable_.of_deformable(b) : -1;
        if (n < 0) continue;
        const BreakableBody<D>& body = breakable_[static_cast<std::size_t>(n)];
        if (body.has_rigid()) rigid_origins_.forget(body.rigid);
        Array<std::size_t> parts;
        for (std::size_t k = 0; k < fragments.parent.size(); ++k)
            if (fragments.parent[k] == static_cast<std::int32_t>(b)) parts.push_back(first + k);
        breakable_.divide(static_cast<std::size_t>(n), parts, deformable);
    }
    breakable_.index(rigid.size(), deformable);
}

template <int D>
void Bodies<D>::add_dust(const DustGrain<D>& grain, const Array<Vec<double, D>>& normals,
                         const Origin& origin) {
    const auto of = static_cast<std::size_t>(deformable.body_of_point(grain.points.front()));
    RigidBody<D> body = grain.body;
    body.material = deformable.material(of), body.group = deformable.group(of);
    const std::size_t k = rigid.size();
    Shape<D> ball;
    ball.radius = grain.largest;
    rigid.add(body, grain.state, ball);
    rigid_origins_.add(origin);
    for (std::size_t n = 0; n < grain.points.size(); ++n) {
        const std::uint32_t p = grain.points[n];
        dust_points_[p] =
            rigid_particles_.add(k, deformable.solids().x[p] - grain.state.centre, normals[n]);
    }
}

template <int D>
void Bodies<D>::rebind(Particles<D>& particles) {
    if (!rebinds_) return;
    for_each_particle(particles.size(), [&](std::size_t p) {
        deformable.rebind(particles, p, breakable_.deformable_points());
    });
    rebinds_ = false;
}

template <int D>
void Bodies<D>::bind_dust(Particles<D>& particles) {
    if (dust_points_.empty()) return;
    for (std::size_t p = 0; p < particles.size(); ++p) {
        if (!deformable.has(particles, p)) continue;
        const auto found = dust_points_.find(particles.point(p));
        if (found == dust_points_.end()) continue;
        particles.wall.depth[p] = 0.5 * deformable.solids().body_of(found->first).spacing;
        particles.wall.face[p] = Face::none;
        particles.set_point(p, BodyKind::rigid, found->second);
    }
    dust_points_.clear();
}

/// Outlines touch and do not overlap: so does dust beside them that takes the room there is, Eq.
/// (123).
template <int D>
void Bodies<D>::shrink_dust(std::size_t first) {
    Array<double> room;
    for (std::size_t k = first; k < rigid.size(); ++k)
        room.push_back(room_for_dust(contact_, static_cast<std::int32_t>(k),
                                     static_cast<std::int32_t>(first), contacts_.domain()));
    for (std::size_t k = first; k < rigid.size(); ++k) rigid.resize_ball(k, room[k - first]);
}

template <int D>
void Bodies<D>::renumber_contacts(const Fragments<D>& fragments, std::size_t solids) {
    Array<std::int32_t> points, shapes;
    const std::size_t first = fragments.first_contact_point,
                      end = first + DeformableSurfaces<D>::points_each * fragments.vertex.size();
    for (std::size_t k = 0; k < end; ++k)
        points.push_back(deformable.surfaces().renumbered(k, first, fragments.vertex));
    for (std::size_t s = 0; s < solids; ++s) shapes.push_back(static_cast<std::int32_t>(s));
    std::map<std::int32_t, std::int32_t> now;  // the surface of each body
    for (std::size_t s = 0; s < contact_.surfaces.size(); ++s)
        now[contact_.surfaces[s].body - static_cast<std::int32_t>(rigid.size())] =
            static_cast<std::int32_t>(contact_.solids.size() + s);
    for (const std::int32_t body : fragments.surface_body) {
        const bool stays = !fragments.divided[static_cast<std::size_t>(body)] && now.contains(body);
        shapes.push_back(stays ? now.at(body) : -1);
    }
    contacts_.renumber(points, shapes);
    find_contacts();
}

/// Pairs that could not touch before, since both were of one body, one is new or one was clamped in
/// what the other is of, have the overlaps that they are born with at rest, Eq. (115). In 2-D crack
/// faces fit each other, but parts that hung together at a corner may have turned into each other.
template <int D>
void Bodies<D>::accept_overlaps(const Fragments<D>& fragments, std::size_t first_dust) {
    Array<std::uint8_t> is_old(contact_.points.size(), 0);
    const std::size_t end = fragments.first_contact_point +
                            DeformableSurfaces<D>::points_each * fragments.vertex.size();
    for (std::size_t k = 0; k < end; ++k) {
        const std::int32_t now =
            deformable.surfaces().renumbered(k, fragments.first_contact_point, fragments.vertex);
        if (now >= 0) is_old[static_cast<std::size_t>(now)] = 1;
    }
    const Array<std::int32_t> was = bodies_before(fragments, first_dust);
    const auto first_deformable = static_cast<std::int32_t>(rigid.size());
    auto is_part = [&](std::int32_t body) {
        const std::int32_t parent = was[static_cast<std::size_t>(body)] - first_deformable;
        return parent >= 0 && fragments.divided[static_cast<std::size_t>(parent)] != 0;
    };
    contacts_.accept_overlaps(contact_, [&](const ContactPair& pair, bool touches) {
        if (!is_old[pair.first()] || (!pair.with_shape() && !is_old[pair.second()])) return true;
        const auto [a, b] = contact_.bodies(pair);
        if (!touches && (is_part(a) || is_part(b))) return true;
        return was[static_cast<std::size_t>(a)] == was[static_cast<std::size_t>(b)];
    });
}

/// A clamped body lies in what holds it: the fixed bodies, the ground among them, that it overlaps
/// at the start. Where it is not clamped, beside its foot, these overlaps rest, Eq. (115).
template <int D>
void Bodies<D>::rest_in_holders() {
    Array<std::uint8_t> is_held(rigid.size() + deformable.bodies(), 0), holds(is_held);
    for (std::size_t k = 0; k < rigid.size(); ++k) holds[k] = rigid.body(k).fixed;
    for (std::size_t p = 0; p < deformable.size(); ++p)
        if (deformable.solids().clamped(p))
            is_held[rigid.size() + static_cast<std::size_t>(deformable.body_of_point(p))] = 1;
    if (std::ranges::find(is_held, 1) == is_held.end()) return;
    contacts_.accept_overlaps(contact_, [&](const ContactPair& pair, bool) {
        const auto [first, second] = contact_.bodies(pair);
        const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
        return (is_held[a] && holds[b]) || (holds[a] && is_held[b]);
    });
}

/// Of which body each one was a part, bodies as contacts number them now.
template <int D>
Array<std::int32_t> Bodies<D>::bodies_before(const Fragments<D>& fragments,
                                             std::size_t first_dust) const {
    Array<std::int32_t> was(rigid.size() + deformable.bodies());
    std::iota(was.begin(), was.end(), 0);
    const auto first = static_cast<std::int32_t>(rigid.size());
    for (std::size_t k = 0; k < fragments.dust_parent.size(); ++k)
        was[first_dust + k] = first + fragments.dust_parent[k];
    for (std::size_t k = 0; k < fragments.parent.size(); ++k)
        was[was.size() - fragments.parent.size() + k] = first + fragments.parent[k];
    return was;
}

template class ContactLaws<2>;
template class RigidBodies<2>;
template class Contacts<2>;
template class Bodies<2>;

template class ContactLaws<3>;
template class RigidBodies<3>;
template class Contacts<3>;
template class Bodies<3>;

}  // namespace doseki
