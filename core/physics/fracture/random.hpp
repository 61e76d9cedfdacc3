#pragma once
#include <cstdint>

namespace doseki {

/// Random number in (0, 1) that follows from three whole numbers alone: whoever asks, in whatever
/// order, gets the same (the finaliser of SplitMix64, Steele, Lea and Flood, OOPSLA 2014).
inline double random_number(std::uint64_t seed, std::uint64_t site, std::uint64_t count) {
    auto mix = [](std::uint64_t z) {
        z += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    };
    const std::uint64_t bits = mix(mix(mix(seed) ^ site) ^ count);
    return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

}  // namespace doseki
