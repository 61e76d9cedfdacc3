#pragma once
// The back end that a build of the core is for.

#if defined(DOSEKI_DEVICE)
#include "device/device.hpp"
#else
#include "pairs/cpu.hpp"
#endif

namespace doseki {

#if defined(DOSEKI_DEVICE)
template <class real>
using BackendOfBuild = Device<real>;
#else
template <class real>
using BackendOfBuild = Cpu<real>;
#endif

}  // namespace doseki
