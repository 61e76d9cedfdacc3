#pragma once
#include "bodies/elastic/deformable_body.hpp"
#include "physics/fracture.hpp"
#include "physics/hyperelastic.hpp"
#include "physics/hyperelastic/strain.hpp"

namespace doseki {

/// The laws of one body, which only what evaluates them knows.
struct ElasticLaw {
    Hyperelastic<double> law;
    Fracture<double> fracture{};

    DOSEKI_DEVICE_FN Lame<double> lame() const {
        return with_value(law, [](const auto& known) { return known.lame; });
    }
};

DOSEKI_DEVICE_FN inline double DeformableBody::shear_modulus() const { return law->lame().mu; }
DOSEKI_DEVICE_FN inline double DeformableBody::wave_speed() const {
    return p_wave_speed(law->lame(), rho0);
}
template <int D>
DOSEKI_DEVICE_FN Mat<double, D> DeformableBody::stress(const Mat<double, D>& F) const {
    return with_value(law->law, [&](const auto& known) { return known.stress(F); });
}

}  // namespace doseki
