#pragma once
#include <cstdint>

namespace doseki {

/// Where in the lists a pair stands: its cluster, by the first particle of that, and its number in
/// the list. A term that declares `using SeesEntries = void` is given it, as the last argument of
/// `add`, to find what it keeps for each pair.
struct PairEntry {
    std::uint32_t first, number;
};

template <class Term>
concept SeesEntries = requires { typename Term::SeesEntries; };

}  // namespace doseki
