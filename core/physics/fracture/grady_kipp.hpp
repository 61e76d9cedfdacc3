#pragma once
#include <algorithm>
#include <cmath>

#include "physics/fracture/crack.hpp"
#include "physics/fracture/random.hpp"

namespace doseki {

/// Eqs. (112) to (114): flaws that give way at strains of a Weibull distribution, and damage that
/// grows from those that did (Grady and Kipp, Int. J. Rock Mech. Min. Sci. 17, 1980; Benz and
/// Asphaug, Icarus 107, 1994, and Comput. Phys. Commun. 87, 1995).
template <class T>
struct GradyKipp {
    static constexpr const char* name = "grady_kipp";
    /// More flaws at one place than these make no difference: damage is complete in a step.
    static constexpr int max_flaws = 64;

    T weibull_k{}, weibull_m{};  // [1/m^3], 1

    template <class F>
    void members(F&& f) {
        f("weibull_k", weibull_k), f("weibull_m", weibull_m);
    }

    /// Flaws at a site that give way below a strain: the events of a Poisson process.
    int active_flaws(T strain, const CrackSite& site) const {
        if (!(strain > T(0))) return 0;
        const T expected = weibull_k * site.volume * std::pow(strain, weibull_m);
        T sum = T(0);
        for (int n = 0; n < max_flaws; ++n) {
            sum -= std::log(random_number(site.seed, site.key, static_cast<std::uint64_t>(n)));
            if (sum > expected) return n;
        }
        return max_flaws;
    }

    /// Eq. (112) of the first flaw, or that from which a crack came here.
    T strength(const CrackSite& site) const {
        const T first = -std::log(random_number(site.seed, site.key, 0));
        const T own = site.young * std::pow(first / (weibull_k * site.volume), T(1) / weibull_m);
        return std::min(own, T(site.tip));
    }
    T least_strength() const { return T(0); }
    bool starts(T tension, const CrackSite& site) const {
        return tension >= T(site.tip) || active_flaws(tension / site.young, site) > 0;
    }
    /// The strain is that of the material and the crack together.
    void grow(Crack& crack, T tension, T dt, const CrackSite& site) const {
        const T whole = tension + site.stiffness * crack.opening;
        const int flaws =
            active_flaws(whole / site.young, site) + static_cast<int>(whole >= T(site.tip));
        const T size = std::cbrt(crack.damage) + flaws * site.growth * dt;
        crack.damage = std::min(T(1), size * size * size);
    }
    T traction(const Crack& crack, const CrackSite& site) const {
        return slope(crack, T(0), site) * crack.opening;
    }
    T slope(const Crack& crack, T, const CrackSite& site) const {
        const T least = T(1e-6);  // of a crack that has just begun
        return (T(1) - crack.damage) / std::max(crack.damage, least) * site.stiffness;
    }
    bool failed(const Crack& crack) const { return crack.damage >= T(1); }
};

}  // namespace doseki
