#pragma once
// Forces of contacts, which bodies.cpp compiles.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>
#include <utility>

#include "base/array.hpp"
#include "base/parallel.hpp"
#include "bodies/contacts.hpp"

namespace doseki {

template <int D>
void Contacts<D>::find(ContactBodies<D>& bodies, double margin) {
    std::unordered_map<std::uint64_t, std::size_t> before;  // first rows
    for (std::size_t k = 0; k < pairs_.size(); ++k) before.try_emplace(key(pairs_[k]), k);
    const Array<ContactSprings> springs = std::move(springs_);
    const Array<Vec<double, D>> normals = std::move(normals_);
    const Array<PairPush<D>> pushes = std::move(pushes_);
    const Array<PairContact> contacts = std::move(contacts_);
    pairs_.clear();
    find_ball_pairs(bodies.points, domain_, margin, pairs_);
    find_solid_pairs(bodies, domain_, margin, pairs_);
    turn_to_surfaces(bodies, pairs_);
    add_rows(bodies);
    springs_.assign(pairs_.size(), {}), normals_.assign(pairs_.size(), {});
    restore(bodies);
    find_gaps(bodies, margin);
    pushes_.assign(pairs_.size(), {});
    for (std::size_t k = 0; k < pairs_.size(); ++k)
        if (const auto found = before.find(key(pairs_[k])); found != before.end()) {
            const std::size_t row = found->second++;  // the next row of the same pair comes next
            springs_[k] = springs[row], normals_[k] = normals[row];
            if (row < pushes.size()) pushes_[k] = pushes[row];
            if (row < contacts.size()) contacts_[k].overlap = contacts[row].overlap;
        }
}

template <int D>
void Contacts<D>::add_rows(const ContactBodies<D>& bodies) {
    Array<ContactPair> rows;
    for (const ContactPair& pair : pairs_)
        rows.insert(rows.end(), most_touched(bodies, pair), pair);
    pairs_ = std::move(rows);
}

/// At how many places or images a pair may touch at once.
template <int D>
std::size_t Contacts<D>::most_touched(const ContactBodies<D>& bodies,
                                      const ContactPair& pair) const {
    const Array<double>& radius = bodies.points.radius;
    const ContactSolid<D>* solid = bodies.solid(pair);
    if (solid && radius[pair.first()] > 0.0) return solid->surface->most_touched();
    if (pair.with_shape()) return 1;
    const double reach = radius[pair.first()] + radius[pair.second()];
    return std::min(SurfacePoints<D>::most, images_within(domain_, reach));
}

/// Each once, in rising order.
inline Array<std::int32_t> points_of(const Array<ContactPair>& pairs) {
    Array<std::int32_t> points;
    for (const ContactPair& pair : pairs) {
        points.push_back(pair.a);
        if (!pair.with_shape()) points.push_back(pair.b);
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

/// Whether a pair is that of a point of a deformable body and a ball that is not much heavier.
template <int D>
bool is_light_ball(const ContactPoints<D>& points, const ContactPair& pair) {
    constexpr double light = 200.0;  // masses of a sample of the surface: some ten points
    if (pair.with_shape()) return false;
    const std::size_t a = pair.first(), b = pair.second();
    if (points.deformable[a] == points.deformable[b]) return false;
    const std::size_t ball = points.deformable[a] ? b : a, sample = points.deformable[a] ? a : b;
    return !points.fixed[ball] && points.mass[ball] < light * points.mass[sample];
}

template <int D>
void Contacts<D>::restore(const ContactBodies<D>& bodies) {
    expect_pairs_of(bodies);
    contacts_.clear(), pushes_.clear();
    using Two = std::pair<std::int32_t, std::int32_t>;
    std::map<Two, double> points;                  // where two bodies may touch
    std::set<std::pair<Two, std::int32_t>> known;  // of walls: one may be near several bodies
    auto at = [&points](const PairContact& contact) -> double& {
        return points[contact.between()];
    };
    for (const ContactPair& pair : pairs_) {
        contacts_.push_back(contact_of(bodies, pair));
        const PairContact& contact = contacts_.back();
        if (contact.wall < 0 || known.emplace(contact.between(), pair.a).second) at(contact) += 1.0;
    }
    // Those that were near when pairs were found, and may not be the nearest now.
    for (std::size_t k = 0; k < vertices_.size(); ++k) contacts_[k].vertex = vertices_[k];
    vertices_.clear();
    selections_ = {};
    if (apart_)
        select(bodies, PairKind::slow), select(bodies, PairKind::fast);
    else
        select(bodies, PairKind::all);
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const PairContact& contact = contacts_[k];
        // Points of deformable bodies move each on its own, but on a light ball press many.
        const double points = contact.law.rigid                         ? at(contact)
                              : is_light_ball(bodies.points, pairs_[k]) ? 4.0
                                                                        : 1.0;
        const Together together =
            contact.joint ? JointContacts::together(points) : Together{points, points};
        double& step = of(kind_of(k)).timestep;
        step = std::min(step, contact.law.timestep(laws_.speed(), together));
    }
}

template <int D>
PairKind Contacts<D>::kind_of(std::size_t k) const {
    if (!apart_) return PairKind::all;
    const auto [a, b] = std::minmax(contacts_[k].body_a, contacts_[k].body_b);
    return static_cast<std::size_t>(b) < slow_bodies_ ? PairKind::slow : PairKind::fast;
}

template <int D>
void Contacts<D>::select(const ContactBodies<D>& bodies, PairKind kind) {
    Selection& selection = of(kind);
    Array<ContactPair> pairs;
    Array<std::size_t> on_solids;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        if (kind_of(k) != kind) continue;
        selection.rows.push_back(k), pairs.push_back(pairs_[k]);
        if (bodies.solid(pairs_[k])) on_solids.push_back(k);
        if (bodies.surface(pairs_[k])) selection.on_surfaces.push_back(k);
    }
    selection.joint = JointContacts(selection.rows, contacts_, pairs_);
    selection.on_solids = PushesOnSolids(std::move(on_solids), pairs_);
    selection.points = ShownPoints(points_of(pairs), bodies.points);
    list_pushes(selection);
}

template <int D>
void Contacts<D>::keep(Selection& selection) const {
    selection.kept.clear(), selection.springs.clear(), selection.normals.clear();
    for (const std::size_t k : selection.rows) {
        if (springs_[k][rest_overlap] == 0.0 && dot(normals_[k], normals_[k]) == 0.0) continue;
        selection.kept.push_back(k);
        selection.springs.push_back(springs_[k]), selection.normals.push_back(normals_[k]);
    }
}

template <int D>
void Contacts<D>::revert(PairKind kind) {
    const Selection& selection = of(kind);
    for (const std::size_t k : selection.rows) springs_[k] = {}, normals_[k] = {};
    for (std::size_t n = 0; n < selection.kept.size(); ++n) {
        const std::size_t k = selection.kept[n];
        springs_[k] = selection.springs[n], normals_[k] = selection.normals[n];
    }
}

/// Throws std::invalid_argument unless the pairs are pairs of these bodies.
template <int D>
void Contacts<D>::expect_pairs_of(const ContactBodies<D>& bodies) const {
    for (const std::int32_t material : bodies.points.material)
        expect_index(material, laws_.materials(), "body_material");
    for (const ContactSolid<D>& solid : bodies.solids)
        expect_index(solid.material, laws_.materials(), "body_material");
    for (const ContactPair& pair : pairs_) {
        expect_index(pair.a, bodies.points.size(), "contact_a");
        if (pair.with_shape())
            expect_index(pair.shape(), bodies.solids.size() + bodies.surfaces.size(), "contact_b");
        else
            expect_index(pair.b, bodies.points.size(), "contact_b");
    }
    const ContactRows<D> rows{pairs_, {}, {}, {}, {}, {}, domain_};
    for (std::size_t k = 0; k < pairs_.size(); ++k)
        expect_fit(rows.run_from(k) <= SurfacePoints<D>::most, "contact_a");
}

template <int D>
auto Contacts<D>::contact_of(const ContactBodies<D>& bodies, const ContactPair& pair) const
    -> PairContact {
    const ContactPoints<D>& points = bodies.points;
    const ContactSide a = points.side(pair.first());
    const std::int32_t first = points.body[pair.first()];
    if (const Surface<D>* surface = bodies.surface(pair)) {
        const Vec<double, D>& x = points.position[pair.first()];
        return {first, surface->body, laws_.between(a, surface->side()), 0.0,
                surface->nearest_vertex(x, points.outward[pair.first()], domain_)};
    }
    if (pair.with_shape()) {
        const ContactSolid<D>& solid = bodies.solids[pair.shape()];
        PairContact contact{first, solid.body, laws_.between(a, solid.side()), 0.0};
        // A ball pushes a fixed solid at one place, in line with its centre.
        contact.joint = contact.law.rigid && (a.radius == 0.0 || !solid.fixed);
        if (!contact.joint || points.solid[pair.first()] < 0) return contact;
        const ContactSolid<D>& own =
            bodies.solids[static_cast<std::size_t>(points.solid[pair.first()])];
        contact.wall_first = own.wall >= 0;
        contact.wall = contact.wall_first ? own.wall : solid.wall;
        return contact;
    }
    return {first, points.body[pair.second()], laws_.between(a, points.side(pair.second())), 0.0};
}

template <int D>
double Contacts<D>::stored_energy() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < std::min(pushes_.size(), pairs_.size()); ++k)
        if (pushes_[k].touches)
            sum += pushes_[k].share * contacts_[k].law.stored(springs_[k], contacts_[k].overlap);
    return sum;
}

template <int D>
void Contacts<D>::list_pushes(Selection& selection) const {
    const Array<std::int32_t>& points = selection.points.points;
    Array<std::size_t>& first_push = selection.first_push;
    first_push.assign(points.size() + 1, 0);
    auto place = [&points](std::size_t point) {
        return static_cast<std::size_t>(
            std::lower_bound(points.begin(), points.end(), static_cast<std::int32_t>(point)) -
            points.begin());
    };
    auto for_each_side = [&](auto&& f) {
        for (const std::size_t k : selection.rows) {
            f(place(pairs_[k].first()), 2 * k);
            if (!pairs_[k].with_shape()) f(place(pairs_[k].second()), 2 * k + 1);
        }
    };
    for_each_side([&](std::size_t n, std::size_t) { ++first_push[n + 1]; });
    for (std::size_t n = 0; n < points.size(); ++n) first_push[n + 1] += first_push[n];
    selection.pushes_on.resize(first_push.back());
    Array<std::size_t> next = first_push;
    for_each_side([&](std::size_t n, std::size_t side) { selection.pushes_on[next[n]++] = side; });
}

template <int D>
template <class NewPair>
void Contacts<D>::accept_overlaps(ContactBodies<D>& bodies, const NewPair& is_new, bool have_met) {
    const ContactRows<D> all = rows(bodies);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const std::size_t rows = all.run_from(k);
        const bool touches =
            std::any_of(normals_.begin() + static_cast<std::ptrdiff_t>(k),
                        normals_.begin() + static_cast<std::ptrdiff_t>(k + rows),
                        [](const Vec<double, D>& normal) { return dot(normal, normal) > 0.0; });
        if (rows == 0 || !is_new(pairs_[k], touches)) continue;
        const Overlaps<D> overlaps = all.overlaps(k);
        for (std::size_t n = 0; n < std::min(overlaps.size(), rows); ++n) {
            pushes_[k + n].touches = false, contacts_[k + n].overlap = 0.0;
            springs_[k + n] = {}, springs_[k + n][rest_overlap] = overlaps[n].depth;
            normals_[k + n] = have_met ? overlaps[n].normal : Vec<double, D>{};
        }
    }
}

}  // namespace doseki
