#pragma once
// How quantities of all particles are stored. Who uses a field reads and writes its elements and
// knows no more; what is done with all fields, whatever they hold, is done with their bytes.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace doseki {

/// The elements of a field, of any type, as bytes.
class FieldMemory {
public:
    explicit FieldMemory(std::size_t element_size) : element_size_(element_size) {}

    std::size_t size() const { return bytes_.size() / element_size_; }
    std::size_t element_size() const { return element_size_; }
    std::byte* element(std::size_t p) { return bytes_.data() + p * element_size_; }
    /// That the field occupies, room to grow included.
    std::size_t bytes_held() const { return bytes_.capacity(); }

    /// New elements are zero.
    void resize(std::size_t n) { bytes_.resize(n * element_size_); }
    /// New element k is old element order[k].
    void reorder(std::span<const std::uint32_t> order);

protected:
    std::vector<std::byte> bytes_;

private:
    std::size_t element_size_;
};

/// One quantity of all particles, in the order of storage.
template <class T>
class Field : public FieldMemory {
    static_assert(std::is_trivially_copyable_v<T>);
    static_assert(alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);

public:
    using value_type = T;

    Field() : FieldMemory(sizeof(T)) {}

    std::size_t size() const { return bytes_.size() / sizeof(T); }
    bool empty() const { return bytes_.empty(); }
    T* data() { return reinterpret_cast<T*>(bytes_.data()); }
    const T* data() const { return reinterpret_cast<const T*>(bytes_.data()); }
    T& operator[](std::size_t p) { return data()[p]; }
    const T& operator[](std::size_t p) const { return data()[p]; }
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

/// A field of a list of them.
struct NamedField {
    const char* name;
    FieldMemory* memory;
};

}  // namespace doseki
