#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "bodies/contacts.hpp"
#include "elastic/elastic_bodies.hpp"
#include "particles.hpp"

namespace doseki {

/// Elastic bodies among water and other bodies: each of their points is a bound particle, which
/// water meets as a wall, and points of their surfaces touch other bodies.
template <int D>
class DeformableBodies {
public:
    ElasticBodies<D> elastic;

    /// What a particle's `point` is while it belongs to a deformable body: any number below -1.
    static std::int32_t mark(std::size_t point) { return -2 - static_cast<std::int32_t>(point); }
    static std::size_t point_of(std::int32_t mark) { return static_cast<std::size_t>(-2 - mark); }
    static bool is_mark(std::int32_t point) { return point < -1; }

    bool empty() const { return elastic.size() == 0; }

    /// Makes the particles `members`, where they are now, with the velocities and normals that they
    /// have, one body.
    void add(Particles<D>& particles, const ElasticBody& body, std::int32_t material,
             std::span<const std::int32_t> members, std::span<const std::uint8_t> clamped,
             std::span<const std::uint8_t> surface) {
        std::vector<Vec<double, D>> position, velocity;
        for (std::size_t k = 0; k < members.size(); ++k) {
            const auto p = static_cast<std::size_t>(members[k]);
            particles.flow.point[p] = mark(elastic.size() + k);
            position.push_back(particles.position[p]), velocity.push_back(particles.velocity[p]);
            normal_.push_back(particles.flow.normal[p]);
            surface_.push_back(surface[k]);
        }
        elastic.add(body, position, velocity, clamped);
        material_.push_back(material);
    }

    /// `first_body`: number of the first of them among all bodies that touch.
    void start(Particles<D>& particles, const Vec<double, D>& gravity, Contactors<D>& contactors,
               std::int32_t first_body);

    bool has(const Particles<D>& particles, std::size_t p) const {
        return particles.has_flow && particles.is_bound(p) && is_mark(particles.flow.point[p]);
    }
    /// Cauchy stress of a particle, all nine components; in 2-D that along z keeps the strain
    /// plane.
    void stress(const Particles<D>& particles, std::size_t p, double* out) const {
        const std::size_t k = point_of(particles.flow.point[p]);
        const Mat<double, D>& F = elastic.deformation(k);
        const Sym<double, D> sigma = cauchy_stress(elastic.stress(k), F);
        std::fill_n(out, 9, 0.0);
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) out[3 * a + b] = sigma(std::min(a, b), std::max(a, b));
        if constexpr (D == 2) out[8] = elastic.body_of(k).stress_across(F);
    }

    /// See Bodies.
    void gather(const Particles<D>& particles, const Ranks& ranks) {
        if (!ranks.alone()) std::fill(flow_force_.begin(), flow_force_.end(), Vec<double, D>{});
        for_each_point(particles, [&](std::size_t p, std::size_t k) {
            flow_force_[k] = particles.flow.wall_force[p];
        });
        ranks.sum(numbers_of(flow_force_));
    }
    void kick(double half_dt) { elastic.kick(half_dt, flow_force_); }
    void begin_step() { before_ = elastic.v; }
    /// Accelerations as the fluid sees them, averaged over `memory`.
    void end_step(double dt, double memory);
    /// Shows the contacts where the points are, and takes their forces.
    void pose(Contactors<D>& contactors) const;
    void collect(const Contactors<D>& contactors);
    template <class NearestImage>
    double place(Particles<D>& particles, NearestImage&& nearest_image) const;
    void set_velocities(Particles<D>& particles, double ahead) const;

    double fastest() const {
        double square = 0.0;
        for (const auto& v : elastic.v) square = std::max(square, dot(v, v));
        return std::sqrt(square);
    }
    /// How far points may go before contacts are looked for again [m].
    double margin() const {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t p = 0; p < elastic.size(); ++p)
            least = std::min(least, 0.5 * elastic.body_of(p).spacing);
        return least;
    }

    template <class Archive>
    void serialise(Archive& archive) {
        elastic.serialise(archive);
        archive("deformable_normal", normal_), archive("deformable_surface", surface_),
            archive("deformable_material", material_);
        archive("deformable_flow_force", flow_force_),
            archive("deformable_acceleration", acceleration_);
    }
    void restore(Contactors<D>& contactors, std::int32_t first_body) {
        add_contactors(contactors, first_body);
    }

private:
    /// Calls f(particle, point) for the particles of deformable bodies.
    template <class P, class F>
    void for_each_point(P& particles, F&& f) const {
        if (empty()) return;
        const std::size_t n = particles.size();
#pragma omp parallel for schedule(static) if (n > light_loop)
        for (std::size_t p = 0; p < n; ++p)
            if (has(particles, p)) f(p, point_of(particles.flow.point[p]));
    }

    void add_contactors(Contactors<D>& contactors, std::int32_t first_body);

    std::vector<Vec<double, D>> normal_;  // at rest
    std::vector<std::uint8_t> surface_;
    std::vector<std::int32_t> material_;  // by body
    std::vector<Vec<double, D>> flow_force_, acceleration_, before_;
    std::vector<std::size_t> touching_;  // points of the surface
    std::size_t first_contactor_ = 0;
};

template <int D>
void DeformableBodies<D>::start(Particles<D>& particles, const Vec<double, D>& gravity,
                                Contactors<D>& contactors, std::int32_t first_body) {
    if (empty()) return;
    elastic.gravity = gravity;
    elastic.start();
    auto sorted = [this](const auto& by_number) {
        auto result = by_number;
        for (std::size_t k = 0; k < by_number.size(); ++k) result[elastic.slot(k)] = by_number[k];
        return result;
    };
    normal_ = sorted(normal_), surface_ = sorted(surface_);
    flow_force_.assign(elastic.size(), {}), acceleration_.assign(elastic.size(), {});
    for (std::size_t p = 0; p < particles.size(); ++p)
        if (is_mark(particles.flow.point[p]))
            particles.flow.point[p] = mark(elastic.slot(point_of(particles.flow.point[p])));
    add_contactors(contactors, first_body);
}

template <int D>
void DeformableBodies<D>::add_contactors(Contactors<D>& contactors, std::int32_t first_body) {
    first_contactor_ = contactors.size_of_all();
    touching_.clear();
    for (std::size_t k = 0; k < elastic.size(); ++k) {
        if (!surface_[k]) continue;
        const double radius = 0.5 * elastic.body_of(k).spacing;
        contactors.add(first_body + elastic.body(k),
                       material_[static_cast<std::size_t>(elastic.body(k))], radius,
                       elastic.mass(k), 2.0 * radius, elastic.clamped(k), true);
        touching_.push_back(k);
    }
}

template <int D>
void DeformableBodies<D>::end_step(double dt, double memory) {
    const double share = std::min(1.0, dt / memory);
    for (std::size_t k = 0; k < elastic.size(); ++k) {
        if (elastic.clamped(k)) continue;
        const Vec<double, D> mean =
            (1.0 / dt) * (elastic.v[k] - before_[k]) + (1.0 / elastic.mass(k)) * flow_force_[k];
        acceleration_[k] = acceleration_[k] + share * (mean - acceleration_[k]);
    }
}

template <int D>
void DeformableBodies<D>::pose(Contactors<D>& contactors) const {
    for (std::size_t t = 0; t < touching_.size(); ++t) {
        const std::size_t c = first_contactor_ + t;
        contactors.position[c] = elastic.x[touching_[t]],
        contactors.velocity[c] = elastic.v[touching_[t]];
        contactors.force[c] = {}, contactors.torque[c] = {};
    }
}

template <int D>
void DeformableBodies<D>::collect(const Contactors<D>& contactors) {
    for (std::size_t t = 0; t < touching_.size(); ++t)
        elastic.load[touching_[t]] = contactors.force[first_contactor_ + t];
}

/// Normals turn as surfaces do, with F^-T.
template <int D>
template <class NearestImage>
double DeformableBodies<D>::place(Particles<D>& particles, NearestImage&& nearest_image) const {
    std::vector<double> gone(particles.size(), 0.0);
    for_each_point(particles, [&](std::size_t p, std::size_t k) {
        const Vec<double, D> step = nearest_image(elastic.x[k] - particles.position[p]);
        gone[p] = dot(step, step);
        particles.position[p] = particles.position[p] + step;
        const Vec<double, D> n = cofactors(elastic.deformation(k)) * normal_[k];
        const double length = std::sqrt(dot(n, n));
        particles.flow.normal[p] = length > 0.0 ? (1.0 / length) * n : n;
        particles.acceleration[p] = acceleration_[k];
    });
    return gone.empty() ? 0.0 : std::sqrt(*std::max_element(gone.begin(), gone.end()));
}

template <int D>
void DeformableBodies<D>::set_velocities(Particles<D>& particles, double ahead) const {
    for_each_point(particles, [&](std::size_t p, std::size_t k) {
        particles.velocity[p] = elastic.clamped(k)
                                    ? Vec<double, D>{}
                                    : elastic.v[k] + (ahead / elastic.mass(k)) * flow_force_[k];
    });
}

}  // namespace doseki
