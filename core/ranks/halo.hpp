#pragma once
#include <algorithm>
#include <cstring>
#include <initializer_list>

#include "base/array.hpp"
#include "base/box.hpp"
#include "base/field.hpp"
#include "model/fault.hpp"
#include "pairs/neighbour_lists.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// One number or record for each particle of a storage, of which the halo sends what others need.
/// `first`: the particle whose record lies at `data`.
struct HaloColumn {
    enum Of { all, moving, fixed };
    std::byte* data;
    std::size_t stride, size, first;
    Of of;
};

template <class Record>
HaloColumn halo_column(Field<Record>& records, HaloColumn::Of of = HaloColumn::all,
                       std::size_t first = 0) {
    return {reinterpret_cast<std::byte*>(records.data()), sizeof(Record), sizeof(Record), first,
            of};
}

/// The same of one member of each record.
template <class Record, class Member>
HaloColumn halo_column(Field<Record>& records, Member Record::* member, HaloColumn::Of of,
                       std::size_t first) {
    std::byte* const data =
        records.empty() ? nullptr : reinterpret_cast<std::byte*>(&(records.data()->*member));
    return {data, sizeof(Record), sizeof(Member), first, of};
}

/// Ghosts: copies of particles of other ranks that are near enough to be listed as neighbours of
/// particles here. Invariants, from one build of the lists to the next:
///  - j of another rank is a ghost here if its distance from the bounds of this rank's particles is
///  less
///    than max(R_j, largest R here) + skin, through images across periodic axes too; so every pair
///    that Neighbours lists on one rank is listed on the owner of i;
///  - fixed ones are measured from the bounds of moving particles, where no fixed-fixed pairs
///  are listed;
///  - ghosts have records, never state: nothing but the pair loop sees them;
///  - who sends which particles to whom, and in which order, does not change.
template <int D>
class Halo {
public:
    explicit Halo(const Domain<D>& domain) : domain_(domain) {}

    Ranks ranks;

    bool alone() const { return ranks.alone(); }

    /// Finds the particles that other ranks need; `fixed_meet`: fixed ones need fixed ones.
    void find_exports(std::span<const Vec<double, D>> position, std::span<const double> support,
                      std::span<const std::uint8_t> is_fixed, double skin, bool fixed_meet = false);
    /// 1 for those, until announce(); empty on one rank.
    std::span<const std::uint8_t> exported() const { return exported_; }

    /// Particle k is now what was particle order[k].
    void renumber(std::span<const std::uint32_t> order);

    /// Tells the other ranks what they will get. Fills the arrays with position, support radius and
    /// whether fixed of the ghosts, as they come.
    struct Arrivals {
        Array<Vec<double, D>> position;
        Array<double> support;
        Array<std::uint8_t> is_fixed;
    };
    Arrivals announce(std::span<const Vec<double, D>> position, std::span<const double> support,
                      std::span<const std::uint8_t> is_fixed);

    /// Ghost k of the storage, which begins at `first`, is arrival order[k].
    void place(std::span<const std::uint32_t> order, std::size_t first);

    std::size_t ghosts() const { return place_.size(); }
    std::size_t moving_ghosts() const { return moving_ghosts_; }

    /// Sends the exported particles' records and awaits those of ghosts, which have their places in
    /// the same columns. They may be read after finish(), and those that are sent may be changed at
    /// once.
    void start(std::initializer_list<HaloColumn> columns);
    void finish();
    bool is_in_flight() const { return !in_flight_.empty(); }

    double bytes_sent() const { return bytes_sent_; }
    double messages_sent() const { return messages_sent_; }

private:
    /// Where the particles of a rank are.
    struct Bounds {
        Box<D> moving = Box<D>::nowhere(), all = Box<D>::nowhere();
        double support = 0.0;
    };
    static_assert(sizeof(Bounds) == (4 * D + 1) * sizeof(double));

    /// What is exchanged with one rank: moving particles first, then fixed ones.
    struct Peer {
        int rank;
        Array<std::uint32_t> exported;  // particles here
        std::size_t exported_moving = 0;
        std::size_t first_arrival = 0, arrivals = 0, arrivals_moving = 0;
    };

    struct Announced {
        Vec<double, D> position;
        double support;
        std::uint64_t is_fixed;
    };

    Array<Bounds> all_bounds(std::span<const Vec<double, D>> position,
                             std::span<const double> support,
                             std::span<const std::uint8_t> is_fixed) const;
    double gap(const Box<D>& one, const Box<D>& other) const;
    Peer& peer_of(int rank);

    template <class F>
    static void for_each_row(const HaloColumn& column, std::span<const std::uint32_t> rows,
                             std::size_t moving, F&& f) {
        const auto chosen = column.of == HaloColumn::all      ? rows
                            : column.of == HaloColumn::moving ? rows.first(moving)
                                                              : rows.subspan(moving);
        for (const std::uint32_t p : chosen) f(column.data + (p - column.first) * column.stride);
    }

    Domain<D> domain_;
    Array<Peer> peers_;             // in the order of ranks
    Array<std::uint8_t> exported_;  // of each particle, while lists are built
    Array<std::uint32_t> place_;    // in the storage, of each arrival
    std::size_t moving_ghosts_ = 0;
    Array<int> peer_ranks_;
    Array<HaloColumn> in_flight_;
    Bytes send_, receive_;
    Array<std::size_t> send_ends_, receive_ends_;
    double bytes_sent_ = 0.0, messages_sent_ = 0.0;
};

// Compiled once, in halo.cpp.
extern template class Halo<2>;
extern template class Halo<3>;

/// Calls `sum(clusters, number of the first)` for those without ghosts in their lists, then, once
/// the ghosts' records have come, for the others; for all at once where nothing is on its way.
template <int D, class List, class Sum>
void while_ghosts_come(Halo<D>& halo, const SortedCells<D>& cells, std::span<const List> clusters,
                       std::size_t width, const Sum& sum) {
    if (!halo.is_in_flight()) return sum(clusters, 0);
    const std::size_t inner = std::min(cells.inner() / width, clusters.size());
    sum(clusters.first(inner), 0);
    halo.finish();
    sum(clusters.subspan(inner), inner);
}

/// The shortest timestep and the worst fault of all ranks; the particle to blame is kept where it
/// is.
void agree(const Ranks& ranks, double& timestep, std::int64_t& limiting, Fault& fault);

}  // namespace doseki
