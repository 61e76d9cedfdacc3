#pragma once
#include <algorithm>

#include "physics/fracture/crack.hpp"

namespace doseki {

/// Eq. (110): the stress across a crack falls from the tensile strength to nothing in proportion to
/// its opening, over an area that is the fracture energy (Hillerborg, Modeer and Petersson, Cem.
/// Concr. Res. 6, 1976). A crack that closes goes back to the origin.
template <class T>
struct Cohesive {
    static constexpr const char* name = "cohesive";

    T tensile_strength{}, fracture_energy{};  // [Pa], [J/m^2]

    template <class F>
    void members(F&& f) {
        f("tensile_strength", tensile_strength), f("fracture_energy", fracture_energy);
    }

    /// At which no stress is left [m].
    T critical_opening() const { return T(2) * fracture_energy / tensile_strength; }

    T strength(const CrackSite&) const { return tensile_strength; }
    T least_strength() const { return tensile_strength; }
    bool starts(T tension, const CrackSite&) const { return tension >= tensile_strength; }
    void grow(Crack& crack, T, T, const CrackSite&) const {
        crack.damage = std::min(T(1), crack.max_opening / critical_opening());
    }
    T envelope(T opening) const {
        return tensile_strength * std::max(T(0), T(1) - opening / critical_opening());
    }
    T traction(const Crack& crack, const CrackSite&) const {
        if (crack.opening >= crack.max_opening) return envelope(crack.opening);
        return envelope(crack.max_opening) * crack.opening / crack.max_opening;
    }
    /// Of the traction over the opening, where that makes a step of the opening smaller.
    T slope(const Crack& crack, T tension, const CrackSite& site) const {
        const bool widens = crack.opening >= crack.max_opening && tension >= traction(crack, site);
        return widens || !(crack.max_opening > T(0))
                   ? T(0)
                   : envelope(crack.max_opening) / crack.max_opening;
    }
    bool failed(const Crack& crack) const { return crack.max_opening >= critical_opening(); }
};

}  // namespace doseki
