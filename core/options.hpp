#pragma once
#include "base/vec.hpp"

namespace doseki {

/// Which materials may be under tension (negative pressure). Fixed particles never are.
enum class Tension { free, clamp_fluid, clamp_all };

/// Smoothing length: as given at the start, or following Eq. (10).
enum class SmoothingLengthMode { constant, eq10 };

/// Parameters of the ueta2022 scheme.
template <int D>
struct Options {
    Vec<double, D> gravity{};
    double eta = 1.2;
    double alpha = 1.0;
    double cflnumber = 0.1;
    double cfl_force = 0.1;
    double skin = 0.05;    // of the smallest support radius
    bool auto_skin = false;         // from the first lists on, see CheapestSkin
    bool fixed_limits_dt = true;    // the sound speed of fixed particles counts in Eq. (18)
    bool balsara = true;
    bool sym_grad = false;
    Tension tension = Tension::clamp_fluid;
    SmoothingLengthMode h_mode = SmoothingLengthMode::constant;
};

}  // namespace doseki
