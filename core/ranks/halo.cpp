#include "ranks/halo.hpp"

namespace doseki {

template <int D>
auto Halo<D>::all_bounds(std::span<const Vec<double, D>> position, std::span<const double> support,
                         std::span<const std::uint8_t> is_fixed) const -> Array<Bounds> {
    Bounds mine;
    for (std::size_t p = 0; p < position.size(); ++p) {
        mine.all.add(position[p]);
        if (!is_fixed[p]) mine.moving.add(position[p]);
        mine.support = std::max(mine.support, support[p]);
    }
    constexpr std::size_t numbers = sizeof(Bounds) / sizeof(double);
    const auto flat = ranks.exchange().gather({reinterpret_cast<const double*>(&mine), numbers});
    Array<Bounds> bounds(flat.size() / numbers);
    std::memcpy(static_cast<void*>(bounds.data()), flat.data(), flat.size() * sizeof(double));
    return bounds;
}

/// Distance between two boxes, through the nearest image.
template <int D>
double Halo<D>::gap(const Box<D>& one, const Box<D>& other) const {
    double square = 0.0;
    for (int a = 0; a < D; ++a) {
        auto apart = [&](double shift) {
            return std::max(other.low[a] + shift - one.high[a], one.low[a] - other.high[a] - shift);
        };
        double distance = apart(0.0);
        if (const double length = domain_.length(a); domain_.periodic[a])
            distance = std::min({distance, apart(length), apart(-length)});
        if (distance > 0.0) square += distance * distance;
    }
    return std::sqrt(square);
}

template <int D>
auto Halo<D>::peer_of(int rank) -> Peer& {
    auto found = std::lower_bound(peers_.begin(), peers_.end(), rank,
                                  [](const Peer& peer, int r) { return peer.rank < r; });
    if (found == peers_.end() || found->rank != rank)
        found = peers_.insert(found, Peer{.rank = rank, .exported = {}});
    return *found;
}

template <int D>
void Halo<D>::find_exports(std::span<const Vec<double, D>> position,
                           std::span<const double> support, std::span<const std::uint8_t> is_fixed,
                           double skin, bool fixed_meet) {
    peers_.clear();
    exported_.assign(position.size(), 0);
    const Array<Bounds> bounds = all_bounds(position, support, is_fixed);
    const Bounds& mine = bounds[static_cast<std::size_t>(ranks.rank())];
    for (int r = 0; r < ranks.count(); ++r) {
        const Bounds& theirs = bounds[static_cast<std::size_t>(r)];
        if (r == ranks.rank() ||
            !(gap(mine.all, theirs.all) < std::max(mine.support, theirs.support) + skin))
            continue;
        Array<std::uint32_t> exported;
        for (std::size_t p = 0; p < position.size(); ++p) {
            const Box<D>& box = is_fixed[p] && !fixed_meet ? theirs.moving : theirs.all;
            if (!(gap({position[p], position[p]}, box) <
                  std::max(support[p], theirs.support) + skin))
                continue;
            exported.push_back(static_cast<std::uint32_t>(p));
            exported_[p] = 1;
        }
        if (!exported.empty()) peer_of(r).exported = std::move(exported);
    }
}

template <int D>
void Halo<D>::renumber(std::span<const std::uint32_t> order) {
    if (alone()) return;
    Array<std::uint32_t> place(order.size());
    for (std::uint32_t k = 0; k < order.size(); ++k) place[order[k]] = k;
    for (Peer& peer : peers_) {
        for (std::uint32_t& p : peer.exported) p = place[p];
        std::sort(peer.exported.begin(), peer.exported.end());
    }
}

template <int D>
auto Halo<D>::announce(std::span<const Vec<double, D>> position, std::span<const double> support,
                       std::span<const std::uint8_t> is_fixed) -> Arrivals {
    Arrivals arrivals;
    if (alone()) return arrivals;
    Array<Parcel> parcels;
    for (Peer& peer : peers_) {
        peer.exported_moving =
            static_cast<std::size_t>(std::count_if(peer.exported.begin(), peer.exported.end(),
                                                   [&](std::uint32_t p) { return !is_fixed[p]; }));
        Parcel parcel{peer.rank, Bytes(peer.exported.size() * sizeof(Announced))};
        auto* row = reinterpret_cast<Announced*>(parcel.content.data());
        for (const std::uint32_t p : peer.exported) *row++ = {position[p], support[p], is_fixed[p]};
        parcels.push_back(std::move(parcel));
    }
    for (const Parcel& parcel : ranks.exchange().swap(parcels)) {
        Peer& peer = peer_of(parcel.rank);
        peer.first_arrival = arrivals.support.size();
        peer.arrivals = parcel.content.size() / sizeof(Announced);
        const auto* row = reinterpret_cast<const Announced*>(parcel.content.data());
        for (std::size_t k = 0; k < peer.arrivals; ++k, ++row) {
            arrivals.position.push_back(row->position), arrivals.support.push_back(row->support);
            arrivals.is_fixed.push_back(row->is_fixed != 0);
            peer.arrivals_moving += row->is_fixed == 0;
        }
    }
    peer_ranks_.clear();
    for (const Peer& peer : peers_) peer_ranks_.push_back(peer.rank);
    exported_.clear();
    return arrivals;
}

template <int D>
void Halo<D>::place(std::span<const std::uint32_t> order, std::size_t first) {
    place_.resize(order.size());
    for (std::size_t k = 0; k < order.size(); ++k)
        place_[order[k]] = static_cast<std::uint32_t>(first + k);
    moving_ghosts_ = 0;
    for (const Peer& peer : peers_) moving_ghosts_ += peer.arrivals_moving;
}

template <int D>
void Halo<D>::start(std::initializer_list<HaloColumn> columns) {
    if (alone()) return;
    const auto timing = ranks.clock.measure(Share::halo);
    in_flight_ = columns;
    send_.clear(), send_ends_.clear(), receive_ends_.clear();
    std::size_t awaited = 0;
    for (const Peer& peer : peers_) {
        const std::size_t before = send_.size();
        for (const HaloColumn& column : columns) {
            for_each_row(column, peer.exported, peer.exported_moving, [&](const std::byte* record) {
                send_.insert(send_.end(), record, record + column.size);
            });
            const std::size_t fixed = peer.arrivals - peer.arrivals_moving;
            awaited += column.size * (column.of == HaloColumn::all      ? peer.arrivals
                                      : column.of == HaloColumn::moving ? peer.arrivals_moving
                                                                        : fixed);
        }
        send_ends_.push_back(send_.size()), receive_ends_.push_back(awaited);
        messages_sent_ += send_.size() > before;
    }
    bytes_sent_ += static_cast<double>(send_.size());
    receive_.resize(awaited);
    ranks.exchange().start(peer_ranks_, send_, send_ends_, receive_, receive_ends_);
}

template <int D>
void Halo<D>::finish() {
    if (alone() || in_flight_.empty()) return;
    {
        const auto timing = ranks.clock.measure(Share::wait);
        ranks.exchange().finish();
    }
    const auto timing = ranks.clock.measure(Share::halo);
    const std::byte* from = receive_.data();
    for (const Peer& peer : peers_) {
        const auto places = std::span(place_).subspan(peer.first_arrival, peer.arrivals);
        for (const HaloColumn& column : in_flight_)
            for_each_row(column, places, peer.arrivals_moving, [&](std::byte* record) {
                std::memcpy(record, from, column.size);
                from += column.size;
            });
    }
    in_flight_.clear();
}

void agree(const Ranks& ranks, double& timestep, std::int64_t& limiting, Fault& fault) {
    if (ranks.alone()) return;
    const double own = timestep;
    std::array<double, 2> worst{-timestep, static_cast<double>(fault.rank)};
    ranks.largest(worst);
    timestep = -worst[0];
    if (timestep < own) limiting = -1;
    if (worst[1] > static_cast<double>(fault.rank))
        fault = {static_cast<Fault::Rank>(worst[1]), -1};
}

template class Halo<2>;
template class Halo<3>;

}  // namespace doseki
