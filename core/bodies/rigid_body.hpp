#pragma once
#include <cstdint>

#include "base/array.hpp"
#include "base/error.hpp"
#include "bodies/shapes/shape.hpp"
#include "model/archive.hpp"

namespace doseki {

/// A rigid body, as given at the start.
template <int D>
struct RigidBody {
    std::int32_t shape, material;
    std::int32_t group;        // the [body.NAME] of the scenario that it belongs to
    bool fixed;                // moves only as its wall does
    double mass;               // [kg], 2-D: [kg/m]
    Mat<double, 3> inertia{};  // about the centre, in its own frame; 2-D: zz alone
};

/// What changes of a rigid body; numbers only, so that it can be archived as they are.
template <int D>
struct RigidBodyState {
    Vec<double, D> centre, velocity;
    Quaternion orientation;
    Vec3 angular_momentum;        // of a fixed body, whose inertia is infinite: its spin
    Vec<double, D> acceleration;  // averaged in time, as the fluid sees it
    Vec3 spin_rate;
    Vec<double, D> flow_force;  // of the fluid
    Vec3 flow_torque;
    Vec<double, D> flow_impulse, contact_impulse;  // since the start
    double removed;                                // 1: gone
    double unwetted;  // share of its area that water around it does not see, Eq. (152)

    DOSEKI_DEVICE_FN bool is_removed() const { return removed != 0.0; }
};

/// A particle of a rigid body, in its frame; numbers only, as RigidBodyState.
template <int D>
struct RigidBodyPoint {
    double body;
    Vec<double, D> offset, normal, area;
    Mat<double, D> edge_normals;  // in rows

    DOSEKI_DEVICE_FN std::size_t index() const { return static_cast<std::size_t>(body); }
};

/// Shapes and rigid bodies as one vector for each member, as archives keep them.
template <int D>
struct RigidBodyColumns {
    Array<std::uint8_t> kind;
    Array<double> radius, thickness, mass;
    Array<Vec<double, D>> corners, samples;  // of all shapes in turn
    Array<std::int32_t> facet_count, sample_count, shape, material, group;
    Array<std::uint8_t> fixed;
    Array<Mat<double, 3>> inertia;

    RigidBodyColumns() = default;
    RigidBodyColumns(const Array<Shape<D>>& shapes, const Array<RigidBody<D>>& bodies) {
        for (const Shape<D>& each : shapes) {
            kind.push_back(static_cast<std::uint8_t>(each.kind));
            radius.push_back(each.radius), thickness.push_back(each.thickness);
            for (const auto& facet : each.facets)
                corners.insert(corners.end(), facet.begin(), facet.end());
            samples.insert(samples.end(), each.samples.begin(), each.samples.end());
            facet_count.push_back(static_cast<std::int32_t>(each.facets.size()));
            sample_count.push_back(static_cast<std::int32_t>(each.samples.size()));
        }
        for (const RigidBody<D>& each : bodies) {
            shape.push_back(each.shape), material.push_back(each.material),
                group.push_back(each.group);
            fixed.push_back(each.fixed), mass.push_back(each.mass), inertia.push_back(each.inertia);
        }
    }

    void serialise(Archive& archive) {
        archive("shape_kind", kind), archive("shape_radius", radius),
            archive("shape_thickness", thickness), archive("shape_corners", corners),
            archive("shape_samples", samples);
        archive("shape_facets", facet_count), archive("shape_sample_count", sample_count);
        archive("body_shape", shape), archive("body_material", material),
            archive("body_named", group);
        archive("body_fixed", fixed), archive("body_mass", mass), archive("body_inertia", inertia);
    }

    /// Throws std::invalid_argument unless these are the columns of so many bodies.
    void expect_fit_of(std::size_t bodies) const {
        const std::size_t n = radius.size();
        expect_fit(facet_count.size() == n && sample_count.size() == n && kind.size() == n &&
                       thickness.size() == n,
                   "shape_radius");
        for (std::size_t k = 0; k < n; ++k) {
            expect_index(kind[k], 5, "shape_kind");
            const bool facets = has_facets(static_cast<ShapeKind>(kind[k]));
            expect_fit((facet_count[k] > 0) == facets, "shape_kind");
        }
        expect_parts(facet_count, corners.size(), D, "shape_facets");
        expect_parts(sample_count, samples.size(), 1, "shape_sample_count");
        expect_fit(shape.size() == bodies && material.size() == bodies && group.size() == bodies &&
                       fixed.size() == bodies && mass.size() == bodies && inertia.size() == bodies,
                   "bodies");
        for (const std::int32_t k : shape) expect_index(k, n, "body_shape");
    }

    /// `ground` is that of the run.
    Array<Shape<D>> shapes(const SharedSurface<D>& ground) const {
        Array<Shape<D>> result(radius.size());
        auto corner = corners.begin(), sample = samples.begin();
        for (std::size_t k = 0; k < result.size(); ++k) {
            result[k].kind = static_cast<ShapeKind>(kind[k]);
            result[k].radius = radius[k], result[k].thickness = thickness[k];
            for (int f = 0; f < facet_count[k]; ++f, corner += D) {
                result[k].facets.emplace_back();
                std::copy_n(corner, D, result[k].facets.back().begin());
            }
            result[k].samples.assign(sample, sample + sample_count[k]);
            sample += sample_count[k];
            result[k].enclose(ground);
        }
        return result;
    }

    RigidBody<D> rigid(std::size_t k) const {
        return {shape[k], material[k], group[k], fixed[k] != 0, mass[k], inertia[k]};
    }

private:
    /// That the parts, of `size` elements each, are all there are.
    static void expect_parts(const Array<std::int32_t>& counts, std::size_t all, std::size_t size,
                             const char* name) {
        std::size_t sum = 0;
        for (const std::int32_t count : counts) {
            expect_fit(count >= 0 && static_cast<std::size_t>(count) <= all, name);
            sum += size * static_cast<std::size_t>(count);
        }
        expect_fit(sum == all, name);
    }
};

}  // namespace doseki
