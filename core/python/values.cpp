#include "python/values.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

namespace doseki {
namespace {

using AnyArray = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;

template <class... Numbers>
bool view_as(const AnyArray& array, std::variant<const Numbers*...>& numbers) {
    return ((array.dtype() == nb::dtype<Numbers>() &&
             (numbers = static_cast<const Numbers*>(array.data()), true)) ||
            ...);
}

Value scalar(const NumberArray& array) {
    return std::visit(
        []<class T>(const T* number) -> Value {
            if constexpr (std::is_same_v<T, bool>)
                return *number;
            else if constexpr (std::is_integral_v<T>)
                return static_cast<std::int64_t>(*number);
            else
                return static_cast<double>(*number);
        },
        array.numbers);
}

Value to_array(nb::handle object) {
    const auto held = std::make_shared<AnyArray>(nb::cast<AnyArray>(object));
    NumberArray array;
    if (!view_as(*held, array.numbers)) throw nb::type_error("array of an unknown type of number");
    for (std::size_t a = 0; a < held->ndim(); ++a) array.shape.push_back(held->shape(a));
    if (array.shape.empty()) return scalar(array);
    array.owner = held;
    return array;
}

Value to_list(nb::handle object) {
    List list;
    for (const nb::handle item : object) list.push_back(to_value(item));
    return list;
}

nb::object array_to_python(const NumberArray& array) {
    auto* const owner = new std::shared_ptr<const void>(array.owner);
    const nb::capsule capsule(
        owner, [](void* p) noexcept { delete static_cast<std::shared_ptr<const void>*>(p); });
    return std::visit(
        [&]<class T>(const T* first) -> nb::object {
            return nb::cast(nb::ndarray<nb::numpy, T>(const_cast<T*>(first), array.shape.size(),
                                                      array.shape.data(), capsule));
        },
        array.numbers);
}

}  // namespace

Value to_value(nb::handle object) {
    if (object.is_none()) return {};
    if (nb::isinstance<nb::bool_>(object)) return nb::cast<bool>(object);
    if (nb::isinstance<nb::int_>(object)) return nb::cast<std::int64_t>(object);
    if (nb::isinstance<nb::float_>(object)) return nb::cast<double>(object);
    if (nb::isinstance<nb::str>(object)) return nb::cast<std::string>(object);
    if (nb::isinstance<nb::dict>(object)) return to_table(object);
    if (nb::isinstance<nb::list>(object) || nb::isinstance<nb::tuple>(object))
        return to_list(object);
    if (nb::ndarray_check(object)) return to_array(object);
    throw nb::type_error("expected a number, a word, an array, a list or a dictionary");
}

NamedValues to_table(nb::handle dict) {
    NamedValues table;
    for (const auto& [key, value] : nb::cast<nb::dict>(dict))
        table[nb::cast<std::string>(key)] = to_value(value);
    return table;
}

std::vector<NamedValues> to_tables(nb::handle list) {
    std::vector<NamedValues> tables;
    for (const nb::handle item : list) tables.push_back(to_table(item));
    return tables;
}

nb::object to_python(const Value& value) {
    return std::visit(
        []<class T>(const T& content) -> nb::object {
            if constexpr (std::is_same_v<T, std::monostate>) {
                return nb::none();
            } else if constexpr (std::is_same_v<T, NumberArray>) {
                return array_to_python(content);
            } else if constexpr (std::is_same_v<T, NamedValues>) {
                return to_python(content);
            } else if constexpr (std::is_same_v<T, List>) {
                nb::list list;
                for (const Value& item : content) list.append(to_python(item));
                return list;
            } else {
                return nb::cast(content);
            }
        },
        value);
}

nb::dict to_python(const NamedValues& table) {
    nb::dict dict;
    for (const auto& [name, value] : table) dict[name.c_str()] = to_python(value);
    return dict;
}

}  // namespace doseki
