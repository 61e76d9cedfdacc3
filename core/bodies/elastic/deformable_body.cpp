#include "bodies/elastic/deformable_body.hpp"

#include "base/error.hpp"
#include "bodies/elastic/elastic_law.hpp"

namespace doseki {

double DeformableBody::young_modulus() const {
    const auto [lambda, mu] = law->lame();
    return mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
}
bool DeformableBody::breaks() const { return law->fracture.index() > 0; }

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
    const auto [lambda, mu] = law->lame();
    const auto index = static_cast<double>(law->law.index());
    std::array<double, 2> of_fracture{};
    with_value(law->fracture, [&of_fracture](auto known) {
        std::size_t k = 0;
        known.members([&](const char*, double& number) { of_fracture[k++] = number; });
    });
    const auto breaking = static_cast<double>(law->fracture.index());
    return {rho0,
            lambda,
            mu,
            index,
            spacing,
            hourglass,
            damping,
            breaking,
            of_fracture[0],
            of_fracture[1],
            static_cast<double>(seed)};
}

DeformableBody DeformableBody::of(const double* n) {
    expect_fit(n[3] >= 0.0 && n[3] < static_cast<double>(std::variant_size_v<Hyperelastic<double>>),
               "elastic_numbers");
    expect_fit(n[0] > 0.0 && n[4] > 0.0, "elastic_numbers");
    expect_fit(n[7] >= 0.0 && n[7] < static_cast<double>(std::variant_size_v<Fracture<double>>) &&
                   n[10] >= 0.0 && n[10] < 0x1p53,
               "elastic_numbers");
    auto known = alternative<Hyperelastic<double>>(static_cast<std::size_t>(n[3]));
    with_value(known, [n](auto& law) { law.lame = {n[1], n[2]}; });
    auto breaking = alternative<Fracture<double>>(static_cast<std::size_t>(n[7]));
    with_value(breaking, [n](auto& law) {
        std::size_t k = 8;
        law.members([&](const char*, double& number) {
            number = n[k++];
            expect_fit(number > 0.0, "elastic_numbers");
        });
    });
    const auto laws = Shared<const ElasticLaw>::make(ElasticLaw{known, breaking});
    return {n[0], laws, n[4], n[5], n[6], static_cast<std::uint64_t>(n[10])};
}

template double DeformableBody::energy(const Mat<double, 2>&) const;
template double DeformableBody::energy(const Mat<double, 3>&) const;
template double DeformableBody::stiffening(const Mat<double, 2>&) const;
template double DeformableBody::stiffening(const Mat<double, 3>&) const;

}  // namespace doseki
