#pragma once
// Values with names, as a caller hands them in and gets them back: numbers, words, arrays, lists
// and tables. What speaks another language (core/python) translates only these.

#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "model/archive.hpp"

namespace doseki {

/// Numbers in rows: a view of someone's memory, valid during a call, or with an owner for as long
/// as it lives.
struct NumberArray {
    NumberPointer numbers;
    std::vector<std::size_t> shape;
    std::shared_ptr<const void> owner;

    std::size_t size() const {
        return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
    }
    std::size_t rows() const { return shape.empty() ? 1 : shape[0]; }
};

struct Value;

/// A table: values by name, in the order in which they were put in.
class NamedValues {
public:
    NamedValues();
    NamedValues(const NamedValues&);
    NamedValues(NamedValues&&) noexcept;
    NamedValues& operator=(const NamedValues&);
    NamedValues& operator=(NamedValues&&) noexcept;
    ~NamedValues();

    /// The value of that name; a new one where there is none.
    Value& operator[](std::string_view name);
    const Value* find(std::string_view name) const;
    auto begin() const { return items_.begin(); }
    auto end() const { return items_.end(); }

private:
    std::vector<std::pair<std::string, Value>> items_;
};

using List = std::vector<Value>;

struct Value : std::variant<std::monostate, bool, std::int64_t, double, std::string, NumberArray,
                            List, NamedValues> {
    using variant::variant;
};

/// A new array of zeros, to be filled and handed out.
template <class T>
class NewArray {
public:
    explicit NewArray(std::vector<std::size_t> shape)
        : shape_(std::move(shape)),
          data_(std::make_shared<T[]>(std::accumulate(shape_.begin(), shape_.end(), std::size_t{1},
                                                      std::multiplies<>()))) {}

    T* data() { return data_.get(); }
    T& operator[](std::size_t k) { return data_[k]; }
    /// Row k of a two-dimensional array.
    T* row(std::size_t k) { return data_.get() + k * shape_[1]; }

    operator Value() const {
        return NumberArray{static_cast<const T*>(data_.get()), shape_,
                           std::shared_ptr<const void>(data_, data_.get())};
    }

private:
    std::vector<std::size_t> shape_;
    std::shared_ptr<T[]> data_;
};

}  // namespace doseki
