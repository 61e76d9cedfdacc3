#pragma once
#include <string>

namespace doseki {

/// Why no graphics card can be used; empty where one can.
std::string card_problem();
/// What the first card calls itself.
std::string card_name();

}  // namespace doseki
