#pragma once
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
    std::size_t first;
    bool skip_empty;
    Term term;
    Epilogue epilogue;

    DOSEKI_DEVICE_FN void operator()(std::size_t k) const {
        if (skip_empty && rows[k].empty()) return;
        epilogue(first + k, converted<typename Term::template Accumulators<double>>(sums_of(k)));
    }

private:
    DOSEKI_DEVICE_FN typename Term::template Accumulators<real> sums_of(std::size_t k) const {
        const auto p = static_cast<std::uint32_t>(first + k);
        const auto x = places.records[p].x;
        const auto i = term.load(OneRow<real>{p});
        typename Term::template Accumulators<real> sums{};
        rows[k].for_each_moving([&](std::uint32_t entry) {
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
        const auto shifts = image_shifts(lists, pairs.frame);
        const NeighbourPlaces<real, Term::dim> places{pairs.records, shifts,
                                                      static_cast<real>(pairs.frame.unit)};
        auto sum = [&]<bool periodic>() {
            bulk::for_each(pairs.clusters.size(),
                           SumRow<periodic, Term, Epilogue>{
                               places, pairs.clusters, pairs.options.first_cluster,
                               pairs.options.skip_empty, term, epilogue});
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
