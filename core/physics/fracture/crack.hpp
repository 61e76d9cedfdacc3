#pragma once
#include <cstdint>

namespace doseki {

/// What the crack across one bond remembers: how far it is open and was at most [m], and what part
/// of its stiffness is gone.
struct Crack {
    double opening = 0.0, max_opening = 0.0, damage = 0.0;
};

/// A place at which a material may crack.
struct CrackSite {
    double stiffness;   // of the material across it over its length [Pa/m]
    double young;       // Young's modulus [Pa]
    double volume;      // share of the body's volume [m^3], 2-D: of 1 m across
    double growth;      // speed of cracks over the size of the place [1/s]
    std::uint64_t key;  // its random numbers
    std::uint64_t seed;
    double tip;  // tension at which a crack that ends here goes on; infinite: none does [Pa]
};

}  // namespace doseki
