#pragma once
// Materials, options and the domain of a run as the caller names them.

#include "base/array.hpp"
#include "interface/value.hpp"
#include "model/domain.hpp"
#include "model/material.hpp"
#include "model/options.hpp"

namespace doseki {

/// What a simulation is made from.
template <int D>
struct Setup {
    Array<Material> materials;
    Options<D> options;
    Domain<D> domain;

    /// Throws std::invalid_argument for an unknown or missing key or word, which it names.
    static Setup read(std::span<const NamedValues> materials, const NamedValues& options);
};

extern template struct Setup<2>;
extern template struct Setup<3>;

}  // namespace doseki
