#pragma once
// What touches breakable bodies: how heavy it is, and how it moves.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>

#include "base/vec.hpp"
#include "bodies/deformable/deformable_bodies.hpp"
#include "bodies/rigid_bodies.hpp"
#include "bodies/rotation.hpp"
#include "model/domain.hpp"

namespace doseki {

/// All bodies by the numbers that contacts give them, rigid ones first. The motion of a deformable
/// one is worked out once, when it is asked for.
template <int D>
class PartnersOfBodies {
public:
    PartnersOfBodies(const RigidBodies<D>& rigid, const DeformableBodies<D>& deformable,
                     const Domain<D>& domain)
        : rigid_(rigid), deformable_(deformable), domain_(domain) {}

    /// [kg], 2-D: [kg/m]; 0 of a fixed one.
    double mass(std::int32_t k) const {
        const auto body = static_cast<std::size_t>(k);
        if (body >= rigid_.size()) return motion(body - rigid_.size()).mass;
        return rigid_.body(body).fixed ? 0.0 : rigid_.body(body).mass;
    }
    /// The largest mass of all.
    double heaviest() const {
        double most = 0.0;
        for (std::size_t k = 0; k < rigid_.size(); ++k)
            if (!rigid_.body(k).fixed) most = std::max(most, rigid_.body(k).mass);
        for (const auto& [body, motion] : motions_) most = std::max(most, motion.mass);
        return most;
    }
    /// At a place [m/s]; of a deformable one that of its centre.
    Vec<double, D> velocity(std::int32_t k, const Vec<double, D>& place) const {
        const auto body = static_cast<std::size_t>(k);
        if (body >= rigid_.size()) return motion(body - rigid_.size()).velocity;
        const RigidBodyState<D>& state = rigid_.state(body);
        const Vec<double, D> r = nearest_image(domain_, place - state.centre);
        return state.velocity + turning_velocity<D>(rigid_.spin(body), r);
    }

private:
    const RigidMotion<D>& motion(std::size_t body) const {
        const auto [at, is_new] = motions_.try_emplace(body);
        if (is_new) {
            const auto& solids = deformable_.solids();
            at->second = rigid_motion<D>(solids, solids.points_of(body));
        }
        return at->second;
    }

    const RigidBodies<D>& rigid_;
    const DeformableBodies<D>& deformable_;
    const Domain<D>& domain_;
    mutable std::map<std::size_t, RigidMotion<D>> motions_;
};

}  // namespace doseki
