#pragma once
#include <cmath>
#include <span>

#include "resolved/model.hpp"

namespace doseki {

/// What the scheme makes of the sums of a wall particle: force, pressure and, on a rough bed, the
/// friction that fluid particles near it share.
template <int D>
class WallEpilogue {
public:
    WallEpilogue(const ResolvedModel<D>& model, std::span<WallRecord<D>> records,
                 std::size_t first_wall, ResolvedState<D>& state)
        : model_(model), records_(records), first_wall_(first_wall), state_(state) {}

    void operator()(std::size_t p, const WallAccumulators<double, D>& sums) const {
        if (p < first_wall_) return;  // a fluid particle in the first cluster of walls
        WallState<D>& wall = state_.wall;
        WallRecord<D>& record = records_[p - first_wall_];
        Vec<double, D> force = sums.force;
        wall.pressure[p] = sums.weight > 0.0 ? sums.pressure / sums.weight : 0.0;
        const double ks = model_.wall_condition(state_.tag[p]).ks;
        if (ks > 0.0 && record.depth < model_.options.flow.dp && sums.weight > min_filled) {
            const Vec<double, D> drag = bed_drag(p, sums, ks);
            record.traction = (-1.0 / sums.weight) * drag;
            force = force + drag;
        }
        wall.force[p] = force;
    }

private:
    static constexpr double min_filled = 0.05;  // of the kernel, by fluid

    Vec<double, D> bed_drag(std::size_t p, const WallAccumulators<double, D>& sums,
                            double ks) const {
        const Vec<double, D> u = (1.0 / sums.weight) * sums.velocity - state_.velocity[p];
        const Vec<double, D> along = tangential(u, state_.wall.normal[p]);
        const double rho = sums.density / sums.weight;
        const double friction =
            bed_friction(rho, sums.height / sums.weight, ks) * model_.spacing_power[D - 1];
        return friction * std::sqrt(dot(along, along)) * along;
    }

    const ResolvedModel<D>& model_;
    std::span<WallRecord<D>> records_;
    std::size_t first_wall_;
    ResolvedState<D>& state_;
};

}  // namespace doseki
