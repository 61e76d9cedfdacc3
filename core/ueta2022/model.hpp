#pragma once
#include <cmath>

#include "base/array.hpp"
#include "ueta2022/laws.hpp"

namespace doseki {

/// What the parts of the ueta2022 scheme share: materials, options, and what follows from them
/// once.
template <int D>
struct Ueta2022Model {
    Array<Material> materials;
    Options<D> options;
    Array<YieldSurface<double>> surfaces;  // by material
    bool yields = false;                   // any of them

    Ueta2022Model(Array<Material> given, const Options<D>& opts)
        : materials(std::move(given)), options(opts) {
        for (const Material& material : materials) {
            surfaces.push_back(yield_surface<D>(material));
            yields |= std::isfinite(surfaces.back().k);
        }
    }

    /// With the tension cut of what yields, Eq. (62).
    DOSEKI_DEVICE_FN ThermodynamicState<double> equation_of_state(const Tag& tag,
                                                                  double rho) const {
        auto state =
            doseki::equation_of_state(materials[tag.material], rho, tag.motion, options.tension);
        state.pressure = tension_cut(surfaces[tag.material], state.pressure);
        return state;
    }
};

}  // namespace doseki
