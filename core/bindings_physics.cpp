// The point functions of core/physics on arrays, evaluated either one number at a time or pack by
// pack: tests compare both with calculus and closed forms.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include "physics/equation_of_state.hpp"
#include "physics/kernel.hpp"
#include "physics/momentum.hpp"
#include "physics/stress.hpp"
#include "physics/timestep.hpp"
#include "physics/velocity_gradient.hpp"

namespace nb = nanobind;
using namespace doseki;

namespace {

using Column = std::vector<double>;
using Table = std::vector<Column>;    // one column per argument or result

/// Applies f(arguments) -> results to every row; T is double, or a Pack that takes several rows.
template <class T, class F>
Table evaluate(const Table& arguments, int results, F&& f) {
    constexpr int width = [] {
        if constexpr (std::is_same_v<T, double>) return 1;
        else return static_cast<int>(T::size());
    }();
    const std::size_t n = arguments.front().size();
    Table out(static_cast<std::size_t>(results), Column(n));
    for (std::size_t first = 0; first < n; first += width) {
        auto row = [&](int l) { return std::min(first + static_cast<std::size_t>(l), n - 1); };
        std::vector<T> in, result(static_cast<std::size_t>(results));
        for (const Column& column : arguments) {
            if constexpr (std::is_same_v<T, double>) in.push_back(column[first]);
            else in.push_back(T([&](auto l) { return column[row(l)]; }));
        }
        f(in, result);
        for (int k = 0; k < results; ++k)
            for (int l = 0; l < width; ++l) {
                if constexpr (std::is_same_v<T, double>) out[k][first] = result[k];
                else out[k][row(l)] = result[k][l];
            }
    }
    return out;
}

template <class F>
void define(nb::module_& m, const char* name, int results, F f) {
    m.def(name, [results, f](const Table& arguments, bool pack) {
        return pack ? evaluate<Pack<double>>(arguments, results, f) : evaluate<double>(arguments, results, f);
    }, nb::arg("columns"), nb::arg("pack") = false);
}

template <int D, class T>
Mat<T, D> matrix(const std::vector<T>& in, std::size_t first) {
    Mat<T, D> m;
    for (std::size_t k = 0; k < D * D; ++k) m.element[k] = in[first + k];
    return m;
}

template <int D, class T>
Deviator<T, D> deviator(const std::vector<T>& in, std::size_t first) {
    Deviator<T, D> s;
    for (std::size_t k = 0; k < Deviator<T, D>::size; ++k) s.element[k] = in[first + k];
    return s;
}

template <int D>
void bind_dimension(nb::module_& m) {
    define(m, "kernel", 2, [](const auto& in, auto& out) {    // r, 1/R -> W, F
        out[0] = WendlandC6<D>::value(in[0], in[1]);
        out[1] = WendlandC6<D>::gradient_factor(in[0], in[1]);
    });
    define(m, "elastic_stress_rate", Deviator<double, D>::size, [](const auto& in, auto& out) {    // L, S, mu
        const auto rate = elastic_stress_rate(matrix<D>(in, 0), deviator<D>(in, D * D), in.back());
        std::copy(rate.element.begin(), rate.element.end(), out.begin());
    });
    define(m, "newtonian_stress", Deviator<double, D>::size, [](const auto& in, auto& out) {    // L, rho, nu
        const auto tau = newtonian_stress(matrix<D>(in, 0), in[D * D], in[D * D + 1]);
        std::copy(tau.element.begin(), tau.element.end(), out.begin());
    });
    define(m, "balsara_switch", 1, [](const auto& in, auto& out) {    // L, c, h
        out[0] = balsara_switch(matrix<D>(in, 0), in[D * D], in[D * D + 1]);
    });
    define(m, "stress_over_rho_squared", Sym<double, D>::size, [](const auto& in, auto& out) {    // S, p, rho
        constexpr std::size_t size = Deviator<double, D>::size;
        const auto stress = stress_over_rho_squared(in[size], deviator<D>(in, 0), in[size + 1]);
        std::copy(stress.element.begin(), stress.element.end(), out.begin());
    });
    define(m, "shear_energy", 1, [](const auto& in, auto& out) {    // S, mu, rho
        constexpr std::size_t size = Deviator<double, D>::size;
        out[0] = shear_energy(deviator<D>(in, 0), in[size], in[size + 1]);
    });
}

}  // namespace

void bind_physics(nb::module_& m) {
    nb::module_ two = m.def_submodule("two"), three = m.def_submodule("three");
    bind_dimension<2>(two);
    bind_dimension<3>(three);
    define(m, "equation_of_state", 3, [](const auto& in, auto& out) {    // rho, rho0, c0 -> p, c, u
        const auto eos = BirchMurnaghan<std::decay_t<decltype(in[0])>>::at(in[0], in[1], in[2]);
        out[0] = eos.pressure, out[1] = eos.sound_speed, out[2] = eos.bulk_energy;
    });
    define(m, "approach_speed", 1, [](const auto& in, auto& out) { out[0] = approach_speed(in[0], in[1]); });
    define(m, "signal_velocity", 1, [](const auto& in, auto& out) { out[0] = signal_velocity(in[0], in[1], in[2]); });
    define(m, "artificial_viscosity", 1, [](const auto& in, auto& out) {    // alpha, v_sig, w, rho_i, rho_j
        out[0] = artificial_viscosity(in[0], in[1], in[2], in[3], in[4]);
    });
    define(m, "timestep", 1, [](const auto& in, auto& out) {    // h, v_sig, |a|, C_CFL, C_f
        out[0] = timestep(in[0], in[1], in[2], in[3], in[4]);
    });
}
