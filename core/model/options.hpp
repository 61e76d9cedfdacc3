#pragma once
#include <algorithm>
#include <limits>

#include "base/array.hpp"
#include "base/named.hpp"
#include "base/vec.hpp"
#include "physics/viscosity.hpp"

namespace doseki {

/// Which materials may be under tension (negative pressure). Fixed particles never are.
enum class Tension { free, clamp_fluid, clamp_all };

/// Smoothing length: as given at the start, or following Eq. (10).
enum class SmoothingLengthMode { constant, eq10 };

/// Eddy viscosity: none, Smagorinsky's of the particle spacing, or Prandtl's mixing length over the
/// depth of the flow.
enum class Turbulence { none, smagorinsky, mixing_length };

/// How fluid meets the fixed particles of a body.
struct WallCondition {
    bool no_slip = true;   // fluid sticks to it
    double ks = 0.0;       // equivalent sand roughness [m], where there is friction by it
    bool voellmy = false;  // Coulomb's and turbulent friction
    double mu = 0.0;       // coefficient of friction
    double turbulent_xi = std::numeric_limits<double>::infinity();  // [m/s^2]
    double effective_share = 1.0;  // of the normal stress, that grains carry and not pore water
    bool moves = false;            // and its particles with it; those of a belt stay

    DOSEKI_DEVICE_FN bool has_friction() const { return ks > 0.0 || voellmy; }

    template <class F>
    void members(F&& f) {
        f("no_slip", no_slip), f("ks", ks), f("voellmy", voellmy, optional);
        f("mu", mu, optional), f("turbulent_xi", turbulent_xi, optional);
        f("effective_share", effective_share, optional), f("moves", moves, optional);
    }
};

/// How stiff contacts are, and what they are checked against.
struct ContactOptions {
    bool hertz = false;     // in 3-D; discs touch along a line, whose spring is linear
    bool softened = true;   // as stiff as `overlap` at `speed` asks, if that is softer
    double overlap = 0.01;  // of the smaller diameter
    double speed = 1.0;     // largest speed at which bodies meet [m/s]
    double steps = 12.0;    // of a contact's time

    template <class F>
    void members(F&& f) {
        f("law", choice<bool>(hertz, {{"linear", false}, {"hertz", true}}));
        f("stiffness", choice<bool>(softened, {{"softened", true}, {"material", false}}));
        f("overlap", overlap), f("speed", speed), f("steps", steps);
    }
};

/// What only the resolved scheme has.
struct FlowOptions {
    double dp = 0.0;
    bool wide_kernel = false;  // Wendland C6 instead of C2
    ViscousPairs viscosity = ViscousPairs::stress;
    bool shifting = true;
    double acoustic_damping = 0.05;
    Turbulence turbulence = Turbulence::none;
    double smagorinsky = 0.12;
    Array<WallCondition> walls;  // by body

    bool has_rough_walls() const {
        return std::any_of(walls.begin(), walls.end(),
                           [](const WallCondition& wall) { return wall.ks > 0.0; });
    }
    bool has_voellmy_walls() const {
        return std::any_of(walls.begin(), walls.end(),
                           [](const WallCondition& wall) { return wall.voellmy; });
    }

    template <class F>
    void members(F&& f) {
        f("dp", dp);
        f("kernel", choice<bool>(wide_kernel, {{"wendland_c2", false}, {"wendland_c6", true}}));
        f("viscosity",
          choice<ViscousPairs>(viscosity, {{"stress", ViscousPairs::stress},
                                           {"morris", ViscousPairs::morris},
                                           {"monaghan_cleary", ViscousPairs::monaghan_cleary}}));
        f("shifting", shifting), f("acoustic_damping", acoustic_damping);
        f("turbulence",
          choice<Turbulence>(turbulence, {{"none", Turbulence::none},
                                          {"smagorinsky", Turbulence::smagorinsky},
                                          {"mixing_length", Turbulence::mixing_length}}));
        f("smagorinsky", smagorinsky);
        f("walls", walls);
    }
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
    bool auto_skin = false;       // from the first lists on, see SkinCosts
    bool fixed_limits_dt = true;  // the sound speed of fixed particles counts in Eq. (18)
    bool balsara = true;
    bool sym_grad = false;
    Tension tension = Tension::clamp_fluid;
    SmoothingLengthMode h_mode = SmoothingLengthMode::constant;
    Vec<double, D> origin{};  // where zero is in the coordinates of messages [m]
    FlowOptions flow;
    ContactOptions contact;

    template <class F>
    void members(F&& f) {
        f("origin", origin, optional);
        f("gravity", gravity), f("attraction", attraction, optional);
        f("eta", eta), f("alpha", alpha), f("cflnumber", cflnumber), f("cfl_force", cfl_force);
        f("skin", skin), f("auto_skin", auto_skin, optional);
        f("fixed_limits_dt", fixed_limits_dt, optional);
        f("balsara", balsara), f("sym_grad", sym_grad);
        f("tension", choice<Tension>(tension, {{"free", Tension::free},
                                               {"clamp_fluid", Tension::clamp_fluid},
                                               {"clamp_all", Tension::clamp_all}}));
        f("h_mode",
          choice<SmoothingLengthMode>(h_mode, {{"constant", SmoothingLengthMode::constant},
                                               {"eq10", SmoothingLengthMode::eq10}}));
        f("flow", flow, optional), f("contact", contact, optional);
    }
};

}  // namespace doseki
