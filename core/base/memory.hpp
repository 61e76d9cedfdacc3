#pragma once
// Where fields and arrays lie: in memory that a device reaches as well, where there is one.

#include <cstddef>
#include <memory>
#include <utility>

#include "base/pack.hpp"

namespace doseki {

#if defined(DOSEKI_CUDA)
/// Memory that the processor and the graphics card both address. Throws std::bad_alloc where there
/// is no card or no room.
void* allocate_for_device(std::size_t bytes);
void free_for_device(void* memory, std::size_t bytes) noexcept;

/// An allocator of it.
template <class T>
struct Memory {
    using value_type = T;

    Memory() = default;
    template <class Other>
    Memory(const Memory<Other>&) {}

    T* allocate(std::size_t count) {
        return static_cast<T*>(allocate_for_device(count * sizeof(T)));
    }
    void deallocate(T* memory, std::size_t count) noexcept {
        free_for_device(memory, count * sizeof(T));
    }
    bool operator==(const Memory&) const = default;
};
#else
template <class T>
using Memory = std::allocator<T>;
#endif

/// What functions on a device refer to derives from this, and lies where it reaches it.
struct InDeviceMemory {
#if defined(DOSEKI_CUDA)
    static void* operator new(std::size_t bytes) { return allocate_for_device(bytes); }
    static void operator delete(void* memory, std::size_t bytes) noexcept {
        free_for_device(memory, bytes);
    }
#endif
};

/// A value that several own and a device can read. Empty until it is given one.
template <class T>
class Shared {
public:
    Shared() = default;

    template <class... Arguments>
    static Shared make(Arguments&&... arguments) {
        Shared shared;
        shared.owner_ = std::allocate_shared<T>(Memory<std::remove_const_t<T>>(),
                                                std::forward<Arguments>(arguments)...);
        shared.value_ = shared.owner_.get();
        return shared;
    }

    DOSEKI_DEVICE_FN T& operator*() const { return *value_; }
    DOSEKI_DEVICE_FN T* operator->() const { return value_; }
    T* get() const { return value_; }
    explicit operator bool() const { return value_ != nullptr; }

private:
    std::shared_ptr<T> owner_;
    T* value_ = nullptr;
};

}  // namespace doseki
