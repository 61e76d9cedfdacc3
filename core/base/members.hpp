#pragma once
// Packed structs: templates over a number type T, real in memory and Pack<real> in the pair loop.
// Each names its members once,
//
//   template <class F, class... Self>
//   DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
//       f(self.v...), f(self.mass...);
//   }
//
// where `self` are one or several objects of the same struct over any number types: f is called
// with the same member of each. Loading, broadcasting, taking a lane and archiving follow from it.

#include <cstddef>

#include "base/pack.hpp"

namespace doseki {

struct IgnoreMembers {
    template <class... Member>
    DOSEKI_FN constexpr void operator()(Member&...) const {}
};

template <class S>
concept HasMembers = requires(S& s) { S::members(IgnoreMembers{}, s); };

template <class F, class First, class... Rest>
DOSEKI_FN constexpr void for_each_number(F& f, First& first, Rest&... rest);

/// Calls f for the numbers within a member.
template <class F>
struct WithinMember {
    F& f;
    template <class... Member>
    DOSEKI_FN constexpr void operator()(Member&... member) const {
        for_each_number(f, member...);
    }
};

/// Calls f with each number of a packed struct, and with the same number of the others.
template <class F, class First, class... Rest>
DOSEKI_FN constexpr void for_each_number(F& f, First& first, Rest&... rest) {
    if constexpr (HasMembers<First>)
        First::members(WithinMember<F>{f}, first, rest...);
    else
        f(first, rest...);
}

struct AssignNumber {
    template <class T, class Number>
    DOSEKI_FN void operator()(T& to, const Number& from) const {
        to = static_cast<T>(from);
    }
};

/// A packed struct in other numbers.
template <class To, class From>
DOSEKI_FN To converted(const From& from) {
    To to;
    const AssignNumber assign;
    for_each_number(assign, to, from);
    return to;
}

/// A member that takes the largest of what it is given; all others are sums.
template <class T>
struct Largest {
    T value{};

    template <class F, class... Self>
    DOSEKI_FN static constexpr void members(F&& f, Self&... self) {
        f(self.value...);
    }
    DOSEKI_FN void take(const T& other) { value = max(value, other); }
};

struct AddMembers {
    template <class Member>
    DOSEKI_FN void operator()(Member& to, const Member& from) const {
        if constexpr (HasMembers<Member>)
            Member::members(*this, to, from);
        else
            to += from;
    }
    template <class T>
    DOSEKI_FN void operator()(Largest<T>& to, const Largest<T>& from) const {
        to.take(from.value);
    }
};

/// Adds what another object of a packed struct has summed.
template <class S>
DOSEKI_FN void add_members(S& to, const S& from) {
    AddMembers{}(to, from);
}

struct CountNumbers {
    std::size_t count = 0;
    template <class Number>
    constexpr void operator()(Number&) {
        ++count;
    }
};

/// How many numbers a packed struct consists of.
template <class S>
constexpr std::size_t number_count() {
    S s{};
    CountNumbers counter;
    for_each_number(counter, s);
    return counter.count;
}

}  // namespace doseki
