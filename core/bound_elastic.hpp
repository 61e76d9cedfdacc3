#pragma once
#include "bound_arrays.hpp"
#include "elastic/elastic_bodies.hpp"

namespace doseki {

inline ElasticBody elastic_body(const nb::dict& d) {
    ElasticBody body;
    body.rho0 = get<double>(d, "rho0");
    body.lame = Lame<double>::of(get<double>(d, "young_modulus"), get<double>(d, "poisson_ratio"));
    body.law = get<std::string>(d, "law", "") == "neo_hookean" ? ElasticLaw::neo_hookean
                                                               : ElasticLaw::st_venant_kirchhoff;
    body.spacing = get<double>(d, "spacing");
    body.hourglass = get(d, "hourglass", body.hourglass);
    body.damping = get(d, "damping", body.damping);
    return body;
}

}  // namespace doseki
