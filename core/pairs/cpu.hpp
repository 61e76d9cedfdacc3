#pragma once
#include "base/array.hpp"
#include "pairs/bulk_backend.hpp"
#include "pairs/loop.hpp"
#include "pairs/neighbour_lists.hpp"

namespace doseki {

/// The processor as a back end: clusters of as many particles as a pack has lanes, one list each.
template <class real>
struct Cpu : BulkBackend {
    using Real = real;
    static constexpr int width = lanes<real>;
    template <int D>
    using Lists = Neighbours<D>;

    /// How many summaries epilogues keep for so many clusters: number c is that of cluster c.
    static std::size_t summaries(std::size_t clusters) { return clusters; }

    template <int D>
    static void build_lists(Lists<D>& lists, std::span<const Vec<double, D>> position,
                            std::span<const double> support, double skin,
                            std::span<const std::int32_t> faces) {
        lists.build(width, position, support, skin, faces);
    }

    /// Sums a term over pairs and calls epilogue(p, sums) for each particle of the clusters.
    template <class Term, class Epilogue>
    static void sum_pairs(const Lists<Term::dim>& lists,
                          const PairsToSum<real, Term::dim, ClusterList>& pairs, const Term& term,
                          const Epilogue& epilogue) {
        auto sum = [&]<bool periodic>() {
            for_each_pair<periodic>(lists, pairs.clusters, pairs.records, pairs.frame, term,
                                    epilogue, pairs.options);
        };
        if (lists.is_periodic())
            sum.template operator()<true>();
        else
            sum.template operator()<false>();
    }
    /// What a device would do elsewhere.
    template <class... Arguments>
    static void sum_pairs_on_threads(const Arguments&... arguments) {
        sum_pairs(arguments...);
    }
};

static_assert(Backend<Cpu<double>, 2> && Backend<Cpu<double>, 3>);
static_assert(Backend<Cpu<float>, 2> && Backend<Cpu<float>, 3>);

}  // namespace doseki
