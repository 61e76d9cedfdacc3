#pragma once
#include <array>
#include <cstdint>

#include "base/matrix.hpp"
#include "base/memory.hpp"

namespace doseki {

struct ElasticLaw;  // elastic/elastic_law.hpp, with what follows from it

/// A deformable body: its material, and how its points resolve it.
struct DeformableBody {
    double rho0;  // [kg/m^3]
    Shared<const ElasticLaw> law;
    double spacing;          // of its points at rest [m]
    double hourglass;        // stiffness and damping of the springs over those of the body in shear
    double damping;          // viscosity of Kelvin-Voigt's damper over rho0 c_P spacing, Eq. (82)
    std::uint64_t seed = 0;  // of the random numbers of its flaws

    /// Of cracks over that of P waves (Lawn and Wilshaw, Fracture of Brittle Solids, 1975).
    static constexpr double crack_speed = 0.4;

    DOSEKI_DEVICE_FN double shear_modulus() const;  // at small strains [Pa]
    double young_modulus() const;                   // at small strains [Pa]
    bool breaks() const;                            // whether cracks can begin
    /// First Piola-Kirchhoff stress without damping.
    template <int D>
    DOSEKI_DEVICE_FN Mat<double, D> stress(const Mat<double, D>& F) const;
    /// Per volume at rest.
    template <int D>
    double energy(const Mat<double, D>& F) const;
    /// Cauchy stress along z of a plane state of strain.
    double stress_across(const Mat<double, 2>& F) const;
    /// How many times faster waves are in a state of strain, at most.
    template <int D>
    double stiffening(const Mat<double, D>& F) const;
    /// Radius of the kernel. Points at rest are evenly spread, so that the nearest suffice; the
    /// farther it reaches, the softer are surfaces, whose gradients are one-sided.
    DOSEKI_DEVICE_FN double support() const { return 1.6 * spacing; }
    DOSEKI_DEVICE_FN double wave_speed() const;  // of P waves at rest [m/s]
    DOSEKI_DEVICE_FN double viscosity() const { return damping * rho0 * wave_speed() * spacing; }

    /// As an archive keeps it.
    static constexpr std::size_t count = 11;
    std::array<double, count> numbers() const;
    static DeformableBody of(const double* numbers);
};

}  // namespace doseki
