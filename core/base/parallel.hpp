#pragma once
#include <cstddef>

namespace doseki {

/// Below these sizes a loop ends sooner on one thread than it takes to call the others.
inline constexpr std::size_t light_loop = 2048;  // particles, a few operations each
inline constexpr std::size_t pair_loop = 32;     // clusters

}  // namespace doseki
