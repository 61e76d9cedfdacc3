#pragma once
#include <vector>

#include "base/vec.hpp"
#include "bodies/contacts.hpp"

namespace doseki {

/// Which materials may be under tension (negative pressure). Fixed particles never are.
enum class Tension { free, clamp_fluid, clamp_all };

/// Smoothing length: as given at the start, or following Eq. (10).
enum class SmoothingLengthMode { constant, eq10 };

/// Law of pressure of the resolved scheme: c^2 (rho - rho0), or Tait's with exponent 7.
enum class PressureLaw { linear, tait };

/// Eddy viscosity: none, Smagorinsky's of the particle spacing, or Prandtl's mixing length over the
/// depth of the flow.
enum class Turbulence { none, smagorinsky, mixing_length };

/// How fluid meets the fixed particles of a body.
struct WallCondition {
    bool stick = true;  // no slip; otherwise free slip, and friction where ks > 0
    double ks = 0.0;    // equivalent sand roughness [m]
};

/// What only the resolved scheme has.
struct FlowOptions {
    double dp = 0.0;
    bool wide_kernel = false;  // Wendland C6 instead of C2
    bool monaghan_cleary = false;
    bool shifting = true;
    PressureLaw pressure_law = PressureLaw::linear;
    Turbulence turbulence = Turbulence::none;
    double smagorinsky = 0.12;
    std::vector<WallCondition> walls;  // by body
};

/// Parameters of the scheme.
template <int D>
struct Options {
    Vec<double, D> gravity{};
    double attraction = 0.0;  // towards the origin, -B^2 x [1/s]; resolved scheme
    double eta = 1.2;
    double alpha = 1.0;
    double cflnumber = 0.1;
    double cfl_force = 0.1;
    double skin = 0.05;           // of the smallest support radius
    bool auto_skin = false;       // from the first lists on, see CheapestSkin
    bool fixed_limits_dt = true;  // the sound speed of fixed particles counts in Eq. (18)
    bool balsara = true;
    bool sym_grad = false;
    Tension tension = Tension::clamp_fluid;
    SmoothingLengthMode h_mode = SmoothingLengthMode::constant;
    FlowOptions flow;
    ContactOptions contact;
};

}  // namespace doseki
