#pragma once
// Numpy arrays and dictionaries as the bindings read and make them.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <numeric>
#include <vector>

namespace doseki {

namespace nb = nanobind;

template <class T>
using Array = nb::ndarray<nb::numpy, T>;
template <class T>
using Input = nb::ndarray<const T, nb::c_contig, nb::device::cpu>;

/// New numpy array of n rows of the given shape.
template <class T>
struct Output {
    explicit Output(std::vector<std::size_t> shape) : shape(std::move(shape)) {
        data = new T[std::accumulate(this->shape.begin(), this->shape.end(), std::size_t{1},
                                     std::multiplies<>())]();
    }
    Array<T> release() {
        nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<T*>(p); });
        return Array<T>(data, shape.size(), shape.data(), owner);
    }
    std::vector<std::size_t> shape;
    T* data;
};

using Column = std::vector<double>;

template <class T>
T get(const nb::dict& dict, const char* key) {
    return nb::cast<T>(dict[key]);
}

template <class T>
T get(const nb::dict& dict, const char* key, T otherwise) {
    return dict.contains(key) ? get<T>(dict, key) : otherwise;
}

}  // namespace doseki
