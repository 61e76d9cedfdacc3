#pragma once
// Functions of a row of numbers, bound as functions of arrays that are evaluated either one number
// at a time or pack by pack: tests compare both with calculus and closed forms.

#include <nanobind/nanobind.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <vector>

#include "base/vec.hpp"

namespace doseki {

namespace nb = nanobind;

using Column = std::vector<double>;
using Table = std::vector<Column>;  // one column per argument or result

/// Applies f(arguments) -> results to every row; T is double, or a Pack that takes several rows.
template <class T, class F>
Table evaluate(const Table& arguments, int results, F&& f) {
    constexpr int width = [] {
        if constexpr (std::is_same_v<T, double>)
            return 1;
        else
            return static_cast<int>(T::size());
    }();
    const std::size_t n = arguments.front().size();
    Table out(static_cast<std::size_t>(results), Column(n));
    for (std::size_t first = 0; first < n; first += width) {
        auto row = [&](int l) { return std::min(first + static_cast<std::size_t>(l), n - 1); };
        std::vector<T> in, result(static_cast<std::size_t>(results));
        for (const Column& column : arguments) {
            if constexpr (std::is_same_v<T, double>)
                in.push_back(column[first]);
            else
                in.push_back(T([&](auto l) { return column[row(l)]; }));
        }
        f(in, result);
        for (int k = 0; k < results; ++k)
            for (int l = 0; l < width; ++l) {
                if constexpr (std::is_same_v<T, double>)
                    out[k][first] = result[k];
                else
                    out[k][row(l)] = result[k][l];
            }
    }
    return out;
}

template <class F>
void define(nb::module_& m, const char* name, int results, F f) {
    m.def(
        name,
        [results, f](const Table& arguments, bool pack) {
            return pack ? evaluate<Pack<double>>(arguments, results, f)
                        : evaluate<double>(arguments, results, f);
        },
        nb::arg("columns"), nb::arg("pack") = false);
}

/// As define, for functions of plain numbers that no pair loop calls.
template <class F>
void define_numbers(nb::module_& m, const char* name, int results, F f) {
    m.def(
        name,
        [results, f](const Table& arguments, bool) {
            return evaluate<double>(arguments, results, f);
        },
        nb::arg("columns"), nb::arg("pack") = false);
}

template <int D, class T>
Vec<T, D> vector(const std::vector<T>& in, std::size_t first) {
    Vec<T, D> v;
    for (std::size_t a = 0; a < D; ++a) v[static_cast<int>(a)] = in[first + a];
    return v;
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

/// Puts the components of a vector, matrix or tensor first into the results.
template <class Tensor, class Results>
void put(const Tensor& tensor, Results& out) {
    if constexpr (requires { tensor.component; })
        std::copy(tensor.component.begin(), tensor.component.end(), out.begin());
    else
        std::copy(tensor.element.begin(), tensor.element.end(), out.begin());
}

/// The number type of a row of arguments.
template <class Row>
using NumberOf = typename std::decay_t<Row>::value_type;

}  // namespace doseki
