#pragma once
// The longest stable step of deformable bodies, which deformable.cpp compiles.

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "bodies/deformable/advance.hpp"
#include "bodies/elastic/power_iteration.hpp"

namespace doseki {

/// Accelerations by internal forces about rest, which are linear in small displacements and
/// velocities.
template <int D>
Array<Vec<double, D>> TotalLagrangian<D>::linear_response(const Array<Vec<double, D>>& displacement,
                                                          const Array<Vec<double, D>>& velocity) {
    for (const std::uint32_t p : stepped_.points())
        x[p] = rest_[p] + displacement[p], v[p] = velocity[p];
    Array<Vec<double, D>> all(size()), response(size());
    internal_accelerations(all);
    for (const std::uint32_t p : stepped_.points()) response[p] = all[p];
    return response;
}

/// Points of one body of each kind: with the same numbers, the same places at rest to a millionth
/// of a spacing and the same of them clamped.
template <int D>
Array<std::uint8_t> TotalLagrangian<D>::representatives() const {
    constexpr double fine = 1e6;
    Array<Array<std::uint32_t>> points(bodies());
    for (const std::uint32_t p : slot_) points[static_cast<std::size_t>(body_[p])].push_back(p);
    auto before = [](const auto& a, const auto& b) {
        return std::ranges::lexicographical_compare(a, b);
    };
    std::set<Array<std::int64_t>, decltype(before)> known(before);
    Array<std::uint8_t> chosen(size(), 0);
    for (std::size_t b = 0; b < bodies(); ++b) {
        auto numbers = bodies_[b].numbers();
        numbers.back() = 0.0;  // of flaws, which are not there yet
        Array<std::int64_t> kind;
        for (const double number : numbers) kind.push_back(std::bit_cast<std::int64_t>(number));
        for (const std::uint32_t p : points[b]) {
            const Vec<double, D> r = rest_[p] - rest_[points[b].front()];
            for (int a = 0; a < D; ++a)
                kind.push_back(std::llround(fine / bodies_[b].spacing * r[a]));
            kind.push_back(clamped_[p]);
        }
        if (known.insert(kind).second)
            for (const std::uint32_t p : points[b]) chosen[p] = 1;
    }
    return chosen;
}

/// Eq. (84). With omega^2 and gamma the eigenvalues of stiffness and damping, Verlet with predicted
/// velocities is stable while omega^2 dt^2/4 + gamma dt < 1.
template <int D>
void TotalLagrangian<D>::limit_timestep() {
    const double amplitude = 1e-6 * bodies_[0].spacing;
    const auto x0 = x, v0 = v;
    const Array<Vec<double, D>> none(size());
    Array<Vec<double, D>> mode(size());
    const Array<std::uint8_t> chosen = representatives();
    stepped_.choose(size(), [&](std::uint32_t p) { return chosen[p] != 0; });
    for (const std::uint32_t p : stepped_.points())  // not orthogonal to the fastest mode
        for (int k = 0; k < D && !clamped_[p]; ++k)
            mode[p][k] =
                std::sin(1.0 + 7.0 * static_cast<double>(D * p + static_cast<std::size_t>(k)));
    const double stiffness = largest_eigenvalue(
        mode, amplitude, [&](const auto& moved) { return linear_response(moved, none); });
    const double damping = largest_eigenvalue(
        mode, amplitude, [&](const auto& moving) { return linear_response(none, moving); });
    x = x0, v = v0;
    if (stiffness > 0.0)
        stable_step_ = 2.0 * (std::sqrt(damping * damping + stiffness) - damping) / stiffness;
}

}  // namespace doseki
