#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "base/box.hpp"
#include "base/parallel.hpp"
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
    using Range = Box<D>;  // of displacements
    using Cell = std::array<std::int64_t, D>;

    void size_cells(std::span<const Vec<double, D>> position);
    std::size_t place(const Cell& cell) const;
    std::size_t place(const Vec<double, D>& x) const;
    Range around(std::size_t place, std::span<const Range> ranges) const;

    Domain<D> domain_;
    double reach_ = 0.0;
    Array<Vec<double, D>> start_;
    Vec<double, D> origin_, cell_size_;
    Cell cells_{};                          // cells that far apart share a place
    Array<std::uint32_t> first_, members_;  // particles by cell
};

/// As many cells as there are particles at most: a periodic direction gets wider ones, any other
/// direction puts cells that lie far apart together.
template <int D>
void ListWear<D>::size_cells(std::span<const Vec<double, D>> position) {
    constexpr double max_cells = 1048576.0;
    auto occupied = Box<D>::nowhere();
    for (const Vec<double, D>& x : position) occupied.add(x);
    for (int a = 0; a < D; ++a) {
        const double length = domain_.periodic[a] ? domain_.length(a) : occupied.size()[a];
        const double count =
            std::floor(length / (2.0 * reach_)) + (domain_.periodic[a] ? 0.0 : 1.0);
        cells_[a] = static_cast<std::int64_t>(std::clamp(count, 1.0, max_cells));
    }
    auto product = [this] {
        double product = 1.0;
        for (const std::int64_t count : cells_) product *= static_cast<double>(count);
        return product;
    };
    while (product() > static_cast<double>(std::max<std::size_t>(64, position.size()))) {
        std::int64_t& most = *std::max_element(cells_.begin(), cells_.end());
        most = (most + 1) / 2;
    }
    for (int a = 0; a < D; ++a) {
        const bool periodic = domain_.periodic[a];
        origin_[a] = periodic ? domain_.low[a] : occupied.low[a];
        cell_size_[a] =
            periodic ? domain_.length(a) / static_cast<double>(cells_[a]) : 2.0 * reach_;
    }
}

template <int D>
std::size_t ListWear<D>::place(const Cell& cell) const {
    std::size_t place = 0;
    for (int a = D - 1; a >= 0; --a) {
        const std::int64_t n = cells_[a], wrapped = ((cell[a] % n) + n) % n;
        place = place * static_cast<std::size_t>(n) + static_cast<std::size_t>(wrapped);
    }
    return place;
}

template <int D>
std::size_t ListWear<D>::place(const Vec<double, D>& x) const {
    constexpr double farthest = 1e15;  // a whole number that all types can hold
    Cell cell;
    for (int a = 0; a < D; ++a) {
        const double count = std::floor((x[a] - origin_[a]) / cell_size_[a]);
        cell[a] = static_cast<std::int64_t>(std::clamp(count, -farthest, farthest));
    }
    return place(cell);
}

template <int D>
void ListWear<D>::start(std::span<const Vec<double, D>> position, double reach) {
    reach_ = reach;
    start_.assign(position.begin(), position.end());
    size_cells(position);
    Array<std::uint32_t> place_of(position.size());
    for_each_particle(position.size(), [&](std::size_t p) {
        place_of[p] = static_cast<std::uint32_t>(place(position[p]));
    });
    std::size_t places = 1;
    for (const std::int64_t count : cells_) places *= static_cast<std::size_t>(count);
    first_.assign(places + 1, 0);
    for (const std::uint32_t place : place_of) ++first_[place + 1];
    for (std::size_t c = 0; c < places; ++c) first_[c + 1] += first_[c];
    Array<std::uint32_t> next(first_.begin(), first_.end() - 1);
    members_.resize(position.size());
    for (std::uint32_t p = 0; p < place_of.size(); ++p) members_[next[place_of[p]]++] = p;
}

/// Range of displacements in a cell and those next to it.
template <int D>
auto ListWear<D>::around(std::size_t place_of_cell, std::span<const Range> ranges) const -> Range {
    constexpr int neighbours = D == 2 ? 9 : 27;
    Range range = Range::nowhere();
    for (int code = 0; code < neighbours; ++code) {
        Cell cell;
        std::size_t rest = place_of_cell;
        for (int a = 0, digits = code; a < D; ++a, digits /= 3) {
            const auto n = static_cast<std::size_t>(cells_[a]);
            cell[a] = static_cast<std::int64_t>(rest % n) + digits % 3 - 1;
            rest /= n;
        }
        range.add(ranges[place(cell)]);
    }
    return range;
}

template <int D>
double ListWear<D>::approach(std::span<const Vec<double, D>> position) const {
    Array<Range> ranges(first_.size() - 1, Range::nowhere());
    for_each_particle(ranges.size(), [&](std::size_t c) {
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            const std::uint32_t p = members_[k];
            ranges[c].add(position[p] - start_[p]);
        }
    });
    const double square = reduce(ranges.size(), 0.0, maximum, [&](std::size_t c) {
        if (ranges[c].is_empty()) return 0.0;
        const Vec<double, D> width = around(c, ranges).size();
        return dot(width, width);
    });
    return std::sqrt(square);
}

}  // namespace doseki
