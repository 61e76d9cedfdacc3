#pragma once
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "elastic/elastic_terms.hpp"
#include "physics/hyperelastic.hpp"

namespace doseki {

enum class ElasticLaw { st_venant_kirchhoff, neo_hookean };

/// A deformable body: its material, and how its points resolve it.
struct ElasticBody {
    double rho0 = 1000.0;  // [kg/m^3]
    Lame<double> lame{};   // [Pa]
    ElasticLaw law = ElasticLaw::st_venant_kirchhoff;
    double spacing = 0.0;    // of its points at rest [m]
    double hourglass = 0.5;  // stiffness and damping of the springs over those of the body in shear
    double damping = 0.02;   // viscosity of Kelvin-Voigt's damper over rho0 c_P spacing, Eq. (82)

    /// Radius of the kernel. Points at rest are evenly spread, so that the nearest suffice; the
    /// farther it reaches, the softer are surfaces, whose gradients are one-sided.
    double support() const { return 1.6 * spacing; }
    double wave_speed() const { return p_wave_speed(lame, rho0); }
    double viscosity() const { return damping * rho0 * wave_speed() * spacing; }
    /// Cauchy stress along z of a plane state of strain.
    double stress_across(const Mat<double, 2>& F) const {
        const double J = determinant(F);
        if (law == ElasticLaw::neo_hookean) return lame.lambda * std::log(J) / J;
        const Sym<double, 2> strain = green_strain(F);
        return lame.lambda * (strain(0, 0) + strain(1, 1)) / J;
    }

    static constexpr std::size_t count = 7;
    std::array<double, count> numbers() const {
        return {rho0,    lame.lambda, lame.mu, law == ElasticLaw::neo_hookean ? 1.0 : 0.0,
                spacing, hourglass,   damping};
    }
    static ElasticBody of(const double* n) {
        return {n[0],
                {n[1], n[2]},
                n[3] > 0.0 ? ElasticLaw::neo_hookean : ElasticLaw::st_venant_kirchhoff,
                n[4],
                n[5],
                n[6]};
    }

    /// How many times faster waves are in a state of strain, at most.
    template <int D>
    double stiffening(const Mat<double, D>& F) const {
        if (law == ElasticLaw::neo_hookean) {
            const double J = determinant(F);
            return J < 1.0 ? std::sqrt(1.0 - std::log(J)) / J : 1.0;
        }
        double stretch = 0.0;  // squared
        for (int a = 0; a < D; ++a) {
            double length = 0.0;
            for (int b = 0; b < D; ++b) length += F(b, a) * F(b, a);
            stretch = std::max(stretch, length);
        }
        return std::sqrt(std::max(1.0, 0.5 * (3.0 * stretch - 1.0)));
    }
};

/// Deformable bodies in a total-Lagrangian description: pairs are those of the places at rest,
/// found once. Stress and strain are strictly inside one body, since at rest bodies are set far
/// apart. Forces are the gradient of a discrete energy, so that without damping position Verlet
/// keeps energy as well as momentum and angular momentum. Points are stored in the order of their
/// sort at rest; `slot` finds them.
template <int D>
class ElasticBodies {
public:
    ElasticBodies() : neighbours_(Domain<D>{}) {}

    /// Clamped points stay where they are. A point's mass is rho0 times spacing^D.
    void add(const ElasticBody& body, std::span<const Vec<double, D>> position,
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

    /// Finds pairs, corrects gradients, takes the first rates. Call once, after the bodies are in.
    void start();

    /// Half a step of the forces of others, which change slowly [N], 2-D: [N/m].
    void kick(double half_dt, std::span<const Vec<double, D>> force) {
        for (std::size_t p = 0; p < size(); ++p)
            if (!clamped_[p]) v[p] = v[p] + (half_dt / mass(p)) * force[p];
    }

    /// Steps of their own over `dt`, under `load` and gravity.
    void advance(double dt) {
        const int steps = max(1, static_cast<int>(std::ceil(dt / timestep())));
        for (int n = 0; n < steps; ++n)
            drift(0.5 * dt / steps), push(dt / steps), drift(0.5 * dt / steps);
    }
    /// The parts of such a step; `load` may be set before the second. Returns the greatest distance
    /// gone.
    double drift(double dt);
    void push(double dt);

    /// The longest that is stable, for bodies strained as they are [s].
    double timestep() const;
    std::size_t size() const { return x.size(); }
    std::size_t bodies() const { return bodies_.size(); }
    double mass(std::size_t p) const { return body_of(p).rho0 * volume(p); }
    double volume(std::size_t p) const { return std::pow(body_of(p).spacing, D); }
    const ElasticBody& body_of(std::size_t p) const {
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
    Mat<double, D> stress(std::size_t p) const {
        const ElasticBody& body = body_of(p);
        return body.law == ElasticLaw::neo_hookean
                   ? neo_hookean(deformation_[p], body.lame)
                   : st_venant_kirchhoff(deformation_[p], body.lame);
    }
    /// Of strain, without that of the springs [J], 2-D: [J/m].
    double strain_energy() const;
    double kinetic_energy() const;

    /// Restored, bodies go on with the same pairs in the same order: a sort leaves sorted points
    /// alone.
    template <class Archive>
    void serialise(Archive& archive) {
        std::vector<double> numbers;
        if constexpr (!Archive::loading)
            for (const ElasticBody& body : bodies_) {
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
            for (std::size_t k = 0; k < numbers.size(); k += ElasticBody::count)
                bodies_.push_back(ElasticBody::of(&numbers[k]));
            start();
            a = accelerations, deformation_ = deformations, slot_ = slots;
        }
    }

    std::vector<Vec<double, D>> x, v, a;  // [m], [m/s], [m/s^2]
    std::vector<Vec<double, D>> load;     // force of others within a step [N], 2-D: [N/m]
    Vec<double, D> gravity{};

private:
    /// Of the longest stable step.
    static constexpr double courant = 0.7;

    Vec<double, D> room_for(const ElasticBody& body, std::span<const Vec<double, D>> position);
    void sort();
    void correct_gradients();
    double largest_eigenvalue(bool of_damping);
    void limit_timestep();
    void compute(double half_dt);
    void update_point(std::size_t p, const DeformationSums<double, D>& sums);

    template <class Term>
    void sum_over_pairs(const Term& term) {
        for_each_pair<false>(neighbours_, neighbours_.clusters(),
                             std::span<const MotionRecord<double, D>>(motion_),
                             CoordinateFrame<double, D>{}, false, term);
    }
    ElasticRecords<D> records() const { return {motion_, solid_}; }

    std::vector<ElasticBody> bodies_;
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
Vec<double, D> ElasticBodies<D>::room_for(const ElasticBody& body,
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
void ElasticBodies<D>::start() {
    if (size() == 0) return;
    sort();
    a.assign(size(), {}), load.assign(size(), {});
    deformation_.assign(size(), identity<double, D>());
    motion_.resize(size()), solid_.resize(size());
    for (std::size_t p = 0; p < size(); ++p) {
        const ElasticBody& body = body_of(p);
        motion_[p] = {rest_[p].component, v[p].component, mass(p), 1.0 / body.support()};
        const double stiffness = body.hourglass * body.lame.mu,
                     viscosity = body.hourglass * body.viscosity();
        solid_[p] = {rest_[p].component, volume(p), stiffness, viscosity, {}};
    }
    correct_gradients();
    limit_timestep();
    compute(0.0);
}

template <int D>
void ElasticBodies<D>::sort() {
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
    neighbours_.template build<lanes<double>>(rest_, radii, 0.0);
}

/// The records hold places at rest, so the deformation they give is what a gradient makes of none.
template <int D>
void ElasticBodies<D>::correct_gradients() {
    constexpr double least_determinant =
        1e-4;  // 1 inside; 0 where neighbours do not span the space
    correction_.resize(size());
    std::vector<std::uint8_t> flat(size(), 0);
    auto finish = [&](std::size_t p, const DeformationSums<double, D>& sums) {
        const Mat<double, D> c = cofactors(sums.place);
        const double det = determinant(sums.place, c);
        flat[p] = !(det > least_determinant);
        correction_[p] = (1.0 / det) * transposed(c);
    };
    sum_over_pairs(DeformationTerm<D, decltype(finish)>{{records()}, finish});
    for (std::size_t p = 0; p < size(); ++p)
        if (flat[p])
            throw PhysicsFailure("an elastic body is too thin for its spacing of " +
                                     std::to_string(body_of(p).spacing) +
                                     " m: neighbours of a point do not span it",
                                 "empty", -1);
}

/// Of minus the change of acceleration with place, or with velocity, about rest: by power
/// iteration.
template <int D>
double ElasticBodies<D>::largest_eigenvalue(bool of_damping) {
    constexpr int iterations = 60;
    const double amplitude = 1e-6 * bodies_[0].spacing;
    const auto x0 = x, v0 = v;
    double eigenvalue = 0.0;
    std::vector<Vec<double, D>> mode(size());
    for (std::size_t p = 0; p < size(); ++p)  // not orthogonal to whatever is shortest
        for (int k = 0; k < D; ++k)
            mode[p][k] =
                std::sin(1.0 + 7.0 * static_cast<double>(D * p + static_cast<std::size_t>(k)));
    for (int n = 0; n < iterations; ++n) {
        double largest = 0.0;
        for (std::size_t p = 0; p < size(); ++p) {
            if (clamped_[p]) mode[p] = {};
            largest = max(largest, sqrt(dot(mode[p], mode[p])));
        }
        if (largest == 0.0) break;
        double product = 0.0, square = 0.0;
        for (std::size_t p = 0; p < size(); ++p) {
            const Vec<double, D> small = (amplitude / largest) * mode[p];
            x[p] = rest_[p] + (of_damping ? Vec<double, D>{} : small);
            v[p] = mode[p] = small;
            if (!of_damping) v[p] = {};
        }
        compute(0.0);
        for (std::size_t p = 0; p < size(); ++p) {
            product -= dot(mode[p], a[p]), square += dot(mode[p], mode[p]);
            mode[p] = a[p];
        }
        eigenvalue = product / square;
    }
    x = x0, v = v0;
    a.assign(size(), {});
    return eigenvalue;
}

/// Eq. (84). With omega^2 and gamma the eigenvalues of stiffness and damping, Verlet with predicted
/// velocities is stable while omega^2 dt^2/4 + gamma dt < 1.
template <int D>
void ElasticBodies<D>::limit_timestep() {
    const Vec<double, D> pull = gravity;
    gravity = {};
    const double stiffness = largest_eigenvalue(false), damping = largest_eigenvalue(true);
    gravity = pull;
    if (stiffness > 0.0)
        stable_step_ = 2.0 * (std::sqrt(damping * damping + stiffness) - damping) / stiffness;
}

/// Between the sums: strain and stress of one point, as the second sum needs them.
template <int D>
void ElasticBodies<D>::update_point(std::size_t p, const DeformationSums<double, D>& sums) {
    const ElasticBody& body = body_of(p);
    const Mat<double, D>& B = correction_[p];
    deformation_[p] = sums.place * B;
    const Mat<double, D> rate = sums.velocity * B;
    const Mat<double, D> P = stress(p) + kelvin_voigt(deformation_[p], rate, body.viscosity());
    const Mat<double, D> elastic =
        less_springs(P * transposed(B), solid_[p].kappa, deformation_[p]);
    solid_[p].Q = less_springs(elastic, solid_[p].kappa_rate, rate).element;
}

template <int D>
void ElasticBodies<D>::compute(double half_dt) {
    const std::size_t n = size();
#pragma omp parallel for schedule(static) if (n > light_loop)
    for (std::size_t p = 0; p < n; ++p) {
        solid_[p].x = x[p].component;
        motion_[p].v = (v[p] + half_dt * a[p]).component;
    }
    auto update = [this](std::size_t p, const DeformationSums<double, D>& sums) {
        update_point(p, sums);
    };
    sum_over_pairs(DeformationTerm<D, decltype(update)>{{records()}, update});
    auto accelerate = [this](std::size_t p, const Vec<double, D>& force) {
        a[p] = clamped_[p] ? Vec<double, D>{}
                           : (1.0 / body_of(p).rho0) * force + (1.0 / mass(p)) * load[p] + gravity;
    };
    sum_over_pairs(InternalForceTerm<D, decltype(accelerate)>{{records()}, accelerate});
}

template <int D>
double ElasticBodies<D>::drift(double dt) {
    const std::size_t n = size();
    double fastest = 0.0;
#pragma omp parallel for schedule(static) reduction(max : fastest) if (n > light_loop)
    for (std::size_t p = 0; p < n; ++p) {
        x[p] = x[p] + dt * v[p];
        fastest = max(fastest, dot(v[p], v[p]));
    }
    return dt * sqrt(fastest);
}

/// Damping sees the velocities that the last accelerations predict for the middle of the step.
template <int D>
void ElasticBodies<D>::push(double dt) {
    compute(0.5 * dt);
    const std::size_t n = size();
    double sum = 0.0;
#pragma omp parallel for schedule(static) reduction(+ : sum) if (n > light_loop)
    for (std::size_t p = 0; p < n; ++p) {
        v[p] = v[p] + dt * a[p];
        sum += dot(v[p], v[p]);
    }
    if (!std::isfinite(sum))
        throw PhysicsFailure("an elastic body has lost its shape", "not_finite", -1);
}

template <int D>
double ElasticBodies<D>::timestep() const {
    double stiffening = 1.0;
    for (std::size_t p = 0; p < size(); ++p)
        stiffening = max(stiffening, body_of(p).stiffening(deformation_[p]));
    return courant * stable_step_ / stiffening;
}

template <int D>
double ElasticBodies<D>::strain_energy() const {
    double sum = 0.0;
    for (std::size_t p = 0; p < size(); ++p) {
        const ElasticBody& body = body_of(p);
        sum += volume(p) * (body.law == ElasticLaw::neo_hookean
                                ? neo_hookean_energy(deformation_[p], body.lame)
                                : st_venant_kirchhoff_energy(deformation_[p], body.lame));
    }
    return sum;
}

template <int D>
double ElasticBodies<D>::kinetic_energy() const {
    double sum = 0.0;
    for (std::size_t p = 0; p < size(); ++p) sum += 0.5 * mass(p) * dot(v[p], v[p]);
    return sum;
}

}  // namespace doseki
