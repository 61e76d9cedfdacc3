#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "base/vec.hpp"
#include "model/domain.hpp"

namespace doseki {

/// What lists cost a scheme, in the time of its pair sums over lists without a skin.
///
/// With a skin s, a fraction of the support radius, a step costs 1 + growth s for its pairs, and
/// lists last s / g steps when two particles come nearer by g support radii a step; a sort and
/// build costs `build`. So the sum 1 + growth s + g build / s is smallest at s = sqrt(g build /
/// growth). It is flat there, so measured constants (docs/performance.md) serve better than a clock
/// would: a skin that followed the wall time would give every run a rounding of its own. `max_skin`
/// bounds the memory of lists.
struct SkinCosts {
    static constexpr double min_skin = 0.01;
    double build, growth, max_skin;

    double cheapest_skin(double approach_per_step) const {
        return std::clamp(std::sqrt(approach_per_step * build / growth), min_skin, max_skin);
    }
};

/// Cells of which those that are far apart share a place.
template <int D>
struct WearCells {
    using Cell = std::array<std::int64_t, D>;

    Vec<double, D> origin, size;
    Cell count{};

    DOSEKI_DEVICE_FN std::size_t place(const Cell& cell) const {
        std::size_t place = 0;
        for (int a = D - 1; a >= 0; --a) {
            const std::int64_t n = count[a], wrapped = ((cell[a] % n) + n) % n;
            place = place * static_cast<std::size_t>(n) + static_cast<std::size_t>(wrapped);
        }
        return place;
    }
    DOSEKI_DEVICE_FN std::size_t place(const Vec<double, D>& x) const {
        constexpr double farthest = 1e15;  // a whole number that all types can hold
        Cell cell;
        for (int a = 0; a < D; ++a) {
            const double number = std::floor((x[a] - origin[a]) / size[a]);
            cell[a] = static_cast<std::int64_t>(
                std::max(-double{farthest}, std::min(number, double{farthest})));
        }
        return place(cell);
    }
};

/// How much nearer any two particles can have come since lists were built.
///
/// Two particles move past each other by what their displacements differ, so particles that fly
/// side by side wear no list out. Space is cut into cells twice as wide as lists reach. A particle
/// that was not listed as a neighbour either lay in the same cell or one next to it, and then the
/// range of displacements there bounds the difference; or it was a cell away, too far to arrive as
/// long as nothing has gone half the reach.
template <int D>
class ListWear {
public:
    explicit ListWear(const Domain<D>& domain) : domain_(domain) {}

    /// Lists that reach `reach` [m] were built for particles at these positions.
    void start(std::span<const Vec<double, D>> position, double reach);

    /// Bound on the approach of any two particles that are not neighbours [m].
    double approach(std::span<const Vec<double, D>> position) const;

    double reach() const { return reach_; }
    /// Where particles were.
    std::span<const Vec<double, D>> positions() const { return start_; }
    std::size_t bytes() const {
        return start_.capacity() * sizeof(Vec<double, D>) +
               (members_.capacity() + first_.capacity()) * sizeof(std::uint32_t);
    }

private:
    void size_cells(std::span<const Vec<double, D>> position);

    Domain<D> domain_;
    double reach_ = 0.0;
    Array<Vec<double, D>> start_;
    WearCells<D> cells_;
    Array<std::uint32_t> first_, members_;  // particles by cell
};

// Compiled once, in list_wear.cpp.
extern template class ListWear<2>;
extern template class ListWear<3>;

}  // namespace doseki
