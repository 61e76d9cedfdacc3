#pragma once
// Archives: the state of a simulation as named arrays, in storage order, and back. Each class lists
// its state once, in `serialise`, for both directions. With the neighbour lists among it, a
// restored simulation goes on with the same sums in the same order, hence with the same bits.

#include <cstring>
#include <string>

#include "base/error.hpp"
#include "base/members.hpp"
#include "bodies/bodies.hpp"
#include "boundaries/open_boundaries.hpp"
#include "interface/value.hpp"
#include "model/particles.hpp"
#include "pairs/neighbour_lists.hpp"

namespace doseki {

/// How many numbers, of which type, an element of a field consists of.
template <class T>
struct Numbers {
    using type = T;
    static constexpr std::size_t count = 1;
};
/// Vectors, tensors and packed structs.
template <template <class, int> class Packed, class T, int D>
struct Numbers<Packed<T, D>> {
    using type = T;
    static constexpr std::size_t count = number_count<Packed<T, D>>();
};
template <>
struct Numbers<BodyKind> {
    using type = std::uint8_t;
    static constexpr std::size_t count = 1;
};
/// Structs of doubles alone.
template <template <int> class Row, int D>
struct Numbers<Row<D>> {
    using type = double;
    static constexpr std::size_t count = sizeof(Row<D>) / sizeof(double);
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

/// Copies the state into new arrays.
class SavingArchive {
public:
    static constexpr bool loading = false;
    NamedValues arrays;

    template <class T>
    void operator()(const char* name, const T& value) {
        using Number = typename Numbers<T>::type;
        static_assert(sizeof(T) == Numbers<T>::count * sizeof(Number), "padding is not state");
        add(name, reinterpret_cast<const Number*>(&value), 1, Numbers<T>::count);
    }

    template <class T>
    void operator()(const char* name, const std::vector<T>& values) {
        using Number = typename Numbers<T>::type;
        static_assert(sizeof(T) == Numbers<T>::count * sizeof(Number), "padding is not state");
        add(name, reinterpret_cast<const Number*>(values.data()), values.size(), Numbers<T>::count);
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

    void operator()(const char*, const std::vector<Tag>& tags);

private:
    void add(const char* name, Array::Numbers first, std::size_t rows, std::size_t columns);

    std::string prefix_;
};

/// Copies arrays made by SavingArchive back; throws std::invalid_argument for others.
class LoadingArchive {
public:
    static constexpr bool loading = true;
    explicit LoadingArchive(const NamedValues& arrays) : arrays_(arrays) {}

    template <class T>
    void operator()(const char* name, T& value) {
        std::vector<T> one;
        (*this)(name, one);
        expect_fit(one.size() == 1, name);
        value = one[0];
    }

    template <class T>
    void operator()(const char* name, std::vector<T>& values) {
        using Number = typename Numbers<T>::type;
        const Array& array = find(name, Numbers<T>::count);
        const auto* numbers = std::get_if<const Number*>(&array.numbers);
        expect_fit(numbers != nullptr, name);
        values.resize(array.rows());
        if (array.size() > 0)
            std::memcpy(static_cast<void*>(values.data()), *numbers, array.size() * sizeof(Number));
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

    void operator()(const char* name, std::vector<Tag>& tags);

private:
    /// An array of one row for each element, of `columns` numbers.
    const Array& find(const char* name, std::size_t columns) const;

    const NamedValues& arrays_;
    std::string prefix_;
};

// Compiled once, in archive.cpp.
extern template void Bodies<2>::serialise(SavingArchive&);
extern template void Bodies<2>::serialise(LoadingArchive&);
extern template void Bodies<3>::serialise(SavingArchive&);
extern template void Bodies<3>::serialise(LoadingArchive&);
extern template void Neighbours<2>::serialise(SavingArchive&);
extern template void Neighbours<2>::serialise(LoadingArchive&);
extern template void Neighbours<3>::serialise(SavingArchive&);
extern template void Neighbours<3>::serialise(LoadingArchive&);
extern template void OpenBoundaries<2>::serialise(SavingArchive&);
extern template void OpenBoundaries<2>::serialise(LoadingArchive&);
extern template void OpenBoundaries<3>::serialise(SavingArchive&);
extern template void OpenBoundaries<3>::serialise(LoadingArchive&);

}  // namespace doseki
