#pragma once
// Lists of values that are no quantity of particles: bodies, materials, contacts.

#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include "base/memory.hpp"

namespace doseki {

/// Values in a row that their owner adds and drops. Where they lie is decided here alone; who only
/// reads or changes elements takes a span.
template <class T>
class Array : private std::vector<T, Memory<T>> {
    using Storage = std::vector<T, Memory<T>>;

public:
    using typename Storage::value_type;

    using Storage::Storage;
    Array() = default;
    Array(Storage values) : Storage(std::move(values)) {}

    using Storage::at;
    using Storage::back;
    using Storage::begin;
    using Storage::capacity;
    using Storage::clear;
    using Storage::data;
    using Storage::emplace_back;
    using Storage::empty;
    using Storage::end;
    using Storage::erase;
    using Storage::front;
    using Storage::insert;
    using Storage::push_back;
    using Storage::reserve;
    using Storage::resize;
    using Storage::size;
    using Storage::operator[];
    using Storage::assign;

    void swap(Array& other) { Storage::swap(other); }
};

}  // namespace doseki
