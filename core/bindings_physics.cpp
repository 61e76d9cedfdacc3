// The point functions of core/physics on arrays, evaluated either one number at a time or pack by
// pack: tests compare both with calculus and closed forms.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "bodies/shape.hpp"
#include "physics/contact.hpp"
#include "physics/equation_of_state.hpp"
#include "physics/free_surface.hpp"
#include "physics/hourglass.hpp"
#include "physics/hyperelastic.hpp"
#include "physics/kernel.hpp"
#include "physics/momentum.hpp"
#include "physics/rheology.hpp"
#include "physics/riemann.hpp"
#include "physics/stress.hpp"
#include "physics/timestep.hpp"
#include "physics/velocity_gradient.hpp"
#include "physics/viscosity.hpp"
#include "physics/wall.hpp"
#include "physics/yield.hpp"

namespace nb = nanobind;
using namespace doseki;

namespace {

using Column = std::vector<double>;
using Table = std::vector<Column>;  // one column per argument or result

/// Applies f(arguments) -> results to every row; T is double, or a Pack that takes several rows.
template <class T, class F>
Table evaluate(const Table& arguments, int results, F&& f) {
    constexpr int width = [] {
        if constexpr (std::is_same_v<T, double>)
            return 1;
        else
            return static_cast<int>(T::size());
    }();
    const std::size_t n = arguments.front().size();
    Table out(static_cast<std::size_t>(results), Column(n));
    for (std::size_t first = 0; first < n; first += width) {
        auto row = [&](int l) { return std::min(first + static_cast<std::size_t>(l), n - 1); };
        std::vector<T> in, result(static_cast<std::size_t>(results));
        for (const Column& column : arguments) {
            if constexpr (std::is_same_v<T, double>)
                in.push_back(column[first]);
            else
                in.push_back(T([&](auto l) { return column[row(l)]; }));
        }
        f(in, result);
        for (int k = 0; k < results; ++k)
            for (int l = 0; l < width; ++l) {
                if constexpr (std::is_same_v<T, double>)
                    out[k][first] = result[k];
                else
                    out[k][row(l)] = result[k][l];
            }
    }
    return out;
}

template <class F>
void define(nb::module_& m, const char* name, int results, F f) {
    m.def(
        name,
        [results, f](const Table& arguments, bool pack) {
            return pack ? evaluate<Pack<double>>(arguments, results, f)
                        : evaluate<double>(arguments, results, f);
        },
        nb::arg("columns"), nb::arg("pack") = false);
}

/// As define, for functions of plain numbers that no pair loop calls.
template <class F>
void define_numbers(nb::module_& m, const char* name, int results, F f) {
    m.def(
        name,
        [results, f](const Table& arguments, bool) {
            return evaluate<double>(arguments, results, f);
        },
        nb::arg("columns"), nb::arg("pack") = false);
}

template <int D, class T>
Vec<T, D> vector(const std::vector<T>& in, std::size_t first) {
    Vec<T, D> v;
    for (std::size_t a = 0; a < D; ++a) v[static_cast<int>(a)] = in[first + a];
    return v;
}

template <int D, class T>
Mat<T, D> matrix(const std::vector<T>& in, std::size_t first) {
    Mat<T, D> m;
    for (std::size_t k = 0; k < D * D; ++k) m.element[k] = in[first + k];
    return m;
}

template <int D, class T>
Deviator<T, D> deviator(const std::vector<T>& in, std::size_t first) {
    Deviator<T, D> s;
    for (std::size_t k = 0; k < Deviator<T, D>::size; ++k) s.element[k] = in[first + k];
    return s;
}

/// The point functions of the resolved scheme.
template <int D>
void bind_flow(nb::module_& m) {
    define(m, "wendland_c2", 2, [](const auto& in, auto& out) {  // r, 1/R -> W, F
        out[0] = WendlandC2<D>::value(in[0], in[1]);
        out[1] = WendlandC2<D>::gradient_factor(in[0], in[1]);
    });
    define(m, "pressure_jump", 1,
           [](const auto& in, auto& out) {  // p_i, p_j, grad p_i, grad p_j, r_ij
               out[0] = pressure_jump(in[0], in[1], vector<D>(in, 2), vector<D>(in, 2 + D),
                                      vector<D>(in, 2 + 2 * D));
           });
    define(m, "viscous_direction", D,
           [](const auto& in, auto& out) {  // along_jump, along_pair, v_ij, r_ij
               const auto v = vector<D>(in, 2), x = vector<D>(in, 2 + D);
               const ViscousForm<std::decay_t<decltype(in[0])>> form{in[0], in[1]};
               const auto direction = viscous_direction(form, v, dot(v, x), sqrt(dot(x, x)), x);
               std::copy(direction.component.begin(), direction.component.end(), out.begin());
           });
    define(m, "wall_excess_pressure", 1,
           [](const auto& in, auto& out) {  // rho, g_n, r.n, grad p, n, r
               out[0] = wall_excess_pressure(in[0], vector<D>(in, 3), in[1], vector<D>(in, 3 + D),
                                             in[2], vector<D>(in, 3 + 2 * D));
           });
    define_numbers(m, "strain_rate", 1,
                   [](const auto& in, auto& out) { out[0] = strain_rate(matrix<D>(in, 0)); });
    define_numbers(m, "lattice_sums_c2", 2,
                   [](const auto& in, auto& out) {  // dp, R -> sum W, moment
                       const auto sums = lattice_sums<WendlandC2<D>, D>(in[0], in[1]);
                       out[0] = sums.concentration, out[1] = sums.moment;
                   });
    define_numbers(m, "lattice_sums_c6", 2,
                   [](const auto& in, auto& out) {  // dp, R -> sum W, moment
                       const auto sums = lattice_sums<WendlandC6<D>, D>(in[0], in[1]);
                       out[0] = sums.concentration, out[1] = sums.moment;
                   });
    define_numbers(m, "inverse_moment", D * D,
                   [](const auto& in, auto& out) {  // the stored components
                       Sym<double, D> moment;
                       std::copy_n(in.begin(), moment.element.size(), moment.element.begin());
                       const auto inverse = inverse_moment(moment);
                       std::copy(inverse.element.begin(), inverse.element.end(), out.begin());
                   });
    define_numbers(m, "shifting_velocity", D, [](const auto& in, auto& out) {  // rate, h, grad C
        const auto v = shifting_velocity(vector<D>(in, 2), in[0], in[1]);
        std::copy(v.component.begin(), v.component.end(), out.begin());
    });
    define_numbers(m, "tangential", D, [](const auto& in, auto& out) {  // v, normal
        const auto v = tangential(vector<D>(in, 0), vector<D>(in, D));
        std::copy(v.component.begin(), v.component.end(), out.begin());
    });
}

/// Of elastic solids. F, dF/dt and stresses are matrices, row by row.
template <int D>
void bind_elastic_points(nb::module_& m) {
    constexpr std::size_t full = D * D;
    auto put = [](const auto& tensor, auto& out) {
        std::copy(tensor.element.begin(), tensor.element.end(), out.begin());
    };
    define(m, "green_strain", Sym<double, D>::size, [put](const auto& in, auto& out) {  // F
        put(green_strain(matrix<D>(in, 0)), out);
    });
    define(m, "st_venant_kirchhoff", full + 1,
           [put](const auto& in, auto& out) {  // F, lambda, mu -> P, energy
               const Lame<std::decay_t<decltype(in[0])>> lame{in[full], in[full + 1]};
               put(st_venant_kirchhoff(matrix<D>(in, 0), lame), out);
               out[full] = st_venant_kirchhoff_energy(matrix<D>(in, 0), lame);
           });
    define(m, "neo_hookean", full + 1,
           [put](const auto& in, auto& out) {  // F, lambda, mu -> P, energy
               const Lame<std::decay_t<decltype(in[0])>> lame{in[full], in[full + 1]};
               put(neo_hookean(matrix<D>(in, 0), lame), out);
               out[full] = neo_hookean_energy(matrix<D>(in, 0), lame);
           });
    define(m, "kelvin_voigt", full, [put](const auto& in, auto& out) {  // F, dF/dt, eta
        put(kelvin_voigt(matrix<D>(in, 0), matrix<D>(in, full), in[2 * full]), out);
    });
    define(m, "cauchy_stress", Sym<double, D>::size, [put](const auto& in, auto& out) {  // P, F
        put(cauchy_stress(matrix<D>(in, 0), matrix<D>(in, full)), out);
    });
    define(m, "elastic_pair_force", D,
           [](const auto& in, auto& out) {  // P_i, P_j, F_i, F_j, kappa, R_ij, r_ij
               const auto kappa = in[4 * full];
               const auto Q_i = less_springs(matrix<D>(in, 0), kappa, matrix<D>(in, 2 * full));
               const auto Q_j = less_springs(matrix<D>(in, full), kappa, matrix<D>(in, 3 * full));
               const auto force =
                   elastic_pair_force(Q_i, Q_j, kappa + kappa, vector<D>(in, 4 * full + 1),
                                      vector<D>(in, 4 * full + 1 + D));
               std::copy(force.component.begin(), force.component.end(), out.begin());
           });
}

/// Those that have no dimension.
void bind_flow_numbers(nb::module_& m) {
    define(m, "approach_pressure", 1, [](const auto& in, auto& out) {  // dU, rho, c
        out[0] = approach_pressure(in[0], in[1], in[2]);
    });
    define(m, "no_slip_factor", 1, [](const auto& in, auto& out) {  // d_w, d_i, least
        out[0] = no_slip_factor(in[0], in[1], in[2]);
    });
    define_numbers(m, "bed_friction", 1, [](const auto& in, auto& out) {  // rho, z, ks
        out[0] = bed_friction(in[0], in[1], in[2]);
    });
    define_numbers(m, "mixing_length", 1, [](const auto& in, auto& out) {  // z, d, least
        out[0] = mixing_length(in[0], in[1], in[2]);
    });
    define_numbers(m, "surface_measure", 2, [](const auto& in, auto& out) {  // C, R |grad C|, wide
        const auto measure = SurfaceMeasure::of(in[0], in[1], in[2] > 0.0);
        out[0] = measure.x, out[1] = measure.filling;
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
    define_numbers(m, "hertz_encounter", 2,
                   [](const auto& in, auto& out) {  // E*, R*, m*, v -> overlap, time
                       const auto meeting = hertz_encounter(in[0], in[1], in[2], in[3]);
                       out[0] = meeting.overlap, out[1] = meeting.time;
                   });
    define_numbers(m, "linear_encounter", 2,
                   [](const auto& in, auto& out) {  // k, m*, v -> overlap, time
                       const auto meeting = linear_encounter(in[0], in[1], in[2]);
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

/// Distance and normal of points (n, D) from the surface of the convex shape with the facets (m, D,
/// D).
template <int D>
void bind_shape(nb::module_& m) {
    m.def(
        "surface_from",
        [](const Table& corners, const Table& points) {
            Shape<D> shape;
            for (std::size_t k = 0; k + D <= corners.size(); k += D) {
                shape.facets.emplace_back();
                for (std::size_t a = 0; a < D; ++a)
                    shape.facets.back()[a] = vector<D>(corners[k + a], 0);
            }
            Table result;
            for (const Column& point : points) {
                const auto surface = shape.surface_from(vector<D>(point, 0));
                result.push_back({surface.distance});
                result.back().insert(result.back().end(), surface.normal.component.begin(),
                                     surface.normal.component.end());
            }
            return result;
        },
        nb::arg("corners"), nb::arg("points"));
}

template <int D>
void bind_dimension(nb::module_& m) {
    bind_flow<D>(m);
    bind_elastic_points<D>(m);
    bind_shape<D>(m);
    define(m, "kernel", 2, [](const auto& in, auto& out) {  // r, 1/R -> W, F
        out[0] = WendlandC6<D>::value(in[0], in[1]);
        out[1] = WendlandC6<D>::gradient_factor(in[0], in[1]);
    });
    define(m, "elastic_stress_rate", Deviator<double, D>::size,
           [](const auto& in, auto& out) {  // L, S, mu
               const auto rate =
                   elastic_stress_rate(matrix<D>(in, 0), deviator<D>(in, D * D), in.back());
               std::copy(rate.element.begin(), rate.element.end(), out.begin());
           });
    define(m, "newtonian_stress", Deviator<double, D>::size,
           [](const auto& in, auto& out) {  // L, rho, nu
               const auto tau = newtonian_stress(matrix<D>(in, 0), in[D * D], in[D * D + 1]);
               std::copy(tau.element.begin(), tau.element.end(), out.begin());
           });
    define(m, "balsara_switch", 1, [](const auto& in, auto& out) {  // L, c, h
        out[0] = balsara_switch(matrix<D>(in, 0), in[D * D], in[D * D + 1]);
    });
    define(m, "stress_over_rho_squared", Sym<double, D>::size,
           [](const auto& in, auto& out) {  // S, p, rho
               constexpr std::size_t size = Deviator<double, D>::size;
               const auto stress =
                   stress_over_rho_squared(in[size], deviator<D>(in, 0), in[size + 1]);
               std::copy(stress.element.begin(), stress.element.end(), out.begin());
           });
    define(m, "return_map", Deviator<double, D>::size,
           [](const auto& in, auto& out) {  // S, p, alpha, k
               constexpr std::size_t size = Deviator<double, D>::size;
               const YieldSurface<std::decay_t<decltype(in[0])>> surface{in[size + 1],
                                                                         in[size + 2]};
               const auto mapped = return_map(deviator<D>(in, 0), in[size], surface);
               std::copy(mapped.element.begin(), mapped.element.end(), out.begin());
           });
    define_numbers(m, "drucker_prager", 2,
                   [](const auto& in, auto& out) {  // cohesion, angle -> alpha, k
                       const auto surface = drucker_prager<D>(in[0], in[1]);
                       out[0] = surface.alpha, out[1] = surface.k;
                   });
    define(m, "shear_energy", 1, [](const auto& in, auto& out) {  // S, mu, rho
        constexpr std::size_t size = Deviator<double, D>::size;
        out[0] = shear_energy(deviator<D>(in, 0), in[size], in[size + 1]);
    });
}

}  // namespace

void bind_physics(nb::module_& m) {
    nb::module_ two = m.def_submodule("two"), three = m.def_submodule("three");
    bind_dimension<2>(two);
    bind_dimension<3>(three);
    bind_flow_numbers(m);
    bind_contact(m);
    define(m, "equation_of_state", 3, [](const auto& in, auto& out) {  // rho, rho0, c0 -> p, c, u
        const auto eos = BirchMurnaghan<std::decay_t<decltype(in[0])>>::at(in[0], in[1], in[2]);
        out[0] = eos.pressure, out[1] = eos.sound_speed, out[2] = eos.bulk_energy;
    });
    define(m, "pair_viscosity", 2,
           [](const auto& in, auto& out) {  // mu_i, mu_j -> mean, harmonic mean
               out[0] = pair_viscosity(in[0], in[1], false),
               out[1] = pair_viscosity(in[0], in[1], true);
           });
    define_numbers(m, "von_mises", 2, [](const auto& in, auto& out) {  // Y -> alpha, k
        const auto surface = von_mises(in[0]);
        out[0] = surface.alpha, out[1] = surface.k;
    });
    define(m, "tension_cut", 1, [](const auto& in, auto& out) {  // p, alpha, k
        out[0] = tension_cut(YieldSurface<std::decay_t<decltype(in[0])>>{in[1], in[2]}, in[0]);
    });
    define(m, "herschel_bulkley", 1,
           [](const auto& in, auto& out) {  // rate, tau_y, K, n, m, greatest
               out[0] =
                   HerschelBulkley<std::decay_t<decltype(in[0])>>{in[1], in[2], in[3], in[4], in[5]}
                       .viscosity(in[0]);
           });
    define(m, "mu_i", 1,
           [](const auto& in, auto& out) {  // rate, p, mu_s, mu_2, I_0, d, rho_s, greatest
               out[0] = MuI<std::decay_t<decltype(in[0])>>{in[2], in[3], in[4], in[5], in[6], in[7]}
                            .viscosity(in[0], in[1]);
           });
    define(m, "approach_speed", 1,
           [](const auto& in, auto& out) { out[0] = approach_speed(in[0], in[1]); });
    define(m, "signal_velocity", 1,
           [](const auto& in, auto& out) { out[0] = signal_velocity(in[0], in[1], in[2]); });
    define(m, "artificial_viscosity", 1,
           [](const auto& in, auto& out) {  // alpha, v_sig, w, rho_i, rho_j
               out[0] = artificial_viscosity(in[0], in[1], in[2], in[3], in[4]);
           });
    define(m, "timestep", 1, [](const auto& in, auto& out) {  // h, v_sig, |a|, C_CFL, C_f
        out[0] = timestep(in[0], in[1], in[2], in[3], in[4]);
    });
}
