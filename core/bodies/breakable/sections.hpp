#pragma once
// How forces bend a slender body.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "base/array.hpp"
#include "base/matrix.hpp"
#include "bodies/elastic/principal.hpp"
#include "bodies/rotation.hpp"

namespace doseki {

/// A force on a body, and where, from its centre, both in its own frame.
struct PlacedForce {
    Vec3 place, force;
};

/// What lies on one side of a cut through a body: mass, and its first and second moments.
struct MassMoments {
    double mass = 0.0;
    Vec3 first{};
    Mat<double, 3> second{};

    void add(double m, const Vec3& r) {
        mass += m, first = first + m * r;
        add_outer(second, m, r, r);
    }
    /// Inertia about the centre.
    Mat<double, 3> inertia() const {
        const double trace = second(0, 0) + second(1, 1) + second(2, 2);
        return trace * identity<double, 3>() - second;
    }
};

/// A cut across an axis of a body.
struct Section {
    Vec3 axis;
    double at;    // along the axis [m]
    Vec3 middle;  // of the points that it goes through
    double area;  // [m^2], 2-D: [m]
    // Along the two other axes: the outermost distance over the second moment of area [1/m^3], 2-D:
    // [1/m^2].
    std::array<Vec3, 2> across;
    std::array<double, 2> fibre;
    MassMoments beyond;

    /// Largest tension, as in a beam, of a body with the acceleration and the rate of spin that
    /// forces on it make.
    double tension(std::span<const PlacedForce> forces, const Vec3& acceleration,
                   const Vec3& turning) const {
        const Vec3 carried = beyond.mass * acceleration + cross(turning, beyond.first);
        Vec3 pull = -1.0 * carried;
        Vec3 moment =
            cross(middle, carried) - cross(beyond.first, acceleration) - beyond.inertia() * turning;
        for (const PlacedForce& each : forces) {
            if (!(dot(each.place, axis) > at)) continue;
            pull = pull + each.force;
            moment = moment + cross(each.place - middle, each.force);
        }
        const Vec3 bent = cross(axis, moment);
        double tension = dot(pull, axis) / area;
        for (int a = 0; a < 2; ++a) tension += fibre[a] * std::abs(dot(bent, across[a]));
        return tension;
    }
};

/// Points of a body from its centre, with their masses, each of which fills a cube.
struct MassPoints {
    std::span<const Vec3> place;
    std::span<const double> mass;
    double spacing;  // [m]
    int dim;
};

/// The cuts across the long axes of a body, a spacing apart; none through a compact one.
class Sections {
public:
    Sections() = default;

    /// The frame of the body, in columns, chooses where several axes would do.
    Sections(const MassPoints& points, const Mat<double, 3>& frame) {
        constexpr double slender = 1.5;  // length over thickness
        for (std::size_t k = 0; k < points.place.size(); ++k)
            all_.add(points.mass[k], points.place[k]);
        if (!(all_.mass > 0.0)) return;
        const std::array<Vec3, 3> axes = principal_axes(frame);
        auto square = [&](const Vec3& axis) { return dot(axis, all_.second * axis); };
        const double least = square(axes[points.dim - 1]);
        for (int a = 0; a + 1 < points.dim; ++a)
            if (square(axes[a]) > slender * slender * least)
                cut(points, axes[a], {axes[(a + 1) % 3], axes[(a + 2) % 3]});
    }

    bool any() const { return !sections_.empty(); }
    /// Outermost distance over the radius of gyration, the most of all cuts.
    double fibre() const { return fibre_; }
    /// Volume of what is as long as thick, the least of all cuts [m^3], 2-D: [m^2].
    double cube() const { return cube_; }
    /// A bound on tension(), for forces of which the sizes have this sum.
    double most_tension(double force) const { return most_per_force_ * force; }
    /// The largest tension of bending and of pulling.
    double tension(std::span<const PlacedForce> forces) const {
        if (!any()) return 0.0;
        Vec3 sum{}, moment{};
        for (const PlacedForce& each : forces)
            sum = sum + each.force, moment = moment + cross(each.place, each.force);
        const Vec3 acceleration = (1.0 / all_.mass) * sum;
        const Vec3 turning = inverse(all_.inertia(), 0.0) * moment;
        double largest = 0.0;
        for (const Section& section : sections_)
            largest = std::max(largest, section.tension(forces, acceleration, turning));
        return largest;
    }

private:
    /// From the longest to the shortest; in 2-D the third is normal to the plane.
    std::array<Vec3, 3> principal_axes(const Mat<double, 3>& frame) const {
        // Near one column each, and normal to no other.
        const Vec3 first = frame * Vec3{{1.0, 1e-3, 1e-6}}, next = frame * Vec3{{1e-6, 1.0, 1e-3}};
        Sym<double, 3> second{};
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) second(a, b) = all_.second(a, b);
        const auto longest = largest_principal(second, first);
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b)
                second(a, b) -= longest.value * longest.direction[a] * longest.direction[b];
        const Vec3 middle = largest_principal(second, next).direction;
        return {longest.direction, middle, cross(longest.direction, middle)};
    }
    void cut(const MassPoints& points, const Vec3& axis, const std::array<Vec3, 2>& across) {
        constexpr double end = 1.5;  // spacings from an end, within which nothing bends
        double low = 0.0, high = 0.0;
        for (const Vec3& r : points.place)
            low = std::min(low, dot(r, axis)), high = std::max(high, dot(r, axis));
        low -= 0.5 * points.spacing, high += 0.5 * points.spacing;
        for (double at = low + end * points.spacing; at <= high - end * points.spacing;
             at += points.spacing) {
            Section section{axis, at, {}, 0.0, across, {}, {}};
            const double outermost = measure(section, points);
            if (!(section.area > 0.0)) continue;
            sections_.push_back(section);
            const double arm = std::max(std::min(at - low, high - at), outermost),
                         fibre = std::max(section.fibre[0], section.fibre[1]);
            fibre_ = std::max(fibre_, std::sqrt(fibre * outermost * section.area));
            cube_ = std::min(cube_, 2.0 * outermost * section.area);
            most_per_force_ = std::max(most_per_force_, 2.0 * (1.0 / section.area + arm * fibre));
        }
    }
    /// Returns how far from its middle the cut reaches, along the axes across [m].
    static double measure(Section& section, const MassPoints& points) {
        const double spacing = points.spacing, each = points.dim == 2 ? spacing : spacing * spacing;
        auto is_cut = [&](const Vec3& r) {
            return std::abs(dot(r, section.axis) - section.at) < 0.5 * spacing;
        };
        for (std::size_t k = 0; k < points.place.size(); ++k) {
            const Vec3& r = points.place[k];
            if (dot(r, section.axis) > section.at) section.beyond.add(points.mass[k], r);
            if (is_cut(r)) section.area += each, section.middle = section.middle + each * r;
        }
        if (!(section.area > 0.0)) return 0.0;
        section.middle = (1.0 / section.area) * section.middle;
        double farthest = 0.0;
        for (int a = 0; a + 1 < points.dim; ++a) {
            double moment = 0.0, outermost = 0.0;
            for (const Vec3& r : points.place) {
                if (!is_cut(r)) continue;
                const double y = dot(r - section.middle, section.across[a]);
                moment += each * (y * y + spacing * spacing / 12.0);
                outermost = std::max(outermost, std::abs(y));
            }
            outermost += 0.5 * spacing;
            section.fibre[a] = outermost / moment, farthest = std::max(farthest, outermost);
        }
        return farthest;
    }

    MassMoments all_;
    Array<Section> sections_;
    double most_per_force_ = 0.0;  // [1/m^2], 2-D: [1/m]
    double fibre_ = 0.0, cube_ = std::numeric_limits<double>::infinity();
};

}  // namespace doseki
