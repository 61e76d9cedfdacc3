// The laws of materials: of viscosity, state, elasticity, yielding and contact. Those of which a
// scenario chooses one are bound under their names, with their parameters in the order in which
// they list them.

#include "bodies/shapes/shape.hpp"
#include "model/material_laws.hpp"
#include "physics/contact.hpp"
#include "physics/equation_of_state.hpp"
#include "physics/fracture/impact.hpp"
#include "physics/hourglass.hpp"
#include "physics/hyperelastic.hpp"
#include "physics/rheology.hpp"
#include "physics/yield.hpp"
#include "python/point_functions.hpp"

using namespace doseki;

namespace {

/// Alternative number k of a family of laws over the number type of `in`, its members those that
/// stand in `in` from `first` on.
template <template <class> class Family, std::size_t k, class Row>
auto law_of(const Row& in, std::size_t first) {
    std::variant_alternative_t<k, Family<NumberOf<Row>>> law;
    law.members([&](const char*, auto& member) { member = in[first++]; });
    return law;
}

/// Calls f(name, k) with the constant k for every law of a family.
template <template <class> class Family, class F>
void for_each_law(F&& f) {
    [&f]<std::size_t... k>(std::index_sequence<k...>) {
        (f(std::variant_alternative_t<k, Family<double>>::name,
           std::integral_constant<std::size_t, k>{}),
         ...);
    }(std::make_index_sequence<std::variant_size_v<Family<double>>>());
}

/// Names of the laws of a family, and of the parameters of each.
template <template <class> class Family>
nb::dict names_of() {
    nb::dict names;
    for_each_law<Family>([&names](const char* name, auto k) {
        nb::list members;
        std::variant_alternative_t<k, Family<double>> law;
        law.members([&members](const char* member, auto&) { members.append(member); });
        names[name] = members;
    });
    return names;
}

void bind_fluids(nb::module_& m) {
    for_each_law<Rheology>([&m](const char* name, auto k) {
        define(m, name, 1, [k](const auto& in, auto& out) {  // rate, p, rho, parameters -> mu
            out[0] = law_of<Rheology, k>(in, 3).viscosity({in[0], in[1], in[2]});
        });
    });
    for_each_law<EquationOfState>([&m](const char* name, auto k) {
        define(m, name, 3, [k](const auto& in, auto& out) {  // rho, parameters -> p, c, u
            const auto state = law_of<EquationOfState, k>(in, 1).at(in[0]);
            out[0] = state.pressure, out[1] = state.sound_speed, out[2] = state.bulk_energy;
        });
    });
}

/// Of elastic solids. F, dF/dt and stresses are matrices, row by row.
template <int D>
void bind_elastic_points(nb::module_& m) {
    constexpr std::size_t full = D * D;
    define(m, "green_strain", Sym<double, D>::size, [](const auto& in, auto& out) {  // F
        put(green_strain(matrix<D>(in, 0)), out);
    });
    for_each_law<Hyperelastic>([&m](const char* name, auto k) {
        define(m, name, full + 1, [k](const auto& in, auto& out) {  // F, parameters -> P, energy
            const auto law = law_of<Hyperelastic, k>(in, full);
            put(law.stress(matrix<D>(in, 0)), out);
            out[full] = law.energy(matrix<D>(in, 0));
        });
    });
    define(m, "kelvin_voigt", full, [](const auto& in, auto& out) {  // F, dF/dt, eta
        put(kelvin_voigt(matrix<D>(in, 0), matrix<D>(in, full), in[2 * full]), out);
    });
    define(m, "cauchy_stress", Sym<double, D>::size, [](const auto& in, auto& out) {  // P, F
        put(cauchy_stress(matrix<D>(in, 0), matrix<D>(in, full)), out);
    });
    define(m, "elastic_pair_force", D,
           [](const auto& in, auto& out) {  // P_i, P_j, F_i, F_j, kappa, R_ij, r_ij
               const auto kappa = in[4 * full];
               const auto Q_i = less_springs(matrix<D>(in, 0), kappa, matrix<D>(in, 2 * full));
               const auto Q_j = less_springs(matrix<D>(in, full), kappa, matrix<D>(in, 3 * full));
               put(elastic_pair_force(Q_i, Q_j, kappa + kappa, vector<D>(in, 4 * full + 1),
                                      vector<D>(in, 4 * full + 1 + D)),
                   out);
           });
}

/// Where solids yield.
template <int D>
void bind_yield(nb::module_& m) {
    define(m, "return_map", Deviator<double, D>::size,
           [](const auto& in, auto& out) {  // S, p, alpha, k
               constexpr std::size_t size = Deviator<double, D>::size;
               const YieldSurface<NumberOf<decltype(in)>> surface{in[size + 1], in[size + 2]};
               put(return_map(deviator<D>(in, 0), in[size], surface), out);
           });
    define_numbers(m, "drucker_prager", 2,
                   [](const auto& in, auto& out) {  // cohesion, angle -> alpha, k
                       const auto surface = drucker_prager<D>(in[0], in[1]);
                       out[0] = surface.alpha, out[1] = surface.k;
                   });
}

/// Laws of contact, which no pair loop calls.
void bind_contact(nb::module_& m) {
    define_numbers(m, "damping_ratio", 1, [](const auto& in, auto& out) {  // restitution, hertz
        out[0] = damping_ratio(in[0], in[1] > 0.0);
    });
    define_numbers(m, "hertz_spring", 2,
                   [](const auto& in, auto& out) {  // E*, R*, overlap -> F, dF/doverlap
                       const auto spring = hertz_spring(in[0], in[1], in[2]);
                       out[0] = spring.force, out[1] = spring.stiffness;
                   });
    define_numbers(m, "expected_tension", 2,  // speed, impedances, force, diameter -> 2-D, 3-D
                   [](const auto& in, auto& out) {
                       const Touch touch{in[0], in[1], in[2], in[3], in[4]};
                       out[0] = expected_tension<2>(touch), out[1] = expected_tension<3>(touch);
                   });
    define_numbers(m, "hertz_collision", 2,
                   [](const auto& in, auto& out) {  // E*, R*, m*, v -> overlap, time
                       const auto meeting = hertz_collision(in[0], in[1], in[2], in[3]);
                       out[0] = meeting.overlap, out[1] = meeting.time;
                   });
    define_numbers(m, "linear_collision", 2,
                   [](const auto& in, auto& out) {  // k, m*, v -> overlap, time
                       const auto meeting = linear_collision(in[0], in[1], in[2]);
                       out[0] = meeting.overlap, out[1] = meeting.time;
                   });
    define_numbers(m, "contact_force", 1,
                   [](const auto& in, auto& out) {  // hertz, zeta, E*, R*, m*, overlap, v
                       const bool hertz = in[0] > 0.0;
                       const NormalSpring spring =
                           hertz ? hertz_spring(in[2], in[3], in[5]) : linear_spring(in[2], in[5]);
                       out[0] = normal_force(
                           spring, contact_damping(hertz, in[1], spring.stiffness, in[4]), in[6]);
                   });
    define_numbers(m, "sliding_spring", 6,
                   [](const auto& in, auto& out) {  // stretch, speed, dt, k, c, limit
                       auto stretch = vector<3>(in, 0);
                       const auto force =
                           sliding_spring(stretch, vector<3>(in, 3), in[6], in[7], in[8], in[9]);
                       for (int a = 0; a < 3; ++a)
                           out[static_cast<std::size_t>(a)] = force[a],
                           out[static_cast<std::size_t>(3 + a)] = stretch[a];
                   });
}

/// Facets whose corners come one after another.
template <int D>
Array<Facet<D>> facets_of(const Table& corners) {
    Array<Facet<D>> facets;
    for (std::size_t k = 0; k + D <= corners.size(); k += D) {
        facets.emplace_back();
        for (std::size_t a = 0; a < D; ++a) facets.back()[a] = vector<D>(corners[k + a], 0);
    }
    return facets;
}

template <int D>
void append(Column& row, const SurfacePoint<D>& place) {
    row.push_back(place.distance);
    row.insert(row.end(), place.normal.component.begin(), place.normal.component.end());
}

/// Distance and normal of points (n, D) from the surface of the convex shape or the mesh with the
/// facets (m, D, D); of all places of a mesh that balls of a radius about these points touch.
template <int D>
void bind_shape(nb::module_& m) {
    m.def(
        "surface_from",
        [](const Table& corners, const Table& points) {
            const ConvexSurface<D> shape(facets_of<D>(corners));
            Table result(points.size());
            for (std::size_t k = 0; k < points.size(); ++k)
                append(result[k], shape.from(vector<D>(points[k], 0)));
            return result;
        },
        nb::arg("corners"), nb::arg("points"));
    m.def(
        "mesh_from",
        [](const Table& corners, double thickness, const Table& points) {
            const MeshSurface<D> mesh(facets_of<D>(corners), thickness);
            Table result(points.size());
            for (std::size_t k = 0; k < points.size(); ++k)
                append(result[k], mesh.from(vector<D>(points[k], 0)));
            return result;
        },
        nb::arg("corners"), nb::arg("thickness"), nb::arg("points"));
    m.def(
        "mesh_touched",
        [](const Table& corners, double thickness, const Table& points, double radius) {
            const MeshSurface<D> mesh(facets_of<D>(corners), thickness);
            Table result(points.size());
            for (std::size_t k = 0; k < points.size(); ++k)
                for (const auto& place : mesh.touched_by(vector<D>(points[k], 0), radius))
                    append(result[k], place);
            return result;
        },
        nb::arg("corners"), nb::arg("thickness"), nb::arg("points"), nb::arg("radius"));
}

}  // namespace

void bind_laws(nb::module_& m, nb::module_& two, nb::module_& three) {
    m.attr("rheologies") = names_of<Rheology>();
    m.attr("equations_of_state") = names_of<EquationOfState>();
    m.attr("least_relative_density") = least_relative_density;
    m.attr("hyperelastic_laws") = names_of<Hyperelastic>();
    bind_fluids(m);
    bind_contact(m);
    bind_elastic_points<2>(two), bind_elastic_points<3>(three);
    bind_yield<2>(two), bind_yield<3>(three);
    bind_shape<2>(two), bind_shape<3>(three);
    define_numbers(m, "von_mises", 2, [](const auto& in, auto& out) {  // Y -> alpha, k
        const auto surface = von_mises(in[0]);
        out[0] = surface.alpha, out[1] = surface.k;
    });
    define(m, "tension_cut", 1, [](const auto& in, auto& out) {  // p, alpha, k
        out[0] = tension_cut(YieldSurface<NumberOf<decltype(in)>>{in[1], in[2]}, in[0]);
    });
}
