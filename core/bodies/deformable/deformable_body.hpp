#pragma once
#include <array>

#include "physics/hyperelastic.hpp"

namespace doseki {

/// A deformable body: its material, and how its points resolve it.
struct DeformableBody {
    double rho0;  // [kg/m^3]
    Hyperelastic<double> law;
    double spacing;    // of its points at rest [m]
    double hourglass;  // stiffness and damping of the springs over those of the body in shear
    double damping;    // viscosity of Kelvin-Voigt's damper over rho0 c_P spacing, Eq. (82)

    Lame<double> lame() const {
        return with_value(law, [](const auto& known) { return known.lame; });
    }
    /// First Piola-Kirchhoff stress without damping.
    template <int D>
    Mat<double, D> stress(const Mat<double, D>& F) const {
        return with_value(law, [&](const auto& known) { return known.stress(F); });
    }
    /// Per volume at rest.
    template <int D>
    double energy(const Mat<double, D>& F) const {
        return with_value(law, [&](const auto& known) { return known.energy(F); });
    }
    /// Cauchy stress along z of a plane state of strain.
    double stress_across(const Mat<double, 2>& F) const {
        return with_value(law, [&](const auto& known) { return known.stress_across(F); });
    }
    /// How many times faster waves are in a state of strain, at most.
    template <int D>
    double stiffening(const Mat<double, D>& F) const {
        return with_value(law, [&](const auto& known) { return known.stiffening(F); });
    }
    /// Radius of the kernel. Points at rest are evenly spread, so that the nearest suffice; the
    /// farther it reaches, the softer are surfaces, whose gradients are one-sided.
    double support() const { return 1.6 * spacing; }
    double wave_speed() const { return p_wave_speed(lame(), rho0); }
    double viscosity() const { return damping * rho0 * wave_speed() * spacing; }

    /// As an archive keeps it.
    static constexpr std::size_t count = 7;
    std::array<double, count> numbers() const {
        const auto [lambda, mu] = lame();
        return {rho0, lambda, mu, static_cast<double>(law.index()), spacing, hourglass, damping};
    }
    static DeformableBody of(const double* n) {
        DeformableBody body{n[0], alternative<Hyperelastic<double>>(static_cast<std::size_t>(n[3])),
                            n[4], n[5], n[6]};
        with_value(body.law, [n](auto& known) { known.lame = {n[1], n[2]}; });
        return body;
    }
};

}  // namespace doseki
