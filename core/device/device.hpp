#pragma once
#include <algorithm>

#include "device/row_lists.hpp"
#include "pairs/bulk_backend.hpp"
#include "pairs/rows.hpp"

namespace doseki {

/// Sums a term over the neighbours of one particle, one after another, and hands the sums on.
template <bool periodic, class Term, class Epilogue>
struct SumRow {
    using real = typename Term::Real;
    static constexpr int D = Term::dim;

    NeighbourPlaces<real, D> places;
    std::span<const RowList> rows;
    std::span<const std::uint32_t> only;  // rows to sum, where not all are
    std::size_t start, first;  // number of the first row of the slice, and of all in `rows`
    bool skip_empty;
    Term term;
    Epilogue epilogue;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        const std::size_t k = only.empty() ? start + n : only[start + n];
        if (skip_empty && rows[k].empty()) return;
        epilogue(first + k, converted<typename Term::template Accumulators<double>>(sums_of(k)));
    }

private:
    DOSEKI_DEVICE_FN typename Term::template Accumulators<real> sums_of(std::size_t k) const {
        const auto p = static_cast<std::uint32_t>(first + k);
        const auto x = places.records[p].x;
        const auto i = term.load(OneRow<real>{p});
        typename Term::template Accumulators<real> sums{};
        [[maybe_unused]] PairEntry at{p, 0};
        rows[k].for_each_moving([&](std::uint32_t entry) {
            if constexpr (SeesEntries<Term>)
                term.add(sums, pair_with(x, entry), i, term.load_moving(neighbour(entry)), at),
                    ++at.number;
            else
                term.add(sums, pair_with(x, entry), i, term.load_moving(neighbour(entry)));
        });
        if constexpr (requires { term.after_moving(sums); }) term.after_moving(sums);
        rows[k].for_each_fixed([&](std::uint32_t entry) {
            term.add_fixed(sums, pair_with(x, entry), i, term.load_fixed(neighbour(entry)));
        });
        return sums;
    }
    DOSEKI_DEVICE_FN static OneRow<real> neighbour(std::uint32_t entry) {
        return {entry & ListEntry::index_mask};
    }
    DOSEKI_DEVICE_FN Pair<real, D> pair_with(const std::array<Coordinate<real>, D>& x,
                                             std::uint32_t entry) const {
        return pair_of(
            difference<real, D>(x, places.template position<periodic>(entry), places.unit));
    }
};

/// A device as a back end: one thread for each particle, which has a list of its own.
template <class real>
struct Device : BulkBackend {
    using Real = real;
    static constexpr int width = 1;
    template <int D>
    using Lists = RowLists<D>;

    /// Rows are summed so many at once, one such slice after the other: enough for the threads of a
    /// card, and few enough that what epilogues keep for each row of a slice takes no memory.
    static constexpr std::size_t slice = std::size_t{1} << 18;
    /// How many summaries epilogues keep: that of row c is number c modulo these.
    static std::size_t summaries(std::size_t rows) { return std::min(rows, slice); }

    template <int D>
    static void build_lists(Lists<D>& lists, std::span<const Vec<double, D>> position,
                            std::span<const double> support, double skin,
                            std::span<const std::int32_t> faces) {
        lists.build(position, support, skin, faces);
    }

    /// Sums a term over pairs and calls epilogue(p, sums) for each particle of the lists.
    template <class Term, class Epilogue>
    static void sum_pairs(const Lists<Term::dim>& lists,
                          const PairsToSum<real, Term::dim, RowList>& pairs, const Term& term,
                          const Epilogue& epilogue) {
        sum_rows(lists, pairs, term, epilogue,
                 [](std::size_t count, const auto& row) { bulk::for_each(count, row); });
    }
    /// The same on the threads of the processor, for what is not on the device.
    template <class Term, class Epilogue>
    static void sum_pairs_on_threads(const Lists<Term::dim>& lists,
                                     const PairsToSum<real, Term::dim, RowList>& pairs,
                                     const Term& term, const Epilogue& epilogue) {
        sum_rows(lists, pairs, term, epilogue,
                 [](std::size_t count, const auto& row) { doseki::for_each_particle(count, row); });
    }

private:
    template <class Term, class Epilogue, class Loop>
    static void sum_rows(const Lists<Term::dim>& lists,
                         const PairsToSum<real, Term::dim, RowList>& pairs, const Term& term,
                         const Epilogue& epilogue, const Loop& loop) {
        const auto shifts = image_shifts(lists, pairs.frame);
        const NeighbourPlaces<real, Term::dim> places{pairs.records, shifts,
                                                      static_cast<real>(pairs.frame.unit)};
        const PairLoopOptions& options = pairs.options;
        const auto only = options.only ? std::span<const std::uint32_t>(*options.only)
                                       : std::span<const std::uint32_t>();
        const std::size_t count = options.only ? only.size() : pairs.clusters.size();
        auto sum = [&]<bool periodic>() {
            for (std::size_t start = 0; start < count; start += slice)
                loop(std::min(slice, count - start),
                     SumRow<periodic, Term, Epilogue>{places, pairs.clusters, only, start,
                                                      options.first_cluster, options.skip_empty,
                                                      term, epilogue});
        };
        if (lists.is_periodic())
            sum.template operator()<true>();
        else
            sum.template operator()<false>();
    }
};

static_assert(Backend<Device<double>, 2> && Backend<Device<double>, 3>);
static_assert(Backend<Device<float>, 2> && Backend<Device<float>, 3>);

}  // namespace doseki
