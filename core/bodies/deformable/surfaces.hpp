#pragma once
#include <cstdint>

#include "base/array.hpp"
#include "base/error.hpp"
#include "bodies/contact_points.hpp"
#include "bodies/deformable/patches.hpp"
#include "bodies/deformable/total_lagrangian.hpp"

namespace doseki {

/// A vertex of a surface: which point carries it along, and its place at rest from there.
template <int D>
struct SurfaceVertex {
    std::uint32_t point;
    Vec<double, D> offset;
    std::uint8_t crease;
};

/// The surfaces of deformable bodies: they show contacts where the points are and hand on what the
/// contacts do. A vertex goes with its point by the point's deformation gradient, x + F (offset),
/// which is a mean of points with fixed weights: its force is shared with the same weights, so that
/// momentum and angular momentum are kept.
template <int D>
class DeformableSurfaces {
public:
    void add(const SurfaceVertex<D>& vertex) { vertices_.push_back(vertex); }
    /// Finds the points, which had been numbers of adding, where they are stored.
    void start(const TotalLagrangian<D>& solids) {
        for (SurfaceVertex<D>& vertex : vertices_) vertex.point = solids.slot(vertex.point);
    }
    /// Adds surfaces to those that may touch, with the points at which they do; `first_body` is the
    /// number of the first of these bodies among all bodies that touch, `material` that of each.
    void add_to(ContactBodies<D>& contact, std::int32_t first_body,
                const TotalLagrangian<D>& solids, const Array<std::int32_t>& material);
    /// Shows the contacts where the points are.
    void show(ContactBodies<D>& contact, const TotalLagrangian<D>& solids) const;
    /// Takes the forces of the contacts.
    void collect(ContactBodies<D>& contact, TotalLagrangian<D>& solids) const;

    void serialise(Archive& archive, const TotalLagrangian<D>& solids) {
        Array<std::uint32_t> point;
        Array<Vec<double, D>> offset;
        Array<std::uint8_t> crease;
        for (const SurfaceVertex<D>& vertex : vertices_)
            point.push_back(vertex.point), offset.push_back(vertex.offset),
                crease.push_back(vertex.crease);
        archive("surface_point", point), archive("surface_offset", offset),
            archive("surface_crease", crease);
        if (archive.loads()) {
            expect_fit(offset.size() == point.size() && crease.size() == point.size(),
                       "surface_point");
            vertices_.clear();
            for (std::size_t v = 0; v < point.size(); ++v) {
                expect_index(point[v], solids.size(), "surface_point");
                vertices_.push_back({point[v], offset[v], crease[v]});
            }
        }
    }

private:
    /// A contact point: where it lies on a surface, counted from the surface's first vertex.
    struct Sample {
        std::size_t surface;
        SurfaceWeights at;
    };
    /// Samples of the curve from one vertex to the next.
    static constexpr int samples = 8;

    std::size_t point_of(std::size_t v) const { return vertices_[v].point; }
    Vec<double, D> rest(std::size_t v, const TotalLagrangian<D>& solids) const {
        return solids.rest_position(point_of(v)) + vertices_[v].offset;
    }
    void add_sample(ContactBodies<D>& contact, const Sample& sample, const ContactSide& side);
    void add_samples(ContactBodies<D>& contact, std::size_t surface,
                     const TotalLagrangian<D>& solids);

    Array<SurfaceVertex<D>> vertices_;  // those of a body one after another
    Array<Array<PointShare>> carriers_;
    Array<Patch<D>> patches_;          // around the point of each
    Array<std::size_t> first_vertex_;  // of each surface, and the end
    Array<Sample> samples_;
    std::size_t first_contact_point_ = 0;
};

template <int D>
void DeformableSurfaces<D>::add_to(ContactBodies<D>& contact, std::int32_t first_body,
                                   const TotalLagrangian<D>& solids,
                                   const Array<std::int32_t>& material) {
    first_contact_point_ = contact.points.size();
    carriers_.clear(), patches_.clear(), first_vertex_.clear(), samples_.clear();
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        const std::size_t k = point_of(v);
        const std::int32_t body = solids.body(k);
        if (v == 0 || body != solids.body(point_of(v - 1))) {
            first_vertex_.push_back(v);
            Surface<D>& surface = contact.surfaces.emplace_back();
            surface.body = first_body + body;
            surface.material = material[static_cast<std::size_t>(body)];
            surface.mass = solids.mass(k), surface.spacing = solids.body_of(k).spacing;
        }
        contact.surfaces.back().add(vertices_[v].crease != 0);
        carriers_.push_back(solids.carriers(k, vertices_[v].offset));
        patches_.emplace_back(solids.neighbours_of(k));
    }
    first_vertex_.push_back(vertices_.size());
    for (std::size_t s = 0; s < contact.surfaces.size(); ++s) add_samples(contact, s, solids);
}

template <int D>
void DeformableSurfaces<D>::add_samples(ContactBodies<D>& contact, std::size_t s,
                                        const TotalLagrangian<D>& solids) {
    const Surface<D>& surface = contact.surfaces[s];
    const std::size_t first = first_vertex_[s];
    auto clamped = [&](std::uint32_t v) { return solids.clamped(point_of(first + v)); };
    ContactSide side = surface.side();
    side.flat = false;
    for (std::uint32_t v = 0; v < surface.size(); ++v) {
        if constexpr (D == 3) {
            side.radius = 0.5 * surface.spacing, side.share = 1.0, side.fixed = clamped(v);
            add_sample(contact, {s, {{v, v, v, v}, {1.0, 0.0, 0.0, 0.0}}}, side);
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
void DeformableSurfaces<D>::show(ContactBodies<D>& contact,
                                 const TotalLagrangian<D>& solids) const {
    for (std::size_t s = 0; s < contact.surfaces.size(); ++s) {
        Surface<D>& surface = contact.surfaces[s];
        for (std::size_t v = 0; v < surface.size(); ++v) {
            Vec<double, D> x{}, u{};
            for (const auto& [p, share] : carriers_[first_vertex_[s] + v])
                x = x + share * solids.x[p], u = u + share * solids.v[p];
            surface.position[v] = x, surface.velocity[v] = u;
            surface.spin[v] = patches_[first_vertex_[s] + v].spin(solids.x, solids.v);
            surface.force[v] = {}, surface.torque[v] = {};
        }
    }
    ContactPoints<D>& points = contact.points;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
        const auto& [s, at] = samples_[k];
        const Surface<D>& surface = contact.surfaces[s];
        const std::size_t c = first_contact_point_ + k;
        points.position[c] = surface.mean(surface.position, at);
        points.velocity[c] = surface.mean(surface.velocity, at);
        points.spin[c] = surface.spin[at.nearest()];
        points.force[c] = {}, points.torque[c] = {};
    }
}

/// A moment goes to the points around.
template <int D>
void DeformableSurfaces<D>::collect(ContactBodies<D>& contact, TotalLagrangian<D>& solids) const {
    for (std::size_t k = 0; k < samples_.size(); ++k) {
        const std::size_t c = first_contact_point_ + k;
        contact.surfaces[samples_[k].surface].push(samples_[k].at, contact.points.force[c],
                                                   contact.points.torque[c]);
    }
    std::fill(solids.load.begin(), solids.load.end(), Vec<double, D>{});
    for (std::size_t s = 0; s < contact.surfaces.size(); ++s) {
        const Surface<D>& surface = contact.surfaces[s];
        for (std::size_t v = 0; v < surface.size(); ++v) {
            for (const auto& [p, share] : carriers_[first_vertex_[s] + v])
                solids.load[p] = solids.load[p] + share * surface.force[v];
            if (norm(surface.torque[v]) > 0.0)
                patches_[first_vertex_[s] + v].add_moment(surface.torque[v], solids.x, solids.load);
        }
    }
}

}  // namespace doseki
