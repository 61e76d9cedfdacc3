#pragma once
// Reads structs from tables. A struct lists its members once, in `members(f)`, which calls
// f(name, member) or, where the member may keep its initial value, f(name, member, optional).
// A reader is such an f. What is wrong is said with the place, the key and what is allowed.

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/array.hpp"
#include "base/named.hpp"
#include "base/vec.hpp"
#include "interface/value.hpp"

namespace doseki {

class Reader {
public:
    /// `place` names the table in messages.
    Reader(const NamedValues& table, std::string place) : table_(table), place_(std::move(place)) {}

    template <class T>
    void operator()(const char* key, T&& member) {
        if (const Value* value = found(key))
            read(*value, place_ + "." + key, member);
        else
            throw std::invalid_argument(place_ + ": \"" + key + "\" is missing");
    }

    template <class T>
    void operator()(const char* key, T&& member, Optional) {
        if (const Value* value = found(key)) read(*value, place_ + "." + key, member);
    }

    /// A word that chooses one of the laws of a variant, and the parameters of that law, which
    /// stand beside it. Those of other laws are known, but not read.
    template <class Variant>
    void law(const char* key, Variant& chosen) {
        std::string name;
        (*this)(key, name);
        chosen = alternative<Variant>(name);
        for (std::size_t k = 0; k < std::variant_size_v<Variant>; ++k) {
            auto other = alternative<Variant>(k);
            with_value(other, [this](auto& law) {
                law.members([this](const char* member, auto&) { known_.push_back(member); });
            });
        }
        with_value(chosen, [this](auto& law) { law.members(*this); });
    }

    /// A key that someone else reads.
    void allow(const char* key) { known_.push_back(key); }

    /// Throws std::invalid_argument where the table has a key that nobody has asked for.
    void finish() const {
        for (const auto& [key, value] : table_) {
            if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
            std::string all;
            for (const std::string& name : known_) all += (all.empty() ? "" : ", ") + name;
            throw std::invalid_argument(place_ + ": unknown key \"" + key + "\"; known: " + all);
        }
    }

private:
    const Value* found(const char* key) {
        known_.push_back(key);
        return table_.find(key);
    }

    template <class T>
    static const T& as(const Value& value, const std::string& place, const char* what) {
        if (const T* content = std::get_if<T>(&value)) return *content;
        throw std::invalid_argument(place + ": expected " + what);
    }

    static void read(const Value& value, const std::string& place, double& member) {
        if (const auto* whole = std::get_if<std::int64_t>(&value))
            member = static_cast<double>(*whole);
        else
            member = as<double>(value, place, "a number");
    }
    static void read(const Value& value, const std::string& place, bool& member) {
        member = as<bool>(value, place, "true or false");
    }
    static void read(const Value& value, const std::string& place, std::string& member) {
        member = as<std::string>(value, place, "a word");
    }
    static void read(const Value& value, const std::string& place, NumberArray& member) {
        member = as<NumberArray>(value, place, "an array");
    }
    template <std::integral Whole>
    static void read(const Value& value, const std::string& place, Whole& member) {
        const auto whole = as<std::int64_t>(value, place, "a whole number");
        if (!std::in_range<Whole>(whole))
            throw std::invalid_argument(place + ": " + std::to_string(whole) + " is too large");
        member = static_cast<Whole>(whole);
    }
    template <class E>
    static void read(const Value& value, const std::string& place, const Choice<E>& member) {
        const auto& word = as<std::string>(value, place, "a word");
        std::string allowed;
        for (const auto& [name, meaning] : member.words) {
            if (word == name) {
                member.value = meaning;
                return;
            }
            allowed += (allowed.empty() ? "" : ", ") + std::string(name);
        }
        throw std::invalid_argument(place + ": \"" + word + "\" is not one of " + allowed);
    }
    template <class T, int D>
    static void read(const Value& value, const std::string& place, Vec<T, D>& member) {
        read(value, place, member.component);
    }
    template <class T, std::size_t n>
    static void read(const Value& value, const std::string& place, std::array<T, n>& member) {
        Array<T> values;
        read_list(value, place, values);
        if (values.size() != n)
            throw std::invalid_argument(place + ": expected " + std::to_string(n) + " values");
        std::copy(values.begin(), values.end(), member.begin());
    }
    template <class T>
    static void read(const Value& value, const std::string& place, Array<T>& member) {
        read_list(value, place, member);
    }
    template <class T>
    static void read_list(const Value& value, const std::string& place, Array<T>& members) {
        members.clear();
        const List& list = as<List>(value, place, "a list");
        for (std::size_t k = 0; k < list.size(); ++k) {
            T member{};
            read(list[k], place + "[" + std::to_string(k) + "]", member);
            members.push_back(std::move(member));
        }
    }
    template <class T>
        requires requires(T& member, Reader& reader) { member.members(reader); }
    static void read(const Value& value, const std::string& place, T& member) {
        Reader reader(as<NamedValues>(value, place, "a table"), place);
        member.members(reader);
        reader.finish();
    }

    const NamedValues& table_;
    std::string place_;
    Array<std::string> known_;
};

/// Vectors of D numbers, one for each row.
template <int D>
Array<Vec<double, D>> vectors_of(std::span<const double> numbers) {
    Array<Vec<double, D>> rows(numbers.size() / D);
    for (std::size_t k = 0; k < rows.size(); ++k)
        std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(k * D), D,
                    rows[k].component.begin());
    return rows;
}

/// Columns of numbers in a table of arrays, all of as many rows, or each of its own.
class ColumnReader {
public:
    enum Rows { equal_rows, any_rows };

    ColumnReader(const NamedValues& table, std::string place, Rows rows = equal_rows)
        : table_(table), place_(std::move(place)), checks_rows_(rows == equal_rows) {}

    /// The numbers of one column, `width` of them in each row.
    template <class T>
    Array<T> numbers(const char* key, std::size_t width = 1) {
        known_.push_back(key);
        const Value* value = table_.find(key);
        if (!value) throw std::invalid_argument(place_ + ": \"" + key + "\" is missing");
        const auto* array = std::get_if<NumberArray>(value);
        if (!array) throw std::invalid_argument(place_ + "." + key + ": expected an array");
        if (array->size() != array->rows() * width)
            throw std::invalid_argument(place_ + "." + key + ": rows of the wrong length");
        if (checks_rows_ && rows_ != unknown && rows_ != array->rows())
            throw std::invalid_argument(place_ + ": arrays of unequal length");
        rows_ = array->rows();
        Array<T> numbers;
        if (!copy(*array, numbers))
            throw std::invalid_argument(place_ + "." + key + ": numbers of another type");
        return numbers;
    }

    template <int D>
    Array<Vec<double, D>> vectors(const char* key) {
        return vectors_of<D>(numbers<double>(key, D));
    }

    std::size_t rows() const { return rows_; }

    void finish() const {
        for (const auto& [key, value] : table_)
            if (std::find(known_.begin(), known_.end(), key) == known_.end())
                throw std::invalid_argument(place_ + ": unknown key \"" + key + "\"");
    }

private:
    /// Whole numbers may become real ones; real ones do not become whole.
    template <class T>
    static bool copy(const NumberArray& array, Array<T>& numbers) {
        return std::visit(
            [&]<class N>(const N* first) {
                if constexpr (std::is_integral_v<T> && !std::is_integral_v<N>) {
                    return false;
                } else {
                    for (std::size_t k = 0; k < array.size(); ++k)
                        numbers.push_back(static_cast<T>(first[k]));
                    return true;
                }
            },
            array.numbers);
    }

    static constexpr std::size_t unknown = std::numeric_limits<std::size_t>::max();
    const NamedValues& table_;
    std::string place_;
    Array<std::string> known_;
    bool checks_rows_;
    std::size_t rows_ = unknown;
};

}  // namespace doseki
