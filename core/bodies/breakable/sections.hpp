#pragma once
// How forces bend a body, and its spin pulls at it.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
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

/// What the forces on a body and its spin make of it, in its own frame.
struct BodyMotion {
    Vec3 acceleration, turning, spin;  // of the centre; rate of the spin
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

    /// Largest tension, as in a beam.
    double tension(std::span<const PlacedForce> forces, const BodyMotion& motion) const {
        const auto& [acceleration, turning, spin] = motion;
        const Vec3 carried = beyond.mass * acceleration + cross(turning, beyond.first) +
                             cross(spin, cross(spin, beyond.first));
        Vec3 pull = -1.0 * carried;
        Vec3 moment = cross(middle, carried) - cross(beyond.first, acceleration) -
                      beyond.inertia() * turning - cross(beyond.second * spin, spin);
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

/// The cuts across the axes of a body, a spacing apart, but for those along which it is so short
/// for its thickness that nothing bends it.
class Sections {
public:
    Sections() = default;

    /// The frame of the body, in columns, chooses where several axes would do.
    Sections(const MassPoints& points, const Mat<double, 3>& frame) {
        for (std::size_t k = 0; k < points.place.size(); ++k)
            all_.add(points.mass[k], points.place[k]);
        if (!(all_.mass > 0.0)) return;
        const std::array<Vec3, 3> axes = principal_axes(frame);
        auto length = [&](int a) { return std::sqrt(dot(axes[a], all_.second * axes[a])); };
        round_ = is_round(points);
        const int shortest = points.dim - 1;
        for (int a = 0; a < points.dim; ++a) {
            const double thickness = length(a < shortest ? shortest : shortest - 1);
            const int next = (a + 1) % points.dim;  // in 2-D the other one of the plane
            if (length(a) * slender > thickness)
                cut(points, axes[a], {axes[next], axes[3 - a - next]},
                    length(a) > slender * thickness);
        }
    }

    /// Not a disc or ball: all that presses on one goes through its centre.
    bool bends() const { return !round_; }
    /// Whether it is longer than thick, as beams are.
    bool is_long() const { return long_fibre_ > 0.0; }
    /// Outermost distance over the radius of gyration, the most of all cuts across long axes, or of
    /// all where it has none.
    double fibre() const { return is_long() ? long_fibre_ : fibre_; }
    /// Volume of what is as long as thick, the least of those cuts [m^3], 2-D: [m^2].
    double cube() const { return cube_; }
    /// A bound on tension(), for forces of which the sizes have this sum.
    double most_tension(double force, const Vec3& spin) const {
        return (bends() ? most_per_force_ * force : 0.0) + most_per_spin_ * dot(spin, spin);
    }
    /// The largest tension of bending and of pulling; of what does not bend, by its spin alone.
    double tension(std::span<const PlacedForce> forces, const Vec3& spin) const {
        if (sections_.empty()) return 0.0;
        if (!bends()) forces = {};
        Vec3 sum{}, moment{};
        for (const PlacedForce& each : forces)
            sum = sum + each.force, moment = moment + cross(each.place, each.force);
        const Mat<double, 3> inertia = all_.inertia();
        const Vec3 gyration = cross(spin, inertia * spin);
        const BodyMotion motion{(1.0 / all_.mass) * sum,
                                inverse(inertia, 0.0) * (moment - gyration), spin};
        double largest = 0.0;
        for (const Section& section : sections_)
            largest = std::max(largest, section.tension(forces, motion));
        return largest;
    }

private:
    static constexpr double slender = 1.5;  // length over thickness

    /// Whether it reaches hardly farther than a disc or ball as large.
    static bool is_round(const MassPoints& points) {
        constexpr double most = 1.12;  // radii; a hexagon 1.1, a square 1.25
        const double count = static_cast<double>(points.place.size());
        const double radius =
            points.spacing * (points.dim == 2 ? std::sqrt(count / std::numbers::pi)
                                              : std::cbrt(0.75 * count / std::numbers::pi));
        double farthest = 0.0;
        for (const Vec3& r : points.place) farthest = std::max(farthest, norm(r));
        return farthest + 0.5 * points.spacing < most * radius;
    }
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
    void cut(const MassPoints& points, const Vec3& axis, const std::array<Vec3, 2>& across,
             bool is_long) {
        constexpr double end = 1.5;         // spacings from an end, within which nothing bends
        constexpr double short_beam = 1.3;  // of a block as long as thick more than of a beam
        double low = 0.0, high = 0.0;
        for (const Vec3& r : points.place)
            low = std::min(low, dot(r, axis)), high = std::max(high, dot(r, axis));
        low -= 0.5 * points.spacing, high += 0.5 * points.spacing;
        for (double at = low + end * points.spacing; at <= high - end * points.spacing;
             at += points.spacing) {
            Section section{axis, at, {}, 0.0, across, {}, {}};
            const auto [outermost, over_gyration] = measure(section, points);
            if (!(section.area > 0.0)) continue;
            if (!is_long)
                section.fibre = {short_beam * section.fibre[0], short_beam * section.fibre[1]};
            sections_.push_back(section);
            const double arm = std::max(std::min(at - low, high - at), outermost),
                         fibre = std::max(section.fibre[0], section.fibre[1]);
            most_per_force_ = std::max(most_per_force_, 2.0 * (1.0 / section.area + arm * fibre));
            most_per_spin_ = std::max(most_per_spin_, pull_of_spin(section, fibre));
            fibre_ = std::max(fibre_, over_gyration);
            if (!is_long) continue;
            long_fibre_ = std::max(long_fibre_, over_gyration);
            cube_ = std::min(cube_, 2.0 * outermost * section.area);
        }
    }
    /// A bound on the tension that a unit of spin makes, which changes by no more than its square
    /// where nothing acts.
    double pull_of_spin(const Section& section, double fibre) const {
        const double first = norm(section.beyond.first);
        double second = 0.0;
        for (int a = 0; a < 3; ++a) second += all_.second(a, a);
        return 2.0 * first / section.area + 4.0 * fibre * (norm(section.middle) * first + second);
    }
    /// How far from its middle a cut reaches along the axes across [m], and the most that this is
    /// over the radius of gyration along one of them.
    struct Reach {
        double farthest = 0.0, over_gyration = 0.0;
    };
    static Reach measure(Section& section, const MassPoints& points) {
        const double spacing = points.spacing, each = points.dim == 2 ? spacing : spacing * spacing;
        auto is_cut = [&](const Vec3& r) {
            return std::abs(dot(r, section.axis) - section.at) < 0.5 * spacing;
        };
        for (std::size_t k = 0; k < points.place.size(); ++k) {
            const Vec3& r = points.place[k];
            if (dot(r, section.axis) > section.at) section.beyond.add(points.mass[k], r);
            if (is_cut(r)) section.area += each, section.middle = section.middle + each * r;
        }
        if (!(section.area > 0.0)) return {};
        section.middle = (1.0 / section.area) * section.middle;
        Reach reach;
        for (int a = 0; a + 1 < points.dim; ++a) {
            double moment = 0.0, outermost = 0.0;
            for (const Vec3& r : points.place) {
                if (!is_cut(r)) continue;
                const double y = dot(r - section.middle, section.across[a]);
                moment += each * (y * y + spacing * spacing / 12.0);
                outermost = std::max(outermost, std::abs(y));
            }
            outermost += 0.5 * spacing;
            section.fibre[a] = outermost / moment;
            reach.farthest = std::max(reach.farthest, outermost);
            reach.over_gyration =
                std::max(reach.over_gyration, outermost * std::sqrt(section.area / moment));
        }
        return reach;
    }

    MassMoments all_;
    Array<Section> sections_;
    double most_per_force_ = 0.0;  // [1/m^2], 2-D: [1/m]
    double most_per_spin_ = 0.0;   // [kg/m], 2-D: of a slice of a metre
    double fibre_ = 0.0, long_fibre_ = 0.0, cube_ = std::numeric_limits<double>::infinity();
    bool round_ = true;
};

}  // namespace doseki
