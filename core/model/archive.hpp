#pragma once
// Archives: the state of a simulation as named arrays, in storage order, and back. Each class lists
// its state once, in `serialise`, for both directions. With the neighbour lists among it, a
// restored simulation goes on with the same sums in the same order, hence with the same bits.

#include <cstring>
#include <string>
#include <utility>
#include <variant>

#include "base/array.hpp"
#include "base/error.hpp"
#include "base/field.hpp"
#include "base/members.hpp"

namespace doseki {

struct Tag;

/// The first of some numbers.
using NumberPointer = std::variant<const double*, const float*, const std::int64_t*,
                                   const std::uint64_t*, const std::int32_t*, const std::uint32_t*,
                                   const std::int16_t*, const std::uint8_t*, const bool*>;

/// How many numbers, of which type, an element of a field consists of.
template <class T>
struct Numbers {
    using type = T;
    static constexpr std::size_t count = 1;
};
template <class T>
    requires std::is_enum_v<T>
struct Numbers<T> {
    using type = std::underlying_type_t<T>;
    static constexpr std::size_t count = 1;
};
/// Vectors, tensors and packed structs.
template <template <class, int> class Packed, class T, int D>
struct Numbers<Packed<T, D>> {
    using type = T;
    static constexpr std::size_t count = number_count<Packed<T, D>>();
};
/// Structs of doubles alone.
template <template <int> class Row, int D>
struct Numbers<Row<D>> {
    using type = double;
    static constexpr std::size_t count = sizeof(Row<D>) / sizeof(double);
};

/// Saves what it is called with, or loads it: then it throws std::invalid_argument, which names the
/// array, where that is not one of such elements.
class Archive {
public:
    explicit Archive(bool loads) : loads_(loads) {}
    virtual ~Archive() = default;

    bool loads() const { return loads_; }

    template <class T>
    void operator()(const char* name, T& value) {
        if (!loads_) return put(name, &value, 1);
        const Loaded<T> from = get<T>(name);
        expect_fit(from.rows == 1, name);
        std::memcpy(static_cast<void*>(&value), from.numbers, sizeof(T));
    }
    template <class T>
    void operator()(const char* name, Array<T>& values) {
        column(name, values);
    }
    template <class T>
    void operator()(const char* name, Field<T>& values) {
        column(name, values);
    }
    /// As long as a field of all particles: what is stored is no business of an archive's.
    template <class T, FieldOf of>
    void operator()(const char* name, PartField<T, of>& values) {
        Array<T> all;
        if (!loads_)
            for (std::size_t p = 0; p < values.size(); ++p) all.push_back(std::as_const(values)[p]);
        column(name, all);
        if (loads_) values.assign(std::span<const T>(all));
    }
    void operator()(const char* name, bool& value);
    /// One array for each member: a Tag has padding, which is not state.
    void operator()(const char* name, Field<Tag>& tags);

    /// A part of which there may be several: its names begin with `prefix`.
    template <class Part>
    void nested(const std::string& prefix, Part& part) {
        prefix_ = prefix;
        part.serialise(*this);
        prefix_.clear();
    }

protected:
    /// Rows of `columns` numbers each.
    struct Rows {
        NumberPointer first;
        std::size_t rows, columns;
    };
    virtual void save(const std::string& name, const Rows& rows) = 0;
    /// Rows 0 and columns 0 where there is no such array.
    virtual Rows load(const std::string& name) const = 0;

private:
    template <class T>
    struct Loaded {
        const typename Numbers<T>::type* numbers;
        std::size_t rows;
    };

    template <class T>
    void put(const char* name, const T* elements, std::size_t count) {
        using Number = typename Numbers<T>::type;
        static_assert(sizeof(T) == Numbers<T>::count * sizeof(Number), "padding is not state");
        save(prefix_ + name, {reinterpret_cast<const Number*>(elements), count, Numbers<T>::count});
    }
    template <class T>
    Loaded<T> get(const char* name) const {
        const Rows rows = load(prefix_ + name);
        expect_fit(rows.columns == Numbers<T>::count, name);
        const auto* numbers = std::get_if<const typename Numbers<T>::type*>(&rows.first);
        expect_fit(numbers != nullptr, name);
        return {*numbers, rows.rows};
    }
    template <class Column>
    void column(const char* name, Column& values) {
        using T = typename Column::value_type;
        if (!loads_) return put(name, values.data(), values.size());
        const Loaded<T> from = get<T>(name);
        values.resize(from.rows);
        if (from.rows > 0)
            std::memcpy(static_cast<void*>(values.data()), from.numbers, from.rows * sizeof(T));
    }

    bool loads_;
    std::string prefix_;
};

}  // namespace doseki
