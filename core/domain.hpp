#pragma once
// Who owns what: particles go to the rank whose part of space they are in.

#include <cstring>
#include <map>

#include "exchange.hpp"
#include "list_storage.hpp"
#include "particles.hpp"
#include "phase_timer.hpp"

namespace doseki {

/// All fields of some particles, field by field.
template <int D>
Bytes pack(Particles<D>& particles, std::span<const std::uint32_t> chosen) {
    Bytes bytes;
    particles.for_each_field([&](auto& field) {
        static_assert(std::is_trivially_copyable_v<std::remove_reference_t<decltype(field[0])>>);
        for (const std::uint32_t p : chosen) {
            const auto* const value = reinterpret_cast<const std::byte*>(&field[p]);
            bytes.insert(bytes.end(), value, value + sizeof(field[p]));
        }
    });
    return bytes;
}

/// Appends particles that pack() made bytes of.
template <int D>
void unpack(Particles<D>& particles, const Bytes& bytes) {
    std::size_t each = 0;
    particles.for_each_field([&](auto& field) { each += sizeof(field[0]); });
    const std::size_t first = particles.size(), n = bytes.size() / each;
    particles.resize(first + n);
    const std::byte* from = bytes.data();
    particles.for_each_field([&](auto& field) {
        if (n > 0) std::memcpy(static_cast<void*>(&field[first]), from, n * sizeof(field[0]));
        from += n * sizeof(field[0]);
    });
}

template <int D>
std::vector<double> coordinates_of(const Particles<D>& particles,
                                   std::span<const std::uint32_t> chosen) {
    std::vector<double> coordinates;
    coordinates.reserve(chosen.size() * D);
    for (const std::uint32_t p : chosen)
        for (int a = 0; a < D; ++a) coordinates.push_back(particles.position[p][a]);
    return coordinates;
}

/// Sends every particle to its owner.
template <int D>
void migrate(Particles<D>& particles, Exchange& exchange) {
    const std::vector<double> region = exchange.region();
    std::vector<std::uint32_t> leaving, staying;
    for (std::uint32_t p = 0; p < particles.size(); ++p) {
        bool inside = true;
        for (int a = 0; a < D; ++a)
            inside &= particles.position[p][a] >= region[static_cast<std::size_t>(a)] &&
                      particles.position[p][a] < region[static_cast<std::size_t>(D + a)];
        if (!inside) leaving.push_back(p);
    }
    const std::vector<int> owners = exchange.owners(coordinates_of(particles, leaving));
    std::map<int, std::vector<std::uint32_t>> of_rank;
    for (std::size_t k = 0; k < leaving.size(); ++k)
        if (owners[k] != exchange.rank) of_rank[owners[k]].push_back(leaving[k]);
    std::vector<Parcel> parcels;
    std::vector<std::uint8_t> gone(particles.size(), 0);
    for (const auto& [rank, chosen] : of_rank) {
        parcels.push_back({rank, pack(particles, chosen)});
        for (const std::uint32_t p : chosen) gone[p] = 1;
    }
    if (!parcels.empty()) {
        for (std::uint32_t p = 0; p < particles.size(); ++p)
            if (!gone[p]) staying.push_back(p);
        particles.reorder(staying);
    }
    for (const Parcel& parcel : exchange.swap(parcels)) unpack(particles, parcel.content);
}

/// What a particle costs [s], from the time that pairs and everything else have taken and the
/// lengths of the lists; equal shares before there are any. `one_pass`: moving and fixed particles
/// have a pass of their own each, pass_2 and pass_1; otherwise all have pass_1 and moving ones
/// pass_2 besides.
inline std::vector<double> particle_costs(std::span<const ClusterList> clusters, std::size_t width,
                                          std::size_t moving, std::size_t count, PhaseTimer& phases,
                                          int threads, bool one_pass) {
    std::vector<double> costs(count, 1.0);
    if (clusters.empty()) return costs;
    double words_moving = 1.0, words_fixed = 1.0;
    for (std::size_t c = 0; c < clusters.size(); ++c)
        (c * width < moving ? words_moving : words_fixed) +=
            static_cast<double>(clusters[c].words());
    const auto seconds = phases.seconds(threads);
    auto of = [&](Phase phase) { return seconds[static_cast<std::size_t>(phase)]; };
    const double first = of(Phase::pass_1) + of(Phase::stress), second = of(Phase::pass_2);
    const double fixed_word = first / (one_pass ? words_fixed : words_fixed + words_moving);
    const double moving_word = second / words_moving + (one_pass ? 0.0 : fixed_word);
    const double bare =
        (of(Phase::sort) + of(Phase::list_build) + of(Phase::pack) + of(Phase::integrate)) /
        static_cast<double>(clusters.size() * width);
    for (std::size_t p = 0; p < count; ++p) {
        const std::size_t c = std::min(p / width, clusters.size() - 1);
        const double word = c * width < moving ? moving_word : fixed_word;
        costs[p] =
            bare + word * static_cast<double>(clusters[c].words()) / static_cast<double>(width);
    }
    return costs;
}

}  // namespace doseki
