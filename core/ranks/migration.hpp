#pragma once
// Who owns what: particles go to the rank whose part of space they are in.

#include <cstring>
#include <map>

#include "base/array.hpp"
#include "cells/sweeps.hpp"
#include "model/particles.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// All fields of some particles, field by field.
template <int D>
Bytes pack(Particles<D>& particles, std::span<const std::uint32_t> chosen) {
    Bytes bytes;
    for (const auto& [name, memory] : particles.fields())
        for (const std::uint32_t p : chosen) {
            const std::byte* const value = memory->element(p);
            if (value)
                bytes.insert(bytes.end(), value, value + memory->element_size());
            else
                bytes.resize(bytes.size() + memory->element_size());
        }
    return bytes;
}

/// Appends particles that pack() made bytes of.
template <int D>
void unpack(Particles<D>& particles, const Bytes& bytes) {
    std::size_t each = 0;
    for (const auto& [name, memory] : particles.fields()) each += memory->element_size();
    const std::size_t first = particles.size(), n = bytes.size() / each;
    resize(particles, first + n);
    const std::byte* from = bytes.data();
    for (const auto& [name, memory] : particles.fields()) {
        const std::size_t size = n * memory->element_size();
        if (n > 0) std::memcpy(memory->element(first), from, size);
        from += size;
    }
}

template <int D>
Array<double> coordinates_of(const Particles<D>& particles, std::span<const std::uint32_t> chosen) {
    Array<double> coordinates;
    coordinates.reserve(chosen.size() * D);
    for (const std::uint32_t p : chosen)
        for (int a = 0; a < D; ++a) coordinates.push_back(particles.position[p][a]);
    return coordinates;
}

/// Sends every particle to its owner.
template <int D>
void migrate(Particles<D>& particles, Exchange& exchange) {
    const Array<double> region = exchange.region();
    Array<std::uint32_t> leaving, staying;
    for (std::uint32_t p = 0; p < particles.size(); ++p) {
        bool inside = true;
        for (int a = 0; a < D; ++a)
            inside &= particles.position[p][a] >= region[static_cast<std::size_t>(a)] &&
                      particles.position[p][a] < region[static_cast<std::size_t>(D + a)];
        if (!inside) leaving.push_back(p);
    }
    const Array<int> owners = exchange.owners(coordinates_of(particles, leaving));
    std::map<int, Array<std::uint32_t>> of_rank;
    for (std::size_t k = 0; k < leaving.size(); ++k)
        if (owners[k] != exchange.rank) of_rank[owners[k]].push_back(leaving[k]);
    Array<Parcel> parcels;
    Array<std::uint8_t> gone(particles.size(), 0);
    for (const auto& [rank, chosen] : of_rank) {
        parcels.push_back({rank, pack(particles, chosen)});
        for (const std::uint32_t p : chosen) gone[p] = 1;
    }
    if (!parcels.empty()) {
        for (std::uint32_t p = 0; p < particles.size(); ++p)
            if (!gone[p]) staying.push_back(p);
        reorder(particles, staying);
    }
    for (const Parcel& parcel : exchange.swap(parcels)) unpack(particles, parcel.content);
}

}  // namespace doseki
