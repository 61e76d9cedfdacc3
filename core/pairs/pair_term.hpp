#pragma once
// What the pair loop asks of a term: what to load of a particle and what a pair adds. A term sees
// no lists, lanes or threads, and what becomes of its sums is not its business: that is the
// epilogue, called as epilogue(p, accumulators) with the sums of one particle.
//
//   struct Term {
//       using Real = double;                             // or float: the number of its records
//       static constexpr int dim = D;
//       template <class T> using Accumulators = ...;     // packed struct, see base/members.hpp
//       auto load(Rows i) const;                         // particles i: LaneRows or OneRow
//       auto load_moving(OneRow<T> j) const;             // a moving neighbour
//       auto load_fixed(OneRow<T> j) const;              // a fixed one
//       void add(Accumulators<T>&, const Pair<T, D>&, const auto& i, const auto& j) const;
//       void add_fixed(...) const;                       // the same for a fixed j
//       void after_moving(Accumulators<T>&) const;       // between the two; may be left out
//       using SeesEntries = void;                        // may be left out, see PairEntry
//       Real reach() const;                              // may be left out, see KnowsItsReach
//   };

#include <concepts>

#include "base/members.hpp"
#include "pairs/records.hpp"
#include "pairs/rows.hpp"

namespace doseki {

/// Where in the lists a pair stands: its cluster, by the first particle of that, and its number in
/// the list. A term that declares `using SeesEntries = void` is given it, as the last argument of
/// `add`, to find what it keeps for each pair.
struct PairEntry {
    std::uint32_t first, number;
};

template <class Term>
concept SeesEntries = requires { typename Term::SeesEntries; };

/// A term that says from which distance [m] on a pair adds nothing at all. The loop leaves out the
/// neighbours that are out of reach of all particles of a group, so that a wide margin of the
/// lists costs no more than their distances, and sums several of the others at once
/// (pairs/groups.hpp). Such a term loads neighbours from RowsAbreast as well as from OneRow, and
/// those of its members that are no sums are a Largest.
template <class Term>
concept KnowsItsReach = requires(const Term& term) {
    { term.reach() } -> std::same_as<typename Term::Real>;
};

/// The accumulators of a term over packs, or over another number type.
template <class Term, class T = Pack<typename Term::Real>>
using AccumulatorsOf = typename Term::template Accumulators<T>;

template <class Term>
concept NamesItsNumbers = requires {
    typename Term::Real;
    Term::dim + 0;
};

template <class Term>
concept HasAccumulators =
    requires { typename AccumulatorsOf<Term>; } && HasMembers<AccumulatorsOf<Term>>;

#if !defined(__CUDACC__)
template <class Term>
concept LoadsParticles =
    requires(const Term& term, LaneRows<typename Term::Real> i) { term.load(i); };

template <class Term>
concept LoadsMoving =
    requires(const Term& term, OneRow<Pack<typename Term::Real>> j) { term.load_moving(j); };

template <class Term>
concept LoadsFixed =
    requires(const Term& term, OneRow<Pack<typename Term::Real>> j) { term.load_fixed(j); };

template <class Term>
concept AddsMoving =
    requires(const Term& term, AccumulatorsOf<Term>& sums, LaneRows<typename Term::Real> i,
             OneRow<Pack<typename Term::Real>> j, Pair<Pack<typename Term::Real>, Term::dim> pair) {
        term.add(sums, pair, term.load(i), term.load_moving(j));
    };

template <class Term>
concept AddsEntries =
    requires(const Term& term, AccumulatorsOf<Term>& sums, LaneRows<typename Term::Real> i,
             OneRow<Pack<typename Term::Real>> j, Pair<Pack<typename Term::Real>, Term::dim> pair,
             PairEntry at) { term.add(sums, pair, term.load(i), term.load_moving(j), at); };

template <class Term>
concept AddsPairs = AddsMoving<Term> || AddsEntries<Term>;

template <class Term>
concept AddsFixed =
    requires(const Term& term, AccumulatorsOf<Term>& sums, LaneRows<typename Term::Real> i,
             OneRow<Pack<typename Term::Real>> j, Pair<Pack<typename Term::Real>, Term::dim> pair) {
        term.add_fixed(sums, pair, term.load(i), term.load_fixed(j));
    };

template <class Term>
concept PairTerm = NamesItsNumbers<Term> && HasAccumulators<Term> && LoadsParticles<Term> &&
                   LoadsMoving<Term> && LoadsFixed<Term> && AddsPairs<Term> && AddsFixed<Term>;

template <class Term, class Epilogue>
concept EpilogueOf = requires(const Epilogue& epilogue, const AccumulatorsOf<Term, double>& sums) {
    epilogue(std::size_t{}, sums);
};

/// An epilogue that says which sums are zero again and need not be taken: those of a cluster
/// without moving neighbours, none of whose particles p `needs_sums(p)` and none of whose fixed
/// neighbours j `acts(j)`. It is not called for such a cluster.
template <class Epilogue>
concept KnowsIdleParticles = requires(const Epilogue& epilogue) {
    { epilogue.needs_sums(std::size_t{}) } -> std::same_as<bool>;
    { epilogue.acts(std::size_t{}) } -> std::same_as<bool>;
};

/// Says what a type lacks to be a PairTerm, one thing at a time.
template <class Term, class Epilogue>
constexpr bool check_pair_term() {
    static_assert(NamesItsNumbers<Term>,
                  "a pair term needs `using Real = double` (or float) and `static constexpr int "
                  "dim = D`");
    if constexpr (NamesItsNumbers<Term>) {
        static_assert(HasAccumulators<Term>,
                      "a pair term needs `template <class T> using Accumulators = ...`: what it "
                      "sums over numbers T, a packed struct with members(f, self...)");
        static_assert(LoadsParticles<Term>,
                      "a pair term needs `load(rows) const`: the particles i, out of LaneRows");
        static_assert(LoadsMoving<Term>,
                      "a pair term needs `load_moving(OneRow<T> j) const`: a moving neighbour");
        static_assert(LoadsFixed<Term>,
                      "a pair term needs `load_fixed(OneRow<T> j) const`: a fixed neighbour");
        if constexpr (HasAccumulators<Term> && LoadsParticles<Term> && LoadsMoving<Term> &&
                      LoadsFixed<Term>) {
            static_assert(AddsPairs<Term>,
                          "a pair term needs `add(Accumulators<T>&, const Pair<T, D>&, i, j) "
                          "const`, with i as load() and j as load_moving() give them");
            static_assert(AddsFixed<Term>,
                          "a pair term needs `add_fixed(Accumulators<T>&, const Pair<T, D>&, i, "
                          "j) const`, with i as load() and j as load_fixed() give them");
            static_assert(EpilogueOf<Term, Epilogue>,
                          "an epilogue is called as epilogue(p, sums): particle and "
                          "Accumulators<double>");
        }
    }
    return true;
}
#endif

}  // namespace doseki
