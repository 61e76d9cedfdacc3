#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace doseki {

/// Index along the Hilbert curve through a cube of 2^bits cells a side, from the Morton key of a
/// cell (J. Skilling, AIP Conf. Proc. 707 (2004) 381).
template <int D>
constexpr std::uint32_t hilbert_index(std::uint32_t morton, int bits) {
    std::array<std::uint32_t, D> x{};
    for (int bit = 0; bit < bits; ++bit)
        for (int a = 0; a < D; ++a) x[a] |= (morton >> (bit * D + a) & 1u) << bit;
    for (std::uint32_t top = 1u << bits >> 1; top > 1; top >>= 1) {
        const std::uint32_t below = top - 1;
        for (int a = 0; a < D; ++a) {
            const std::uint32_t swap = x[a] & top ? 0 : (x[0] ^ x[a]) & below;
            if (x[a] & top) x[0] ^= below;
            x[0] ^= swap, x[a] ^= swap;
        }
    }
    for (int a = 1; a < D; ++a) x[a] ^= x[a - 1];
    std::uint32_t flips = 0;
    for (std::uint32_t top = 1u << bits >> 1; top > 1; top >>= 1)
        if (x[D - 1] & top) flips ^= top - 1;
    std::uint32_t index = 0;
    for (int bit = bits - 1; bit >= 0; --bit)
        for (int a = 0; a < D; ++a) index = index << 1 | ((x[a] ^ flips) >> bit & 1u);
    return index;
}

/// The indices of all Morton keys of a cube of 2^bits cells a side; of a smaller one where that
/// would not stay in the nearest cache, and curves of which the ends do not meet matter little.
template <int D>
std::span<const std::uint16_t> hilbert_curve(int bits) {
    constexpr int most = D == 2 ? 4 : 3;
    static const auto curves = [] {
        std::array<std::array<std::uint16_t, std::size_t{1} << (most * D)>, most + 1> all{};
        for (int size = 0; size <= most; ++size)
            for (std::uint32_t key = 0; key < 1u << (size * D); ++key)
                all[static_cast<std::size_t>(size)][key] =
                    static_cast<std::uint16_t>(hilbert_index<D>(key, size));
        return all;
    }();
    const int size = std::min(bits, most);
    return std::span(curves[static_cast<std::size_t>(size)]).first(std::size_t{1} << (size * D));
}

}  // namespace doseki
