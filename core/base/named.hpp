#pragma once
// Structs that list their members by name, so that what reads or shows them need not: the options
// of a scheme, and the laws of a material, of which a word of the scenario chooses one.

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "base/array.hpp"
#include "base/pack.hpp"

namespace doseki {

/// Takes named numbers and does nothing with them.
struct IgnoreNamed {
    template <class Number>
    void operator()(const char*, Number&) const {}
};

/// A type that a word can choose, and whose numbers can be set by name: `members(f)` calls
/// f(name, number) for each of them.
template <class Law>
concept Named = std::is_trivially_copyable_v<Law> && requires(Law& law) {
    { Law::name } -> std::convertible_to<std::string_view>;
    law.members(IgnoreNamed{});
};

/// Beside a member in `members(f)`: without the key, it keeps its initial value.
struct Optional {};
inline constexpr Optional optional;

/// In place of a member in `members(f)`: a value for each of several words.
template <class E>
struct Choice {
    E& value;
    Array<std::pair<const char*, E>> words;
};
template <class E>
Choice<E> choice(E& value, std::initializer_list<std::pair<const char*, E>> words) {
    return {value, words};
}

/// f(value) of what a variant holds. In place of std::visit: a chain of comparisons, which is
/// inlined and needs no table of functions.
template <std::size_t k = 0, class Variant, class F>
DOSEKI_FN decltype(auto) with_value(Variant& variant, const F& f) {
    if constexpr (k + 1 == std::variant_size_v<std::remove_const_t<Variant>>) {
        return f(*std::get_if<k>(&variant));
    } else {
        if (auto* const value = std::get_if<k>(&variant)) return f(*value);
        return with_value<k + 1>(variant, f);
    }
}

template <class Variant>
std::string_view name_of(const Variant& variant) {
    return with_value(variant, [](const auto& value) -> std::string_view { return value.name; });
}

/// Alternative number k, its members zero. Throws std::out_of_range where there is none.
template <class Variant>
Variant alternative(std::size_t k) {
    constexpr std::size_t size = std::variant_size_v<Variant>;
    if (k >= size) throw std::out_of_range("alternative " + std::to_string(k) + " of a variant");
    return [k]<std::size_t... n>(std::index_sequence<n...>) {
        Variant chosen;
        ((n == k ? (void)chosen.template emplace<n>() : void()), ...);
        return chosen;
    }(std::make_index_sequence<size>());
}

/// The alternative called `name`, its members zero. Throws std::invalid_argument, which names those
/// there are.
template <class Variant>
Variant alternative(std::string_view name) {
    std::string known;
    for (std::size_t k = 0; k < std::variant_size_v<Variant>; ++k) {
        const auto candidate = alternative<Variant>(k);
        if (name_of(candidate) == name) return candidate;
        known += (k > 0 ? ", " : "") + std::string(name_of(candidate));
    }
    throw std::invalid_argument("no law is called \"" + std::string(name) + "\"; known: " + known);
}

}  // namespace doseki
