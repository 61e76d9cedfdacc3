#pragma once
// How forces bend a slender body.

#include <algorithm>
#include <array>
#include <cmath>
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
    double longest_arm;  // of forces on the shorter side [m]

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
    /// A bound on it, for forces of which the sizes have this sum.
    double most_tension(double force) const {
        return 2.0 * force * (1.0 / area + longest_arm * std::max(fibre[0], fibre[1]));
    }
};

/// The cuts across the long axes of a body, a spacing apart; none through a compact one.
class Sections {
public:
    Sections() = default;

    /// Of points with these places from their centre and these masses, each of which fills a cube
    /// of this spacing. The frame of the body, in columns, chooses where several axes would do.
    Sections(std::span<const Vec3> place, std::span<const double> mass, double spacing, int dim,
             const Mat<double, 3>& frame)
        : spacing_(spacing), dim_(dim) {
        constexpr double slender = 1.5;  // length over thickness
        for (std::size_t k = 0; k < place.size(); ++k) all_.add(mass[k], place[k]);
        if (!(all_.mass > 0.0)) return;
        const std::array<Vec3, 3> axes = principal_axes(frame);
        auto square = [&](const Vec3& axis) { return dot(axis, all_.second * axis); };
        const double least = square(axes[dim - 1]);
        for (int a = 0; a + 1 < dim; ++a)
            if (square(axes[a]) > slender * slender * least)
                cut(place, mass, axes[a], {axes[(a + 1) % 3], axes[(a + 2) % 3]});
    }

    bool any() const { return !sections_.empty(); }
    /// A bound on tension(), for forces of which the sizes have this sum.
    double most_tension(double force) const {
        double most = 0.0;
        for (const Section& section : sections_) most = std::max(most, section.most_tension(force));
        return most;
    }
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
    void cut(std::span<const Vec3> place, std::span<const double> mass, const Vec3& axis,
             const std::array<Vec3, 2>& across) {
        constexpr double end = 1.5;  // spacings from an end, within which nothing bends
        double low = 0.0, high = 0.0;
        for (const Vec3& r : place)
            low = std::min(low, dot(r, axis)), high = std::max(high, dot(r, axis));
        low -= 0.5 * spacing_, high += 0.5 * spacing_;
        for (double at = low + end * spacing_; at <= high - end * spacing_; at += spacing_) {
            Section section{axis, at, {}, 0.0, across, {}, {}, std::min(at - low, high - at)};
            measure(section, place, mass);
            if (section.area > 0.0) sections_.push_back(section);
        }
    }
    void measure(Section& section, std::span<const Vec3> place,
                 std::span<const double> mass) const {
        const double each = dim_ == 2 ? spacing_ : spacing_ * spacing_;
        std::array<double, 2> low{}, high{};
        auto is_cut = [&](const Vec3& r) {
            return std::abs(dot(r, section.axis) - section.at) < 0.5 * spacing_;
        };
        for (std::size_t k = 0; k < place.size(); ++k) {
            if (dot(place[k], section.axis) > section.at) section.beyond.add(mass[k], place[k]);
            if (!is_cut(place[k])) continue;
            section.area += each, section.middle = section.middle + each * place[k];
        }
        if (!(section.area > 0.0)) return;
        section.middle = (1.0 / section.area) * section.middle;
        std::array<double, 2> moment{};
        for (const Vec3& r : place) {
            if (!is_cut(r)) continue;
            for (int a = 0; a + 1 < dim_; ++a) {
                const double y = dot(r - section.middle, section.across[a]);
                moment[a] += each * (y * y + spacing_ * spacing_ / 12.0);
                low[a] = std::min(low[a], y), high[a] = std::max(high[a], y);
            }
        }
        for (int a = 0; a + 1 < dim_; ++a) {
            const double outermost = std::max(-low[a], high[a]) + 0.5 * spacing_;
            section.fibre[a] = outermost / moment[a];
            section.longest_arm = std::max(section.longest_arm, outermost);
        }
    }

    double spacing_ = 0.0;
    int dim_ = 0;
    MassMoments all_;
    Array<Section> sections_;
};

}  // namespace doseki
