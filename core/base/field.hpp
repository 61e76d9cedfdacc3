#pragma once
// How quantities of all particles are stored. Who uses a field reads and writes its elements and
// knows no more; what is done with all fields, whatever they hold, is done with their bytes.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "base/memory.hpp"

namespace doseki {

/// Which particles a quantity is of: all, walls alone, or all but walls. Storage has those that are
/// no walls first, so the elements of either lie in a row.
enum class FieldOf { all, walls, others };

/// Places of a row of elements: from `first` up to `last`, which is not one of them.
struct Places {
    std::size_t first, last;
};

/// The elements of a field, of any type, as bytes. Those that are stored lie in a row; the others
/// are zero.
class FieldMemory {
public:
    FieldMemory(std::size_t element_size, FieldOf of) : element_size_(element_size), of_(of) {}

    DOSEKI_DEVICE_FN std::size_t size() const { return size_; }
    std::size_t element_size() const { return element_size_; }
    FieldOf of() const { return of_; }
    /// Null where the element is not stored.
    std::byte* element(std::size_t p) {
        return p - first_ < stored_ ? bytes_.data() + (p - first_) * element_size_ : nullptr;
    }
    /// That the field occupies, room to grow included.
    std::size_t bytes_held() const { return bytes_.capacity(); }

    /// New elements are zero, and stored.
    void resize(std::size_t n);
    /// New element k is old element order[k]. Those of `kept` are stored, as all of them were.
    void reorder(std::span<const std::uint32_t> order, Places kept);

protected:
    std::vector<std::byte, Memory<std::byte>> bytes_;
    std::size_t size_ = 0, first_ = 0, stored_ = 0;

private:
    std::size_t element_size_;
    FieldOf of_;
};

/// One quantity of all particles, in the order of storage.
template <class T>
class Field : public FieldMemory {
    static_assert(std::is_trivially_copyable_v<T>);
    static_assert(alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);

public:
    using value_type = T;

    Field() : FieldMemory(sizeof(T), FieldOf::all) {}

    bool empty() const { return size() == 0; }
    DOSEKI_DEVICE_FN T* data() { return reinterpret_cast<T*>(bytes_.data()); }
    DOSEKI_DEVICE_FN const T* data() const { return reinterpret_cast<const T*>(bytes_.data()); }
    DOSEKI_DEVICE_FN T& operator[](std::size_t p) { return data()[p]; }
    DOSEKI_DEVICE_FN const T& operator[](std::size_t p) const { return data()[p]; }
    T* begin() { return data(); }
    T* end() { return data() + size(); }
    const T* begin() const { return data(); }
    const T* end() const { return data() + size(); }

    void assign(std::size_t n, const T& value) {
        resize(n);
        std::fill(begin(), end(), value);
    }
    void assign(std::span<const T> values) {
        resize(values.size());
        std::copy(values.begin(), values.end(), begin());
    }
};

[[noreturn]] void fail_on_missing_element();

/// The same, on a device as well, which stops there.
DOSEKI_DEVICE_FN inline void expect_element(bool is_there) {
    if (is_there) return;
#if defined(__CUDA_ARCH__)
    __trap();
#else
    fail_on_missing_element();
#endif
}

/// One quantity of some of the particles. Whoever reads it may ask for all: it is zero elsewhere.
template <class T, FieldOf kind>
class PartField : public FieldMemory {
    static_assert(std::is_trivially_copyable_v<T> && kind != FieldOf::all);

public:
    using value_type = T;

    PartField() : FieldMemory(sizeof(T), kind) {}

    /// Throws std::logic_error where the particle is not of those that have it.
    DOSEKI_DEVICE_FN T& operator[](std::size_t p) {
        expect_element(p - first_ < stored_);
        return data()[p - first_];
    }
    DOSEKI_DEVICE_FN const T& operator[](std::size_t p) const {
        return p - first_ < stored_ ? data()[p - first_] : zero_;
    }
    std::span<T> stored() { return {data(), stored_}; }
    std::span<const T> stored() const { return {data(), stored_}; }

    void assign(std::span<const T> values) {
        resize(0), resize(values.size());
        std::copy(values.begin(), values.end(), data());
    }

private:
    DOSEKI_DEVICE_FN T* data() { return reinterpret_cast<T*>(bytes_.data()); }
    DOSEKI_DEVICE_FN const T* data() const { return reinterpret_cast<const T*>(bytes_.data()); }

    T zero_{};
};

template <class T>
using WallField = PartField<T, FieldOf::walls>;
/// Of all particles but walls.
template <class T>
using FluidField = PartField<T, FieldOf::others>;

/// A field of a list of them.
struct NamedField {
    const char* name;
    FieldMemory* memory;
};

}  // namespace doseki
