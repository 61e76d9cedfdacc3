#pragma once
// Archives: the state of a simulation as named arrays, in storage order, and back. Each class lists
// its state once, in `serialise`, for both directions. With the neighbour lists among it, a
// restored simulation goes on with the same sums in the same order, hence with the same bits.

#include <cstring>
#include <stdexcept>
#include <string>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "bodies/bodies.hpp"
#include "particles.hpp"
#include "records.hpp"

namespace doseki {

/// How many numbers, of which type, an element of a field consists of.
template <class T>
struct Numbers {
    using type = T;
    static constexpr std::size_t count = 1;
};
template <class T, int D>
struct Numbers<Vec<T, D>> {
    using type = T;
    static constexpr std::size_t count = D;
};
template <class T, int D>
struct Numbers<Mat<T, D>> {
    using type = T;
    static constexpr std::size_t count = D * D;
};
template <class T, int D>
struct Numbers<Deviator<T, D>> {
    using type = T;
    static constexpr std::size_t count = Deviator<T, D>::size;
};
template <class T, int D>
struct Numbers<StressRecord<T, D>> {
    using type = T;
    static constexpr std::size_t count = Sym<T, D>::size + 3;
};

template <int D>
struct Numbers<BodyPoint<D>> {
    using type = double;
    static constexpr std::size_t count = sizeof(BodyPoint<D>) / sizeof(double);
};
template <int D>
struct Numbers<BodyState<D>> {
    using type = double;
    static constexpr std::size_t count = sizeof(BodyState<D>) / sizeof(double);
};

/// Tags as one vector for each member: a Tag has padding, which is not state.
struct TagColumns {
    std::vector<std::int64_t> id;
    std::vector<std::int32_t> body;
    std::vector<std::int16_t> material;
    std::vector<std::uint8_t> motion;

    template <class Archive>
    void serialise(Archive& archive) {
        archive("id", id), archive("body", body), archive("material", material),
            archive("motion", motion);
    }
};

/// Copies the state into new numpy arrays.
class SavingArchive {
public:
    static constexpr bool loading = false;
    nanobind::dict arrays;

    template <class T>
    void operator()(const char* name, const T& value) {
        add(name, &value, 1, 1);
    }

    template <class T>
    void operator()(const char* name, const std::vector<T>& values) {
        using Element = Numbers<T>;
        static_assert(sizeof(T) == Element::count * sizeof(typename Element::type),
                      "padding is not state");
        add(name, reinterpret_cast<const typename Element::type*>(values.data()), values.size(),
            Element::count);
    }

    void operator()(const char* name, bool value) {
        (*this)(name, static_cast<std::uint8_t>(value));
    }

    /// A part of which there may be several: its names begin with `prefix`.
    template <class Part>
    void nested(const std::string& prefix, Part& part) {
        prefix_ = prefix;
        part.serialise(*this);
        prefix_.clear();
    }

    void operator()(const char*, const std::vector<Tag>& tags) {
        TagColumns columns;
        for (const Tag& tag : tags) {
            columns.id.push_back(tag.id), columns.body.push_back(tag.body);
            columns.material.push_back(tag.material);
            columns.motion.push_back(static_cast<std::uint8_t>(tag.motion));
        }
        columns.serialise(*this);
    }

private:
    template <class T>
    void add(const char* name, const T* values, std::size_t rows, std::size_t columns) {
        T* const copy = new T[rows * columns + 1];
        std::copy(values, values + rows * columns, copy);
        nanobind::capsule owner(copy, [](void* p) noexcept { delete[] static_cast<T*>(p); });
        const std::size_t shape[] = {rows, columns};
        arrays[(prefix_ + name).c_str()] =
            nanobind::ndarray<nanobind::numpy, T>(copy, columns == 1 ? 1 : 2, shape, owner);
    }

    std::string prefix_;
};

/// Copies numpy arrays made by SavingArchive back; throws std::invalid_argument for others.
class LoadingArchive {
public:
    static constexpr bool loading = true;
    explicit LoadingArchive(const nanobind::dict& arrays) : arrays_(arrays) {}

    template <class T>
    void operator()(const char* name, T& value) {
        std::vector<T> one;
        (*this)(name, one);
        check(one.size() == 1, name);
        value = one[0];
    }

    template <class T>
    void operator()(const char* name, std::vector<T>& values) {
        using Number = typename Numbers<T>::type;
        using Array = nanobind::ndarray<const Number, nanobind::c_contig, nanobind::device::cpu>;
        Array array;
        const std::string key = prefix_ + name;
        check(arrays_.contains(key.c_str()) && nanobind::try_cast(arrays_[key.c_str()], array),
              name);
        const std::size_t columns = array.ndim() == 2 ? array.shape(1) : 1;
        check(array.ndim() >= 1 && array.ndim() <= 2 && columns == Numbers<T>::count, name);
        values.resize(array.shape(0));
        if (array.size() > 0)
            std::memcpy(static_cast<void*>(values.data()), array.data(),
                        array.size() * sizeof(Number));
    }

    void operator()(const char* name, bool& value) {
        std::uint8_t number = 0;
        (*this)(name, number);
        value = number != 0;
    }

    template <class Part>
    void nested(const std::string& prefix, Part& part) {
        prefix_ = prefix;
        part.serialise(*this);
        prefix_.clear();
    }

    void operator()(const char* name, std::vector<Tag>& tags) {
        TagColumns columns;
        columns.serialise(*this);
        const std::size_t n = columns.id.size();
        check(
            columns.body.size() == n && columns.material.size() == n && columns.motion.size() == n,
            name);
        tags.resize(n);
        for (std::size_t p = 0; p < n; ++p)
            tags[p] = {columns.id[p], columns.body[p], columns.material[p],
                       static_cast<Motion>(columns.motion[p])};
    }

private:
    static void check(bool good, const char* name) {
        if (!good)
            throw std::invalid_argument(std::string("not the state of this simulation: ") + name);
    }

    nanobind::dict arrays_;
    std::string prefix_;
};

}  // namespace doseki
