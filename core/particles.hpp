#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "base/vec.hpp"

namespace doseki {

/// How a particle's position changes. Fixed particles give interactions but never move (the paper's
/// slope); driven ones move with a prescribed velocity (the inflow buffer); bound ones are points
/// of a body that moves as a whole.
enum class Motion : std::uint8_t { free, fixed, driven, bound };

/// What a particle is, in one machine word and a half.
struct Tag {
    std::int64_t id;
    std::int32_t body;
    std::int16_t material;
    Motion motion;
};

/// The state of all particles, one array per field, sorted in space by Neighbours. Everything is
/// double: the precision of a run is that of its pair sums.
template <int D>
struct Particles {
    std::vector<Vec<double, D>> position;                     // [m]
    std::vector<Vec<double, D>> velocity;                     // [m/s]
    std::vector<Vec<double, D>> acceleration;                 // [m/s^2]
    std::vector<double> density;                              // [kg/m^3]
    std::vector<double> density_rate;                         // [kg/m^3/s]
    std::vector<Deviator<double, D>> deviatoric_stress;       // [Pa]
    std::vector<Deviator<double, D>> deviatoric_stress_rate;  // [Pa/s]
    bool has_strength = true;  // without, the two arrays above stay empty
    /// Of the resolved scheme.
    struct Flow {
        std::vector<Vec<double, D>> pressure_gradient;  // of the last step [Pa/m]
        std::vector<Mat<double, D>> velocity_gradient;  // of the last step [1/s]
        std::vector<Vec<double, D>> shift;              // velocity relative to the fluid [m/s]
        std::vector<double> surface;                    // of the last step, see SurfaceMeasure
        std::vector<double> mixing_length;              // [m]
        std::vector<double> mean_pressure;  // over a time, where friction depends on it [Pa]
        // Of wall particles:
        std::vector<Vec<double, D>> normal;      // into the fluid
        std::vector<double> wall_depth;          // below the surface of the wall [m]
        std::vector<Vec<double, D>> wall_force;  // of the fluid on it [N], 2-D: [N/m]
        std::vector<double> wall_pressure;       // of the fluid at its place [Pa]
        std::vector<std::int32_t> point;         // of bound ones: index among the points of bodies
    } flow;
    bool has_flow = false;                 // without, the arrays of `flow` stay empty
    std::vector<double> mass;              // [kg], 2-D: [kg/m]
    std::vector<double> smoothing_length;  // [m]
    std::vector<Tag> tag;

    std::size_t size() const { return tag.size(); }

    /// Calls f(name, array) for every field; the one list from which sorting, growth and
    /// checkpoints derive.
    template <class F>
    void serialise(F&& f) {
        f("position", position), f("velocity", velocity), f("acceleration", acceleration);
        f("density", density), f("density_rate", density_rate);
        if (has_strength)
            f("deviatoric_stress", deviatoric_stress),
                f("deviatoric_stress_rate", deviatoric_stress_rate);
        if (has_flow) {
            f("pressure_gradient", flow.pressure_gradient),
                f("velocity_gradient", flow.velocity_gradient);
            f("shift", flow.shift), f("surface", flow.surface),
                f("mixing_length", flow.mixing_length);
            f("mean_pressure", flow.mean_pressure);
            f("normal", flow.normal), f("wall_depth", flow.wall_depth);
            f("wall_force", flow.wall_force), f("wall_pressure", flow.wall_pressure);
            f("point", flow.point);
        }
        f("mass", mass), f("smoothing_length", smoothing_length), f("tag", tag);
    }

    template <class F>
    void for_each_field(F&& f) {
        serialise([&f](const char*, auto& field) { f(field); });
    }

    void resize(std::size_t n) {
        for_each_field([n](auto& field) { field.resize(n); });
    }

    /// New particle k is old particle order[k]; particles not named are gone.
    void reorder(std::span<const std::uint32_t> order) {
        for_each_field([order](auto& field) {
            std::remove_reference_t<decltype(field)> sorted(order.size());
#pragma omp parallel for schedule(static) if (order.size() > light_loop)
            for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = field[order[k]];
            field.swap(sorted);
        });
    }

    Deviator<double, D> stress(std::size_t p) const {
        return has_strength ? deviatoric_stress[p] : Deviator<double, D>{};
    }
    Deviator<double, D> stress_rate(std::size_t p) const {
        return has_strength ? deviatoric_stress_rate[p] : Deviator<double, D>{};
    }

    bool is_free(std::size_t p) const { return tag[p].motion == Motion::free; }
    bool is_fixed(std::size_t p) const { return tag[p].motion == Motion::fixed; }
    bool is_bound(std::size_t p) const { return tag[p].motion == Motion::bound; }
    /// One that fluid meets as it meets a wall.
    bool is_wall(std::size_t p) const { return is_fixed(p) || is_bound(p); }
    /// One that is in the account of masses.
    bool is_counted(std::size_t p) const { return is_free(p) || is_bound(p); }
};

}  // namespace doseki
