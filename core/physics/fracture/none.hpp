#pragma once
#include <limits>

#include "physics/fracture/crack.hpp"

namespace doseki {

/// Holds at any stress.
template <class T>
struct Unbreakable {
    static constexpr const char* name = "none";

    template <class F>
    void members(F&&) {}

    T strength(const CrackSite&) const { return std::numeric_limits<T>::infinity(); }
    T least_strength() const { return std::numeric_limits<T>::infinity(); }
    bool starts(T, const CrackSite&) const { return false; }
    void grow(Crack&, T, T, const CrackSite&) const {}
    T traction(const Crack&, const CrackSite&) const { return T(0); }
    T slope(const Crack&, T, const CrackSite&) const { return T(0); }
    bool failed(const Crack&) const { return false; }
};

}  // namespace doseki
