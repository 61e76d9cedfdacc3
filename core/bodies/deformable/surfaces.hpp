#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "bodies/contact_points.hpp"
#include "bodies/deformable/patches.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "bodies/fragments/crack_faces.hpp"
#include "bodies/fragments/outlines.hpp"
#include "bodies/fragments/rigid_motion.hpp"
#include "bodies/fragments/surface_vertex.hpp"
#include "bodies/shapes/shape.hpp"
#include "bodies/surface/carriers.hpp"

namespace doseki {

/// The surfaces of deformable bodies: they show contacts where the points are and hand on what the
/// contacts do. A vertex goes with points around it, as a mean of them with fixed weights: its
/// force is shared with the same weights, so that momentum and angular momentum are kept. In 3-D
/// bodies that break have balls around their outermost points instead, vertices of no surface.
template <int D>
class DeformableSurfaces {
    /// Samples of the curve from one vertex to the next.
    static constexpr int samples = 8;

public:
    /// Contact points of each vertex.
    static constexpr std::size_t points_each = D == 2 ? samples : 1;

    void add(const SurfaceVertex<D>& vertex) { vertices_.push_back(vertex); }
    /// A cell of a body in 2-D by the numbers of its points and vertices among all.
    void add_cell(std::span<const std::uint32_t> nodes) { cells_.add(nodes); }
    std::size_t size() const { return vertices_.size(); }
    /// Body of each surface that contacts have, as they number them.
    Array<std::int32_t> bodies(const TotalLagrangian<D>& solids) const {
        Array<std::int32_t> bodies;
        for (const std::int32_t v : shown_) {
            const std::int32_t body = solids.body(point_of(static_cast<std::size_t>(v)));
            if (bodies.empty() || body != bodies.back()) bodies.push_back(body);
        }
        return bodies;
    }
    /// The vertices that contacts have, in their order: those of bodies that are not rigid.
    const Array<std::int32_t>& shown() const { return shown_; }
    /// Finds the points, which had been numbers of adding, where they are stored.
    void start(const TotalLagrangian<D>& solids) {
        for (std::size_t v = 0; v < vertices_.size(); ++v) {
            SurfaceVertex<D>& vertex = vertices_[v];
            vertex.point = solids.slot(vertex.point);
            if (D == 2) carrier_at_rest_.push_back(vertex.point);
            vertex.key =
                D == 3 ? vertex.point
                       : VertexKey::of_outline(CellNode::outline | static_cast<std::uint32_t>(v));
        }
        cells_.start([&](std::uint32_t number) { return solids.slot(number); });
    }
    /// Where the vertices are, but those of rigid bodies.
    Array<Vec<double, D>> places(const TotalLagrangian<D>& solids) const {
        Array<Vec<double, D>> places;
        for (const auto& [p, offset, crease, radius, key, curve, outward, share] : vertices_)
            places.push_back(is_rigid(p, solids) ? Vec<double, D>{}
                                                 : solids.x[p] + solids.motion_around(p) * offset);
        return places;
    }
    /// Draws the surfaces of the parts of bodies, which the solids have become already; vertices
    /// that there were stay in their `places`. Returns the new number of each, -1 of those that are
    /// no more.
    Array<std::int32_t> divide(const TotalLagrangian<D>& solids, const Division& division,
                               std::span<const std::int32_t> before,
                               const Array<std::uint32_t>& crack,
                               const Array<Vec<double, D>>& places);
    /// The surface of a body as the shape of a rigid one, see DeformableBodies::shape_of: in 2-D a
    /// polygon with two corners for each vertex, one of which is a sample; in 3-D the balls.
    Shape<D> shape_of(const ContactBodies<D>& contact, std::int32_t shown,
                      const TotalLagrangian<D>& solids, std::size_t body,
                      const RigidMotion<D>& motion) const;
    std::size_t first_contact_point() const { return first_contact_point_; }
    /// The number of a contact point after a division, with new numbers of the vertices that had
    /// been shown; `first`: that of the first point of these surfaces before. -1: none.
    std::int32_t renumbered(std::size_t k, std::size_t first,
                            std::span<const std::int32_t> vertex) const {
        if (k < first) return static_cast<std::int32_t>(k);
        const std::size_t sample = k - first;
        const std::int32_t now = vertex[sample / points_each];
        const auto at = std::lower_bound(shown_.begin(), shown_.end(), now);
        if (now < 0 || at == shown_.end() || *at != now) return -1;
        const auto number = static_cast<std::size_t>(at - shown_.begin());
        return static_cast<std::int32_t>(first_contact_point_ + number * points_each +
                                         sample % points_each);
    }
    /// Adds surfaces to those that may touch, with the points at which they do; `first_body` is the
    /// number of the first of these bodies among all bodies that touch, `material` that of each.
    void add_to(ContactBodies<D>& contact, std::int32_t first_body,
                const TotalLagrangian<D>& solids, const Array<std::int32_t>& material);
    /// Shows the contacts where the points are.
    void show(ContactBodies<D>& contact, const TotalLagrangian<D>& solids) const;
    /// Shows from now on what these contact points, which may touch something, and what touches
    /// them may need. In 2-D that is everything.
    void choose(const ContactBodies<D>& contact, std::span<const std::int32_t> touching);
    void choose_all() {
        auto all = [](Array<std::uint32_t>& numbers, std::size_t count) {
            numbers.resize(count);
            std::iota(numbers.begin(), numbers.end(), 0u);
        };
        all(chosen_, shown_.size()), all(chosen_samples_, samples_.size());
        all(chosen_patches_, patches_.size());
    }
    /// Takes the forces of the contacts.
    void collect(ContactBodies<D>& contact, TotalLagrangian<D>& solids) const;

    void serialise(Archive& archive, const TotalLagrangian<D>& solids) {
        Array<std::uint32_t> point, curve;
        Array<Vec<double, D>> offset, outward;
        Array<std::uint8_t> crease;
        Array<double> radius, share;
        Array<std::uint64_t> key;
        for (const SurfaceVertex<D>& vertex : vertices_)
            point.push_back(vertex.point), offset.push_back(vertex.offset),
                crease.push_back(vertex.crease), radius.push_back(vertex.radius),
                key.push_back(vertex.key), curve.push_back(vertex.curve),
                outward.push_back(vertex.outward), share.push_back(vertex.share);
        archive("surface_point", point), archive("surface_offset", offset),
            archive("surface_crease", crease), archive("surface_radius", radius),
            archive("surface_key", key), archive("surface_curve", curve),
            archive("surface_outward", outward), archive("surface_share", share),
            archive("surface_at_rest", carrier_at_rest_);
        if (archive.loads()) {
            const std::size_t n = point.size();
            expect_fit(offset.size() == n && crease.size() == n && radius.size() == n &&
                           key.size() == n && curve.size() == n && outward.size() == n &&
                           share.size() == n,
                       "surface_point");
            vertices_.clear();
            for (std::size_t v = 0; v < n; ++v) {
                expect_index(point[v], solids.size(), "surface_point");
                expect_fit(radius[v] >= 0.0, "surface_radius");
                expect_fit(share[v] >= 0.0, "surface_share");
                vertices_.push_back({point[v], offset[v], crease[v], radius[v], key[v], curve[v],
                                     outward[v], share[v]});
            }
            for (const std::uint32_t p : carrier_at_rest_)
                expect_index(p, solids.size(), "surface_at_rest");
        }
        cells_.serialise(archive, solids.size(), carrier_at_rest_.size());
    }

private:
    /// A contact point: where it lies on a surface, counted from the surface's first vertex.
    struct Sample {
        std::size_t surface;
        SurfaceWeights at;
    };

    template <class InFrame>
    static void add_polygon(const Surface<D>& surface, std::size_t curve, double least,
                            const InFrame& in_frame, Shape<D>& shape);
    std::size_t point_of(std::size_t v) const { return vertices_[v].point; }
    static bool is_rigid(std::size_t p, const TotalLagrangian<D>& solids) {
        return solids.is_rigid(static_cast<std::size_t>(solids.body(p)));
    }
    const SurfaceVertex<D>& shown_vertex(std::size_t n) const {
        return vertices_[static_cast<std::size_t>(shown_[n])];
    }
    Vec<double, D> rest(std::size_t n, const TotalLagrangian<D>& solids) const {
        return solids.rest_position(shown_vertex(n).point) + shown_vertex(n).offset;
    }
    /// Of a vertex that is shown, now; zero of a ball.
    Vec<double, D> normal(std::size_t n, const TotalLagrangian<D>& solids) const {
        const Vec<double, D> turned =
            cofactors(carriers_[n].motion(solids.x)) * shown_vertex(n).outward;
        const double length = norm(turned);
        return length > 0.0 ? (1.0 / length) * turned : turned;
    }
    void add_sample(ContactBodies<D>& contact, const Sample& sample, const ContactSide& side);
    void add_samples(ContactBodies<D>& contact, std::size_t surface,
                     const TotalLagrangian<D>& solids);
    void add_shown(Surface<D>& surface, std::size_t v, bool begins,
                   const TotalLagrangian<D>& solids);
    void connect(Surface<D>& surface, std::size_t first, const TotalLagrangian<D>& solids) const;

    bool same_curve(std::size_t v, std::size_t w, const TotalLagrangian<D>& solids) const {
        return solids.body(point_of(v)) == solids.body(point_of(w)) &&
               vertices_[v].curve == vertices_[w].curve;
    }
    Array<PlacedVertex> parts_of(const TotalLagrangian<D>& solids, const Division& division,
                                 std::span<const std::int32_t> before,
                                 const Array<Vec<double, D>>& places) const;

    Array<SurfaceVertex<D>> vertices_;      // those of a curve, and of a body, one after another
    Array<std::uint32_t> carrier_at_rest_;  // 2-D: of each vertex that there was at the start
    Cells cells_;
    Array<std::int32_t> shown_;  // see shown(); what follows is of those alone, in their order
    Array<SurfaceCarriers<D>> carriers_;
    Array<std::uint32_t> patch_of_;  // around the point of each
    Array<Patch<D>> patches_;
    Array<std::size_t> first_vertex_;  // of each surface, and the end
    Array<Sample> samples_;
    std::size_t first_contact_point_ = 0;
    Array<std::uint32_t> surface_of_;                                // of each vertex
    Array<std::uint32_t> chosen_, chosen_samples_, chosen_patches_;  // see choose()
};

template <int D>
void DeformableSurfaces<D>::add_to(ContactBodies<D>& contact, std::int32_t first_body,
                                   const TotalLagrangian<D>& solids,
                                   const Array<std::int32_t>& material) {
    first_contact_point_ = contact.points.size();
    carriers_.clear(), patches_.clear(), first_vertex_.clear(), samples_.clear(), shown_.clear();
    surface_of_.clear(), patch_of_.clear();
    VertexCarriers<D> carriers(solids);
    std::map<std::size_t, std::uint32_t> patch_around;  // a point
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        const std::size_t k = point_of(v);
        if (is_rigid(k, solids)) continue;
        const std::int32_t body = solids.body(k);
        const bool begins =
            shown_.empty() || body != solids.body(shown_vertex(shown_.size() - 1).point);
        shown_.push_back(static_cast<std::int32_t>(v));
        surface_of_.push_back(static_cast<std::uint32_t>(contact.surfaces.size() - !begins));
        if (begins) {
            first_vertex_.push_back(shown_.size() - 1);
            Surface<D>& surface = contact.surfaces.emplace_back();
            surface.body = first_body + body;
            surface.material = material[static_cast<std::size_t>(body)];
            surface.mass = solids.mass(k), surface.spacing = solids.body_of(k).spacing;
        }
        add_shown(contact.surfaces.back(), v, begins, solids);
        if (vertices_[v].radius > 0.0)
            carriers_.push_back({{{vertices_[v].point, 1.0}}, {}});
        else
            carriers_.push_back(carriers.of(vertices_[v].point, vertices_[v].offset));
        const auto next = static_cast<std::uint32_t>(patches_.size());
        const auto [patch, is_new] = patch_around.try_emplace(k, next);
        if (is_new) patches_.emplace_back(solids.neighbours_of(k));
        patch_of_.push_back(patch->second);
    }
    first_vertex_.push_back(shown_.size());
    for (std::size_t s = 0; s < contact.surfaces.size(); ++s) {
        if constexpr (D == 3) connect(contact.surfaces[s], first_vertex_[s], solids);
        add_samples(contact, s, solids);
    }
    choose_all();
}

template <int D>
void DeformableSurfaces<D>::add_shown(Surface<D>& surface, std::size_t v, bool begins,
                                      const TotalLagrangian<D>& solids) {
    const SurfaceVertex<D>& vertex = vertices_[v];
    if constexpr (D == 2) {
        if (begins || !same_curve(v, v - 1, solids)) surface.begin_curve();
        surface.add(vertex.crease != 0);
    } else {
        surface.add(vertex.share);
    }
}

template <int D>
void DeformableSurfaces<D>::connect(Surface<D>& surface, std::size_t first,
                                    const TotalLagrangian<D>& solids) const {
    Array<Vec<double, D>> places, outward;
    for (std::size_t v = 0; v < surface.size(); ++v)
        places.push_back(rest(first + v, solids)),
            outward.push_back(shown_vertex(first + v).outward);
    surface.connect(places, outward);
}

template <int D>
void DeformableSurfaces<D>::add_samples(ContactBodies<D>& contact, std::size_t s,
                                        const TotalLagrangian<D>& solids) {
    const Surface<D>& surface = contact.surfaces[s];
    const std::size_t first = first_vertex_[s];
    auto clamped = [&](std::uint32_t v) { return solids.clamped(shown_vertex(first + v).point); };
    ContactSide side = surface.side();
    side.flat = false;
    for (std::uint32_t v = 0; v < surface.size(); ++v) {
        if constexpr (D == 3) {
            const SurfaceVertex<D>& vertex = shown_vertex(first + v);
            const bool ball = vertex.radius > 0.0;
            side.radius = vertex.radius, side.share = ball ? 1.0 : vertex.share;
            side.mass = side.share * surface.mass, side.fixed = clamped(v);
            add_sample(contact, {s, {{v, v, v, v}, {1.0, 0.0, 0.0, 0.0}}}, side);
            if (!ball) contact.points.surface.back() = static_cast<std::int32_t>(s);
        } else {
            const auto part = rest(first + surface.after(v, 1), solids) - rest(first + v, solids);
            side.share = norm(part) / surface.spacing / samples;
            side.mass = side.share * surface.mass;
            for (int n = 0; n < samples; ++n) {
                const SurfaceWeights at = surface.at(v, (n + 0.5) / samples);
                side.fixed = false;
                for (const std::uint32_t vertex : at.vertex) side.fixed |= clamped(vertex);
                add_sample(contact, {s, at}, side);
                contact.points.surface.back() = static_cast<std::int32_t>(s);
            }
        }
    }
}

template <int D>
void DeformableSurfaces<D>::add_sample(ContactBodies<D>& contact, const Sample& sample,
                                       const ContactSide& side) {
    contact.points.add(contact.surfaces[sample.surface].body, side);
    samples_.push_back(sample);
}

template <int D>
void DeformableSurfaces<D>::choose(const ContactBodies<D>& contact,
                                   std::span<const std::int32_t> touching) {
    choose_all();
    if constexpr (D == 3) {
        Array<std::uint8_t> needed(shown_.size(), 0), touches(samples_.size(), 0),
            around(patches_.size(), 0);
        for (const std::int32_t c : touching) {
            if (static_cast<std::size_t>(c) < first_contact_point_) continue;
            const std::size_t n = static_cast<std::size_t>(c) - first_contact_point_;
            const std::size_t first = first_vertex_[surface_of_[n]];
            needed[n] = touches[n] = 1;
            for (const std::uint32_t v : contact.surfaces[surface_of_[n]].around(n - first))
                needed[first + v] = 1;
        }
        auto keep = [](Array<std::uint32_t>& numbers, const Array<std::uint8_t>& kept) {
            std::size_t count = 0;
            for (const std::uint32_t n : numbers)
                if (kept[n]) numbers[count++] = n;
            numbers.resize(count);
        };
        keep(chosen_, needed), keep(chosen_samples_, touches);
        for (const std::uint32_t n : chosen_) around[patch_of_[n]] = 1;
        keep(chosen_patches_, around);
    }
}

template <int D>
void DeformableSurfaces<D>::show(ContactBodies<D>& contact,
                                 const TotalLagrangian<D>& solids) const {
    Array<Vec3> spin(patches_.size());
    for_each_contact(chosen_patches_.size(), [&](std::size_t k) {
        const std::uint32_t patch = chosen_patches_[k];
        spin[patch] = patches_[patch].spin(solids.x, solids.v);
    });
    for_each_contact(chosen_.size(), [&](std::size_t k) {
        const std::uint32_t n = chosen_[k];
        Surface<D>& surface = contact.surfaces[surface_of_[n]];
        const std::size_t v = n - first_vertex_[surface_of_[n]];
        Vec<double, D> x{}, u{};
        for (const auto& [p, share] : carriers_[n].shares)
            x = x + share * solids.x[p], u = u + share * solids.v[p];
        surface.position[v] = x, surface.velocity[v] = u;
        surface.spin[v] = spin[patch_of_[n]];
        surface.force[v] = {}, surface.torque[v] = {};
        if constexpr (D == 3) surface.normal[v] = normal(n, solids);
    });
    ContactPoints<D>& points = contact.points;
    for_each_contact(chosen_samples_.size(), [&](std::size_t n) {
        const std::size_t k = chosen_samples_[n], c = first_contact_point_ + k;
        const auto& [s, at] = samples_[k];
        const Surface<D>& surface = contact.surfaces[s];
        points.position[c] = surface.mean(surface.position, at);
        points.velocity[c] = surface.mean(surface.velocity, at);
        points.spin[c] = surface.spin[at.nearest()];
        points.force[c] = {}, points.torque[c] = {};
        if constexpr (D == 3) points.outward[c] = surface.normal[at.vertex[0]];
    });
}

/// A moment goes to the points around.
template <int D>
void DeformableSurfaces<D>::collect(ContactBodies<D>& contact, TotalLagrangian<D>& solids) const {
    for (const std::uint32_t k : chosen_samples_) {
        const std::size_t c = first_contact_point_ + k;
        contact.surfaces[samples_[k].surface].push(samples_[k].at, contact.points.force[c],
                                                   contact.points.torque[c]);
    }
    for (const std::uint32_t p : solids.stepped().points()) solids.load[p] = {};
    Array<Vec3> moment(patches_.size(), Vec3{});
    for (const std::uint32_t n : chosen_) {
        const Surface<D>& surface = contact.surfaces[surface_of_[n]];
        const std::size_t v = n - first_vertex_[surface_of_[n]];
        for (const auto& [p, share] : carriers_[n].shares)
            solids.load[p] = solids.load[p] + share * surface.force[v];
        moment[patch_of_[n]] = moment[patch_of_[n]] + surface.torque[v];
    }
    for (const std::uint32_t patch : chosen_patches_)
        if (norm(moment[patch]) > 0.0)
            patches_[patch].add_moment(moment[patch], solids.x, solids.load);
}

}  // namespace doseki
