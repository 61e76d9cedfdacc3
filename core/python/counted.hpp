#pragma once
// How many operations a pair takes and how much it reads, told by the code of the pair itself.

#include <array>
#include <cstddef>
#include <cstdint>

#include "pairs/pair_term.hpp"
#include "pairs/pairs_to_sum.hpp"

namespace doseki {

/// Operations on numbers.
struct Operations {
    std::int64_t sums = 0, products = 0, quotients = 0, roots = 0, comparisons = 0;
};

/// A number that counts what is done with it; its value is of no use. Physics, which is written on
/// a type of number, is written on this one too.
class Counted {
public:
    Counted() = default;
    explicit Counted(double) {}

    static Operations& done() {
        static thread_local Operations operations;
        return operations;
    }

    friend Counted operator+(const Counted&, const Counted&) { return one_of(done().sums); }
    friend Counted operator-(const Counted&, const Counted&) { return one_of(done().sums); }
    friend Counted operator*(const Counted&, const Counted&) { return one_of(done().products); }
    friend Counted operator/(const Counted&, const Counted&) { return one_of(done().quotients); }
    friend Counted sqrt(const Counted&) { return one_of(done().roots); }
    /// A sign costs nothing.
    friend Counted operator-(const Counted& a) { return a; }
    friend Counted abs(const Counted& a) { return a; }
    Counted& operator+=(const Counted& other) { return *this = *this + other; }
    Counted& operator-=(const Counted& other) { return *this = *this - other; }
    Counted& operator*=(const Counted& other) { return *this = *this * other; }

    friend bool operator<(const Counted&, const Counted&) { return ++done().comparisons, false; }
    friend bool operator>(const Counted&, const Counted&) { return ++done().comparisons, false; }
    friend bool operator>=(const Counted&, const Counted&) { return ++done().comparisons, false; }
    friend bool operator!=(const Counted&, const Counted&) { return ++done().comparisons, false; }
    friend Counted min(const Counted&, const Counted&) { return one_of(done().comparisons); }
    friend Counted max(const Counted&, const Counted&) { return one_of(done().comparisons); }
    friend Counted select(bool, const Counted& yes, const Counted&) { return yes; }

private:
    static Counted one_of(std::int64_t& count) { return ++count, Counted(); }
};

/// Of one neighbour: operations, and bytes that are read.
struct PairWork {
    const char* sum;  // which, by the phase of a step
    Operations done;
    std::size_t bytes;
};

/// A pair of moving particles in the sum of a term: its distance and what it adds. A Point of the
/// term consists of Fields, which are what is read of a neighbour, with the entry of the list and
/// the coordinates.
template <template <class, int> class Point, template <class, int> class... Fields, class Term>
PairWork work_of_pair(const char* sum, const Term& term) {
    constexpr int D = Term::dim;
    using Number = typename Term::Real;
    const Point<Counted, D> i{}, j{};
    const std::array<Counted, D> x{};
    typename Term::template Accumulators<Counted> sums{};
    Counted::done() = {};
    term.add(sums, pair_of(difference<Counted, D>(x, x, Counted())), i, j);
    constexpr std::size_t numbers = (number_count<Fields<Number, D>>() + ...);
    return {sum, Counted::done(),
            sizeof(std::uint32_t) + D * sizeof(Coordinate<Number>) + numbers * sizeof(Number)};
}

}  // namespace doseki
