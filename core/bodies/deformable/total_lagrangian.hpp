#pragma once
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "bodies/deformable/deformable_body.hpp"
#include "bodies/deformable/interactions.hpp"
#include "bodies/deformable/power_iteration.hpp"
#include "pairs/loop.hpp"
#include "pairs/neighbour_lists.hpp"

namespace doseki {

/// Deformable bodies in a total-Lagrangian description: pairs are those of the places at rest,
/// found once. Stress and strain are strictly inside one body, since at rest bodies are set far
/// apart. Forces are the gradient of a discrete energy, so that without damping position Verlet
/// keeps energy as well as momentum and angular momentum. Points are stored in the order of their
/// sort at rest; `slot` finds them.
template <int D>
class TotalLagrangian {
public:
    TotalLagrangian() : neighbours_(Domain<D>{}) {}

    /// Clamped points stay where they are. A point's mass is rho0 times spacing^D.
    void add(const DeformableBody& body, std::span<const Vec<double, D>> position,
             std::span<const Vec<double, D>> velocity, std::span<const std::uint8_t> clamped) {
        const auto number = static_cast<std::int32_t>(bodies_.size());
        const Vec<double, D> apart = room_for(body, position);
        for (std::size_t k = 0; k < position.size(); ++k) {
            rest_.push_back(position[k] + apart);
            x.push_back(position[k]);
            v.push_back(clamped[k] ? Vec<double, D>{} : velocity[k]);
            body_.push_back(number), clamped_.push_back(clamped[k]);
        }
        bodies_.push_back(body), apart_.push_back(apart);
    }

    /// Finds pairs, corrects gradients, takes the first accelerations. Call once, after the bodies
    /// are in.
    void start(const Vec<double, D>& gravity);

    /// Half a step of the forces of others, which change slowly [N], 2-D: [N/m].
    void kick(double half_dt, std::span<const Vec<double, D>> force) {
        for (std::size_t p = 0; p < size(); ++p)
            if (!clamped_[p]) v[p] = v[p] + (half_dt / mass(p)) * force[p];
    }

    /// Steps of their own over `dt`, under `load` and gravity.
    void advance(double dt, const Vec<double, D>& gravity) {
        const int steps = max(1, static_cast<int>(std::ceil(dt / timestep())));
        for (int n = 0; n < steps; ++n)
            drift(0.5 * dt / steps), push(dt / steps, gravity), drift(0.5 * dt / steps);
    }
    /// The parts of such a step: positions, which returns the largest distance gone, and
    /// velocities, before which `load` may be set.
    double drift(double dt);
    void push(double dt, const Vec<double, D>& gravity);

    /// The longest that is stable, for bodies strained as they are [s].
    double timestep() const;
    std::size_t size() const { return x.size(); }
    std::size_t bodies() const { return bodies_.size(); }
    double mass(std::size_t p) const { return body_of(p).rho0 * volume(p); }
    double volume(std::size_t p) const { return std::pow(body_of(p).spacing, D); }
    const DeformableBody& body_of(std::size_t p) const {
        return bodies_[static_cast<std::size_t>(body_[p])];
    }
    std::int32_t body(std::size_t p) const { return body_[p]; }
    bool clamped(std::size_t p) const { return clamped_[p] != 0; }
    /// Where the point that was added as number k is stored.
    std::uint32_t slot(std::size_t k) const { return slot_[k]; }
    Vec<double, D> rest_position(std::size_t p) const {
        return rest_[p] - apart_[static_cast<std::size_t>(body_[p])];
    }
    const Mat<double, D>& deformation(std::size_t p) const { return deformation_[p]; }
    /// First Piola-Kirchhoff stress without damping.
    Mat<double, D> stress(std::size_t p) const { return body_of(p).stress(deformation_[p]); }
    /// Of strain, without that of the springs [J], 2-D: [J/m].
    double strain_energy() const;
    double kinetic_energy() const;

    /// Restored, bodies go on with the same pairs in the same order: a sort leaves sorted points
    /// alone.
    template <class Archive>
    void serialise(Archive& archive, const Vec<double, D>& gravity) {
        std::vector<double> numbers;
        if constexpr (!Archive::loading)
            for (const DeformableBody& body : bodies_) {
                const auto of_body = body.numbers();
                numbers.insert(numbers.end(), of_body.begin(), of_body.end());
            }
        archive("elastic_numbers", numbers), archive("elastic_apart", apart_),
            archive("elastic_rest", rest_);
        archive("elastic_position", x), archive("elastic_velocity", v),
            archive("elastic_body", body_);
        archive("elastic_clamped", clamped_), archive("elastic_slot", slot_);
        std::vector<Vec<double, D>> accelerations = a;
        std::vector<Mat<double, D>> deformations = deformation_;
        archive("elastic_acceleration", accelerations),
            archive("elastic_deformation", deformations);
        if constexpr (Archive::loading) {
            const auto slots = slot_;
            bodies_.clear();
            for (std::size_t k = 0; k < numbers.size(); k += DeformableBody::count)
                bodies_.push_back(DeformableBody::of(&numbers[k]));
            start(gravity);
            a = accelerations, deformation_ = deformations, slot_ = slots;
        }
    }

    std::vector<Vec<double, D>> x, v, a;  // [m], [m/s], [m/s^2]
    std::vector<Vec<double, D>> load;     // force of others within a step [N], 2-D: [N/m]

private:
    /// Of the longest stable step.
    static constexpr double courant = 0.7;

    Vec<double, D> room_for(const DeformableBody& body, std::span<const Vec<double, D>> position);
    void sort();
    void correct_gradients();
    void limit_timestep();
    template <class F>
    void sum_internal_forces(double half_dt, const F& take);
    void compute_accelerations(double half_dt, const Vec<double, D>& gravity);
    std::vector<Vec<double, D>> linear_response(const std::vector<Vec<double, D>>& displacement,
                                                const std::vector<Vec<double, D>>& velocity);
    void update_point(std::size_t p, const DeformationAccumulators<double, D>& sums);

    template <class Term, class Epilogue>
    void sum_over_pairs(const Term& term, const Epilogue& epilogue) {
        for_each_pair<false>(neighbours_, neighbours_.clusters(),
                             std::span<const MotionRecord<double, D>>(motion_),
                             CoordinateFrame<double, D>{}, term, epilogue);
    }
    ElasticTerm<D> records() const { return {motion_, solid_}; }

    std::vector<DeformableBody> bodies_;
    std::vector<Vec<double, D>> apart_;  // by body: shift of its places at rest
    double reach_ = 0.0;                 // how far along x places at rest are taken
    std::vector<Vec<double, D>> rest_;
    std::vector<std::int32_t> body_;
    std::vector<std::uint8_t> clamped_;
    std::vector<std::uint32_t> slot_;
    std::vector<Mat<double, D>> correction_, deformation_;
    Neighbours<D> neighbours_;
    std::vector<MotionRecord<double, D>> motion_;
    std::vector<ElasticRecord<D>> solid_;
    double stable_step_ = std::numeric_limits<double>::max();  // for bodies at rest [s]
};

/// Shift along x that sets a body two supports beyond all before it.
template <int D>
Vec<double, D> TotalLagrangian<D>::room_for(const DeformableBody& body,
                                            std::span<const Vec<double, D>> position) {
    const double margin = 2.0 * body.support();
    double low = std::numeric_limits<double>::max(), high = -low;
    for (const auto& place : position) low = min(low, place[0]), high = max(high, place[0]);
    Vec<double, D> apart{};
    apart[0] = reach_ - low + margin;
    reach_ = high + apart[0] + margin;
    return apart;
}

template <int D>
void TotalLagrangian<D>::start(const Vec<double, D>& gravity) {
    if (size() == 0) return;
    sort();
    a.assign(size(), {}), load.assign(size(), {});
    deformation_.assign(size(), identity<double, D>());
    motion_.resize(size()), solid_.resize(size());
    for (std::size_t p = 0; p < size(); ++p) {
        const DeformableBody& body = body_of(p);
        motion_[p] = {{v[p], mass(p), 1.0 / body.support()}, rest_[p].component};
        const double stiffness = body.hourglass * body.lame().mu,
                     viscosity = body.hourglass * body.viscosity();
        solid_[p] = {rest_[p], volume(p), stiffness, viscosity, {}};
    }
    correct_gradients();
    limit_timestep();
    compute_accelerations(0.0, gravity);
}

template <int D>
void TotalLagrangian<D>::sort() {
    std::vector<double> radii(size());
    const std::vector<std::uint8_t> fixed(size(), 0);
    for (std::size_t p = 0; p < size(); ++p) radii[p] = body_of(p).support();
    const std::vector<std::uint32_t> order = neighbours_.sort(rest_, radii, fixed);
    auto reorder = [&order](auto& field) {
        auto sorted = field;
        for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = field[order[k]];
        field.swap(sorted);
    };
    reorder(rest_), reorder(x), reorder(v), reorder(body_), reorder(clamped_), reorder(radii);
    slot_.resize(size());
    for (std::uint32_t k = 0; k < order.size(); ++k) slot_[order[k]] = k;
    neighbours_.build(lanes<double>, rest_, radii, 0.0);
}

/// The records hold places at rest, so the deformation they give is what a gradient makes of none.
template <int D>
void TotalLagrangian<D>::correct_gradients() {
    // The matrix is 1 inside; 0 where neighbours do not span the space.
    constexpr double min_determinant = 1e-4;
    correction_.resize(size());
    std::vector<std::uint8_t> flat(size(), 0);
    auto finish = [&](std::size_t p, const DeformationAccumulators<double, D>& sums) {
        flat[p] = !(determinant(sums.place) > min_determinant);
        correction_[p] = inverse(sums.place, min_determinant);
    };
    sum_over_pairs(DeformationTerm<D>{records()}, finish);
    for (std::size_t p = 0; p < size(); ++p)
        if (flat[p])
            throw PhysicsFailure("an elastic body is too thin for its spacing of " +
                                     std::to_string(body_of(p).spacing) +
                                     " m: neighbours of a point do not span it",
                                 FailureKind::empty);
}

/// Accelerations by internal forces about rest, which are linear in small displacements and
/// velocities.
template <int D>
std::vector<Vec<double, D>> TotalLagrangian<D>::linear_response(
    const std::vector<Vec<double, D>>& displacement, const std::vector<Vec<double, D>>& velocity) {
    for (std::size_t p = 0; p < size(); ++p) x[p] = rest_[p] + displacement[p], v[p] = velocity[p];
    std::vector<Vec<double, D>> response(size());
    sum_internal_forces(0.0, [&](std::size_t p, const Vec<double, D>& force) {
        if (!clamped_[p]) response[p] = (1.0 / body_of(p).rho0) * force;
    });
    return response;
}

/// Eq. (84). With omega^2 and gamma the eigenvalues of stiffness and damping, Verlet with predicted
/// velocities is stable while omega^2 dt^2/4 + gamma dt < 1.
template <int D>
void TotalLagrangian<D>::limit_timestep() {
    const double amplitude = 1e-6 * bodies_[0].spacing;
    const auto x0 = x, v0 = v;
    const std::vector<Vec<double, D>> none(size());
    std::vector<Vec<double, D>> mode(size());
    for (std::size_t p = 0; p < size(); ++p)  // not orthogonal to the fastest mode
        for (int k = 0; k < D && !clamped_[p]; ++k)
            mode[p][k] =
                std::sin(1.0 + 7.0 * static_cast<double>(D * p + static_cast<std::size_t>(k)));
    const double stiffness = largest_eigenvalue(
        mode, amplitude, [&](const auto& moved) { return linear_response(moved, none); });
    const double damping = largest_eigenvalue(
        mode, amplitude, [&](const auto& moving) { return linear_response(none, moving); });
    x = x0, v = v0;
    if (stiffness > 0.0)
        stable_step_ = 2.0 * (std::sqrt(damping * damping + stiffness) - damping) / stiffness;
}

/// Between the sums: strain and stress of one point, as the second sum needs them.
template <int D>
void TotalLagrangian<D>::update_point(std::size_t p,
                                      const DeformationAccumulators<double, D>& sums) {
    const DeformableBody& body = body_of(p);
    const Mat<double, D>& B = correction_[p];
    deformation_[p] = sums.place * B;
    const Mat<double, D> rate = sums.velocity * B;
    const Mat<double, D> P = stress(p) + kelvin_voigt(deformation_[p], rate, body.viscosity());
    const Mat<double, D> elastic =
        less_springs(P * transposed(B), solid_[p].kappa, deformation_[p]);
    solid_[p].Q = less_springs(elastic, solid_[p].kappa_rate, rate);
}

/// Calls take(p, force per volume at rest), for velocities predicted half_dt ahead.
template <int D>
template <class F>
void TotalLagrangian<D>::sum_internal_forces(double half_dt, const F& take) {
    for_each_particle(size(), [&](std::size_t p) {
        solid_[p].x = x[p];
        motion_[p].v = v[p] + half_dt * a[p];
    });
    auto update = [this](std::size_t p, const DeformationAccumulators<double, D>& sums) {
        update_point(p, sums);
    };
    sum_over_pairs(DeformationTerm<D>{records()}, update);
    sum_over_pairs(InternalForceTerm<D>{records()}, take);
}

template <int D>
void TotalLagrangian<D>::compute_accelerations(double half_dt, const Vec<double, D>& gravity) {
    sum_internal_forces(half_dt, [&](std::size_t p, const Vec<double, D>& force) {
        a[p] = clamped_[p] ? Vec<double, D>{}
                           : (1.0 / body_of(p).rho0) * force + (1.0 / mass(p)) * load[p] + gravity;
    });
}

template <int D>
double TotalLagrangian<D>::drift(double dt) {
    const double fastest = reduce(size(), 0.0, maximum, [&](std::size_t p) {
        x[p] = x[p] + dt * v[p];
        return dot(v[p], v[p]);
    });
    return dt * sqrt(fastest);
}

/// Damping sees the velocities that the last accelerations predict for the middle of the step.
template <int D>
void TotalLagrangian<D>::push(double dt, const Vec<double, D>& gravity) {
    compute_accelerations(0.5 * dt, gravity);
    const double sum = reduce(size(), 0.0, std::plus<>(), [&](std::size_t p) {
        v[p] = v[p] + dt * a[p];
        return dot(v[p], v[p]);
    });
    if (!std::isfinite(sum))
        throw PhysicsFailure("an elastic body has lost its shape", FailureKind::not_finite);
}

template <int D>
double TotalLagrangian<D>::timestep() const {
    double stiffening = 1.0;
    for (std::size_t p = 0; p < size(); ++p)
        stiffening = max(stiffening, body_of(p).stiffening(deformation_[p]));
    return courant * stable_step_ / stiffening;
}

template <int D>
double TotalLagrangian<D>::strain_energy() const {
    double sum = 0.0;
    for (std::size_t p = 0; p < size(); ++p) {
        sum += volume(p) * body_of(p).energy(deformation_[p]);
    }
    return sum;
}

template <int D>
double TotalLagrangian<D>::kinetic_energy() const {
    double sum = 0.0;
    for (std::size_t p = 0; p < size(); ++p) sum += 0.5 * mass(p) * dot(v[p], v[p]);
    return sum;
}

// Compiled once: bodies_2.cpp, bodies_3.cpp.
extern template class TotalLagrangian<2>;
extern template class TotalLagrangian<3>;

}  // namespace doseki
