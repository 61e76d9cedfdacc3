#pragma once
// A Pack is W lanes that act as one number. Physics is written once on a type T: T = double is the
// scalar oracle (and one CUDA thread), T = Pack<double> is W particles at a time.

#include <algorithm>
#include <cmath>
#include <limits>

#if defined(__CUDACC__)
// A device has no packs: T is double or float, one thread for each particle.
#define DOSEKI_FN __host__ __device__ inline
#define DOSEKI_DEVICE_FN __host__ __device__
#else
#include <experimental/simd>
// Compilers think a pair term of sixty operations too large to inline; a call per pair costs half
// the speed.
#define DOSEKI_FN [[gnu::always_inline]] inline
// What a device calls as well, and compilers inline where they like.
#define DOSEKI_DEVICE_FN
#endif

namespace doseki {

#if !defined(__CUDACC__)
namespace stdx = std::experimental;

#if defined(DOSEKI_SCALAR)
template <class real>
using Pack = stdx::simd<real, stdx::simd_abi::scalar>;
#else
template <class real>
using Pack = stdx::native_simd<real>;
#endif

template <class real>
inline constexpr int lanes = static_cast<int>(Pack<real>::size());
#else
template <class real>
using Pack = real;

template <class real>
inline constexpr int lanes = 1;
#endif

using std::abs;
using std::max;
using std::min;
using std::sqrt;

/// A literal in the precision of T (a Pack takes no implicit narrowing).
template <class T>
DOSEKI_FN T number(double literal) {
    if constexpr (requires { typename T::value_type; })
        return T(static_cast<typename T::value_type>(literal));
    else
        return static_cast<T>(literal);
}

/// The least positive number of T's precision: keeps a division harmless, changes no sum.
template <class T>
DOSEKI_FN T least_number() {
    if constexpr (requires { typename T::value_type; })
        return T(std::numeric_limits<typename T::value_type>::min());
    else
        return std::numeric_limits<T>::min();
}

/// `mask ? yes : no`, lane by lane; the scalar overload makes one source serve both.
DOSEKI_FN double select(bool mask, double yes, double no) { return mask ? yes : no; }
DOSEKI_FN float select(bool mask, float yes, float no) { return mask ? yes : no; }

/// Whether a condition holds in any lane.
DOSEKI_FN bool any(bool mask) { return mask; }

#if !defined(__CUDACC__)
template <class real, class Abi>
DOSEKI_FN bool any(const stdx::simd_mask<real, Abi>& mask) {
    return stdx::any_of(mask);
}

template <class real, class Abi>
DOSEKI_FN stdx::simd<real, Abi> select(const stdx::simd_mask<real, Abi>& mask,
                                       const stdx::simd<real, Abi>& yes, stdx::simd<real, Abi> no) {
    stdx::where(mask, no) = yes;
    return no;
}
#endif

}  // namespace doseki
