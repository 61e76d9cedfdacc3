#include "bodies/deformable/deformable_body.hpp"

#include "base/error.hpp"
#include "bodies/deformable/elastic_law.hpp"

namespace doseki {
namespace {

Lame<double> lame(const DeformableBody& body) {
    return with_value(body.law->law, [](const auto& known) { return known.lame; });
}

}  // namespace

double DeformableBody::shear_modulus() const { return lame(*this).mu; }
double DeformableBody::wave_speed() const { return p_wave_speed(lame(*this), rho0); }

template <int D>
Mat<double, D> DeformableBody::stress(const Mat<double, D>& F) const {
    return with_value(law->law, [&](const auto& known) { return known.stress(F); });
}

template <int D>
double DeformableBody::energy(const Mat<double, D>& F) const {
    return with_value(law->law, [&](const auto& known) { return known.energy(F); });
}

double DeformableBody::stress_across(const Mat<double, 2>& F) const {
    return with_value(law->law, [&](const auto& known) { return known.stress_across(F); });
}

template <int D>
double DeformableBody::stiffening(const Mat<double, D>& F) const {
    return with_value(law->law, [&](const auto& known) { return known.stiffening(F); });
}

std::array<double, DeformableBody::count> DeformableBody::numbers() const {
    const auto [lambda, mu] = lame(*this);
    const auto index = static_cast<double>(law->law.index());
    return {rho0, lambda, mu, index, spacing, hourglass, damping};
}

DeformableBody DeformableBody::of(const double* n) {
    expect_fit(n[3] >= 0.0 && n[3] < static_cast<double>(std::variant_size_v<Hyperelastic<double>>),
               "elastic_numbers");
    expect_fit(n[0] > 0.0 && n[4] > 0.0, "elastic_numbers");
    auto known = alternative<Hyperelastic<double>>(static_cast<std::size_t>(n[3]));
    with_value(known, [n](auto& law) { law.lame = {n[1], n[2]}; });
    return {n[0], std::make_shared<const ElasticLaw>(known), n[4], n[5], n[6]};
}

template Mat<double, 2> DeformableBody::stress(const Mat<double, 2>&) const;
template Mat<double, 3> DeformableBody::stress(const Mat<double, 3>&) const;
template double DeformableBody::energy(const Mat<double, 2>&) const;
template double DeformableBody::energy(const Mat<double, 3>&) const;
template double DeformableBody::stiffening(const Mat<double, 2>&) const;
template double DeformableBody::stiffening(const Mat<double, 3>&) const;

}  // namespace doseki
