// The point functions that sums over pairs are made of.

#include "physics/free_surface.hpp"
#include "physics/kernel/wendland_c2.hpp"
#include "physics/kernel/wendland_c6.hpp"
#include "physics/momentum.hpp"
#include "physics/rheology/pair_viscosity.hpp"
#include "physics/riemann.hpp"
#include "physics/stress.hpp"
#include "physics/timestep.hpp"
#include "physics/velocity_gradient.hpp"
#include "physics/viscosity.hpp"
#include "physics/wall.hpp"
#include "python/point_functions.hpp"

using namespace doseki;

void bind_laws(nb::module_& m, nb::module_& two, nb::module_& three);

namespace {

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
           [](const auto& in, auto& out) {  // factors of the form, v_ij, L^T r_ij, r_ij
               const auto v = vector<D>(in, 3), x = vector<D>(in, 3 + 2 * D);
               const ViscousForm<NumberOf<decltype(in)>> form{in[0], in[1], in[2]};
               put(viscous_direction(form, v, vector<D>(in, 3 + D), dot(v, x),
                                     1.0 / sqrt(dot(x, x)), x),
                   out);
           });
    define(m, "wall_excess_pressure", 1,
           [](const auto& in, auto& out) {  // p, rho, g_n, r.n, grad p, n, r
               out[0] = wall_excess_pressure(in[0], in[1], vector<D>(in, 4), in[2],
                                             vector<D>(in, 4 + D), in[3], vector<D>(in, 4 + 2 * D));
           });
    define(m, "normal_at_foot", D, [](const auto& in, auto& out) {  // n, turn
        put(normal_at_foot(vector<D>(in, 0), vector<D>(in, D)), out);
    });
    define(m, "strain_rate", 1,
           [](const auto& in, auto& out) { out[0] = strain_rate(matrix<D>(in, 0)); });
    define(m, "pair_viscosity", 3, [](const auto& in, auto& out) {  // mu_i, mu_j, L_i, L_j
        const auto D_i = symmetric_part(matrix<D>(in, 2)),
                   D_j = symmetric_part(matrix<D>(in, 2 + D * D));
        out[0] = pair_viscosity(in[0], in[1], D_i, D_j, PairViscosity::mean);
        out[1] = pair_viscosity(in[0], in[1], D_i, D_j, PairViscosity::by_rate);
        out[2] = pair_viscosity(in[0], in[1], D_i, D_j, PairViscosity::harmonic);
    });
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
    define_numbers(m, "inverse", D * D, [](const auto& in, auto& out) {  // matrix, min_determinant
        put(inverse(matrix<D>(in, 0), in[D * D]), out);
    });
    define_numbers(m, "inverse_moment", D * D,
                   [](const auto& in, auto& out) {  // the stored components
                       Sym<double, D> moment;
                       std::copy_n(in.begin(), moment.element.size(), moment.element.begin());
                       put(inverse_moment(moment), out);
                   });
    define_numbers(m, "shifting_velocity", D, [](const auto& in, auto& out) {  // rate, h, grad C
        put(shifting_velocity(vector<D>(in, 2), in[0], in[1]), out);
    });
    define_numbers(m, "tangential", D, [](const auto& in, auto& out) {  // v, normal
        put(tangential(vector<D>(in, 0), vector<D>(in, D)), out);
    });
}

/// Those that have no dimension.
void bind_flow_numbers(nb::module_& m) {
    define(m, "approach_pressure", 1, [](const auto& in, auto& out) {  // dU, rho, c, smooth
        out[0] = approach_pressure(in[0], in[1], in[2], in[3]);
    });
    define(m, "smooth_approach", 1, [](const auto& in, auto& out) {  // strain rate, r
        out[0] = smooth_approach(in[0], in[1]);
    });
    define(m, "no_slip_factor", 1, [](const auto& in, auto& out) {  // d_w, d_i, least
        out[0] = no_slip_factor(in[0], in[1], in[2]);
    });
    define(m, "resolved_shear", 1, [](const auto& in, auto& out) {  // mu, rho, speed, dp
        out[0] = resolved_shear(in[0], in[1], in[2], in[3]);
    });
    define_numbers(m, "edge_rate", 1, [](const auto& in, auto& out) {  // rate, size
        out[0] = edge_rate(in[0], in[1]);
    });
    define_numbers(m, "bed_friction", 1, [](const auto& in, auto& out) {  // rho, z, ks
        out[0] = bed_friction(in[0], in[1], in[2]);
    });
    define_numbers(m, "voellmy_stress", 1, [](const auto& in, auto& out) {
        // mu, effective normal stress, rho, g, speed, xi
        out[0] = voellmy_stress(in[0], in[1], in[2], in[3], in[4], in[5]);
    });
    define_numbers(m, "mixing_length", 1, [](const auto& in, auto& out) {  // z, d, least
        out[0] = mixing_length(in[0], in[1], in[2]);
    });
    define_numbers(m, "free_surface_indicator", 2,
                   [](const auto& in, auto& out) {  // C, R |grad C|, wide
                       const auto measure = FreeSurfaceIndicator::of(in[0], in[1], in[2] > 0.0);
                       out[0] = measure.x, out[1] = measure.normalised_density;
                   });
}

template <int D>
void bind_dimension(nb::module_& m) {
    bind_flow<D>(m);
    define(m, "kernel", 2, [](const auto& in, auto& out) {  // r, 1/R -> W, F
        out[0] = WendlandC6<D>::value(in[0], in[1]);
        out[1] = WendlandC6<D>::gradient_factor(in[0], in[1]);
    });
    define(m, "elastic_stress_rate", Deviator<double, D>::size,
           [](const auto& in, auto& out) {  // L, S, mu
               put(elastic_stress_rate(matrix<D>(in, 0), deviator<D>(in, D * D), in.back()), out);
           });
    define(m, "viscous_stress", Deviator<double, D>::size, [](const auto& in, auto& out) {  // L, mu
        put(viscous_stress(matrix<D>(in, 0), in[D * D]), out);
    });
    define(m, "balsara_switch", 1, [](const auto& in, auto& out) {  // L, c, h
        out[0] = balsara_switch(matrix<D>(in, 0), in[D * D], in[D * D + 1]);
    });
    define(m, "stress_over_rho_squared", Sym<double, D>::size,
           [](const auto& in, auto& out) {  // S, p, rho
               constexpr std::size_t size = Deviator<double, D>::size;
               put(stress_over_rho_squared(in[size], deviator<D>(in, 0), in[size + 1]), out);
           });
    define(m, "shear_energy", 1, [](const auto& in, auto& out) {  // S, mu, rho
        constexpr std::size_t size = Deviator<double, D>::size;
        out[0] = shear_energy(deviator<D>(in, 0), in[size], in[size + 1]);
    });
}

}  // namespace

void bind_physics(nb::module_& module) {
    module.attr("lanes") = lanes<double>;
    nb::module_ m =
        module.def_submodule("physics", "Point functions, each on scalars and on packs.");
    nb::module_ two = m.def_submodule("two"), three = m.def_submodule("three");
    bind_dimension<2>(two);
    bind_dimension<3>(three);
    bind_flow_numbers(m);
    bind_laws(m, two, three);
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
