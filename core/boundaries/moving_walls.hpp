#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "base/array.hpp"
#include "model/particles.hpp"

namespace doseki {

/// The prescribed motion of a fixed body: from `start` to `stop` it goes with `velocity` and turns
/// with `spin` about a pivot that goes with it. At `removed_at` it vanishes, as an opened gate
/// does.
template <int D>
struct WallMotion {
    std::int32_t body = 0;
    Vec<double, D> velocity{};                         // [m/s]
    std::array<double, 3> spin{};                      // [rad/s]; 2-D: the last entry alone
    Vec<double, D> pivot{};                            // at `start` [m]
    double start = 0.0, stop = 0.0, removed_at = 0.0;  // [s]

    DOSEKI_DEVICE_FN bool moves(double t) const { return start <= t && t < stop; }
    /// Whether a body with the other motion never parts from one with this.
    bool is_that_of(const WallMotion& other) const {
        return velocity.component == other.velocity.component && spin == other.spin &&
               pivot.component == other.pivot.component && start == other.start &&
               stop == other.stop && removed_at == other.removed_at;
    }

    Vec<double, 3> spin_at(double t) const {
        Vec<double, 3> w;
        if (moves(t)) w.component = spin;
        return w;
    }

    /// The same about the axes of the run.
    DOSEKI_DEVICE_FN Turn<double, D> turn_at(double t) const {
        return moves(t) ? turn() : Turn<double, D>{};
    }

    DOSEKI_DEVICE_FN Vec<double, D> velocity_at(const Vec<double, D>& x, double t) const {
        return moves(t) ? moving_velocity(x, t) : Vec<double, D>{};
    }
    /// The same up to the end of the motion itself.
    DOSEKI_DEVICE_FN Vec<double, D> moving_velocity(const Vec<double, D>& x, double t) const {
        return velocity + cross_spin(x - pivot_at(t));
    }
    /// Towards the axis about which the body turns.
    DOSEKI_DEVICE_FN Vec<double, D> acceleration_at(const Vec<double, D>& x, double t) const {
        return moves(t) ? cross_spin(cross_spin(x - pivot_at(t))) : Vec<double, D>{};
    }

    /// Where a point that is at x at time t is after dt, within which the motion does not change.
    DOSEKI_DEVICE_FN Vec<double, D> moved(const Vec<double, D>& x, double t, double dt) const {
        return x + dt * velocity + turning(x - pivot_at(t), dt);
    }

    /// What turning for dt adds to a vector that is fixed to the body. It turns by the exact angle,
    /// so a body keeps its shape over any number of steps.
    DOSEKI_DEVICE_FN Vec<double, D> turning(const Vec<double, D>& r, double dt) const {
        const double rate = std::sqrt(spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2]);
        if (rate == 0.0) return {};
        // Rodrigues, k being the axis: k x r sin + k x (k x r) (1 - cos).
        const Vec<double, D> once = (1.0 / rate) * cross_spin(r),
                             twice = (1.0 / rate) * cross_spin(once);
        const double half_sine = std::sin(0.5 * rate * dt);
        return std::sin(rate * dt) * once + 2.0 * half_sine * half_sine * twice;
    }

private:
    DOSEKI_DEVICE_FN Vec<double, D> pivot_at(double t) const {
        return pivot + (std::clamp(t, start, stop) - start) * velocity;
    }

    DOSEKI_DEVICE_FN Turn<double, D> turn() const {
        constexpr std::size_t axes = std::size_t{D == 2 ? 1 : 3};
        Turn<double, D> turn;
        for (std::size_t a = 0; a < axes; ++a) turn[a] = spin[3 - axes + a];
        return turn;
    }
    DOSEKI_DEVICE_FN Vec<double, D> cross_spin(const Vec<double, D>& r) const {
        return turned_by<double, D>(turn(), r);
    }
};

/// Motions, and the index of that of each body; -1: none.
template <int D>
struct MotionsOfBodies {
    std::span<const WallMotion<D>> motions;
    std::span<const int> of_body;

    /// Null for a body that stands still.
    DOSEKI_DEVICE_FN const WallMotion<D>* of(std::int32_t named) const {
        const auto body = static_cast<std::size_t>(named);
        return body < of_body.size() && of_body[body] >= 0
                   ? &motions[static_cast<std::size_t>(of_body[body])]
                   : nullptr;
    }
    /// That of a particle.
    DOSEKI_DEVICE_FN const WallMotion<D>* of(const Tag& tag) const {
        return tag.motion == Motion::fixed ? of(tag.body) : nullptr;
    }
};

/// The walls that move. Their motion follows from the time alone and their particles hold where
/// they are, so there is no further state.
template <int D>
class MovingWalls {
public:
    void add(const WallMotion<D>& motion) {
        const auto body = static_cast<std::size_t>(motion.body);
        if (body >= of_body_.size()) of_body_.resize(body + 1, -1);
        of_body_[body] = static_cast<int>(motions_.size());
        motions_.push_back(motion);
    }

    /// The first time after t at which a motion begins or ends, or a body vanishes.
    double next_event(double t) const {
        double next = std::numeric_limits<double>::infinity();
        for (const WallMotion<D>& motion : motions_)
            for (double event : std::array{motion.start, motion.stop, motion.removed_at})
                if (event > t) next = std::min(next, event);
        return next;
    }

    /// Takes walls from t to t + dt, with the velocity of the way that they go; returns the largest
    /// distance that a particle of theirs went.
    double move(Particles<D>& particles, double t, double dt) const;

    /// Gives particles of moving walls their velocity and acceleration at time t, zero outside the
    /// time they move.
    void set_velocities(Particles<D>& particles, double t) const;

    /// Marks in `removed` what vanishes after `before` and up to t; true if there is any.
    bool remove(const Particles<D>& particles, double before, double t,
                Array<std::uint8_t>& removed) const {
        bool any = false;
        for (const WallMotion<D>& motion : motions_) any |= vanishes(motion, before, t);
        if (!any) return false;
        removed.resize(particles.size(), 0);
        for (std::size_t p = 0; p < particles.size(); ++p)
            if (const WallMotion<D>* motion = motions().of(particles.tag[p]);
                motion && vanishes(*motion, before, t))
                removed[p] = 1;
        return true;
    }

    MotionsOfBodies<D> motions() const { return {motions_, of_body_}; }

private:
    static bool vanishes(const WallMotion<D>& motion, double before, double t) {
        return before < motion.removed_at && motion.removed_at <= t;
    }

    bool any_moves(double t) const {
        return std::any_of(motions_.begin(), motions_.end(),
                           [t](const auto& motion) { return motion.moves(t); });
    }

    Array<WallMotion<D>> motions_;
    Array<int> of_body_;  // index of its motion; -1: none
};

// Compiled once: moving_walls.cpp.
extern template class MovingWalls<2>;
extern template class MovingWalls<3>;

}  // namespace doseki
