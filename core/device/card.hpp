#pragma once
#include <string>

namespace doseki {

/// Why no graphics card can be used; empty where one can.
std::string card_problem();
/// Lets this process work on one of the cards of the machine: number k, counted round.
void use_card(int k);
/// What the card of this process calls itself.
std::string card_name();
/// How much memory it has [bytes].
double card_memory();
/// What it reads or writes at best [bytes/s], and adds and multiplies [operations/s].
double card_bandwidth();
double card_arithmetic(bool in_double);

}  // namespace doseki
