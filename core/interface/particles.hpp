#pragma once
// Particles as tables of columns, in and out.

#include <cstring>
#include <functional>
#include <type_traits>
#include <vector>

#include "base/array.hpp"
#include "interface/value.hpp"
#include "model/particles.hpp"
#include "physics/equation_of_state/thermodynamic_state.hpp"
#include "physics/wall.hpp"

namespace doseki {

/// What a scheme knows of a particle beyond its fields.
template <int D>
struct PointState {
    ThermodynamicState<double> eos;
    Deviator<double, D> deviator;  // of the whole stress [Pa]
    Deviator<double, D> elastic;   // the part of it that evolves [Pa]
};
template <int D>
using PointStates = std::function<PointState<D>(std::size_t)>;

template <int D>
struct ParticleTables {
    static std::size_t count(const NamedValues& columns);
    /// Sets the particles from `first` on; returns the number after the largest id among them.
    static std::int64_t set(Particles<D>& particles, std::size_t first, const NamedValues& columns);
    static void set_walls(Particles<D>& particles, const NamedValues& columns);
    static void set_edges(Particles<D>& particles, const NamedValues& columns);
    static void set_faces(Particles<D>& particles, const NamedValues& columns);

    /// Indices of the particles in the order of their ids.
    static Array<std::size_t> id_order(const Particles<D>& particles);
    /// The same of those in a box.
    static Array<std::size_t> inside(const Particles<D>& particles, std::span<const double> low,
                                     std::span<const double> high);
    /// Columns of the particles in `order` that gauges read.
    static NamedValues sample(const Particles<D>& particles, const Array<std::size_t>& order,
                              const PointStates<D>& states);
    /// All fields of a particle but the stress.
    static NamedValues fields(const Particles<D>& particles, const Array<std::size_t>& order,
                              const PointStates<D>& states);
    static NamedValues rates(const Particles<D>& particles, const Array<std::size_t>& order);

    /// One field of the particles in `order`: of numbers, vectors or matrices.
    template <class FieldType>
    static Value column(const FieldType& field, const Array<std::size_t>& order) {
        using T = typename FieldType::value_type;
        std::vector<std::size_t> shape{order.size()};
        if constexpr (std::is_same_v<T, Vec<double, D>>) shape = {order.size(), D};
        if constexpr (std::is_same_v<T, Mat<double, D>>) shape = {order.size(), D, D};
        constexpr std::size_t numbers = sizeof(T) / sizeof(double);
        NewArray<double> column(shape);
        for (std::size_t k = 0; k < order.size(); ++k)
            std::memcpy(column.data() + numbers * k, &field[order[k]], sizeof(T));
        return column;
    }
    /// Stresses, all nine components of each.
    static Value stresses(const Array<std::size_t>& order,
                          const std::function<Deviator<double, D>(std::size_t)>& deviator);

    /// The deviators of `count` particles from a column `deviatoric_stress` of nine components.
    static Array<Deviator<double, D>> deviators(const NamedValues& columns, std::size_t count);

    /// All nine components of S - p I.
    static void fill_stress(double* out, double p, const Deviator<double, D>& S) {
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) out[3 * a + b] = S(std::min(a, b), std::max(a, b));
        out[8] = S.zz();
        for (int a = 0; a < 3; ++a) out[4 * a] -= p;
    }
};

extern template struct ParticleTables<2>;
extern template struct ParticleTables<3>;

}  // namespace doseki
