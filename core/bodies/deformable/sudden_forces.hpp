#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "bodies/elastic/total_lagrangian.hpp"

namespace doseki {

/// What the fluid does to deformable bodies beyond the mean, in shapes in which they swing within
/// few steps: Eq. (173). As kicks these forces would ring the bodies, so that they act through a
/// step.
///
/// Kicks are left with a = (1 + dt^2/8 M^-1 K)^-1 F/m, which moves a body as a whole and in slow
/// vibrations, found by conjugate gradients for each body by itself. K is the stiffness of bodies
/// as they are strained, from differences of internal forces.
template <int D>
class SuddenForces {
public:
    SuddenForces(TotalLagrangian<D>& solids, std::span<const Vec<double, D>> force)
        : solids_(solids), force_(force), bodies_(solids.bodies()) {}

    /// Sets those of the points of bodies that take several steps of their own in one of `dt`.
    void split(double dt, std::span<Vec<double, D>> sudden) {
        std::fill(sudden.begin(), sudden.end(), Vec<double, D>{});
        if (!(dt > solids_.timestep())) return;
        begin();
        if (is_solved()) return;
        solve(dt);
        each([&](std::size_t k, std::uint32_t p, const Body& body) {
            if (body.change > 0.0) sudden[p] = solids_.mass(p) * (change(p) - answer_[k]);
        });
    }

private:
    static constexpr double steady = 0.05;    // of the mean; less than that may kick
    static constexpr double residual = 0.03;  // of the change
    static constexpr int iterations = 200;

    /// Of one body. Squares are weighted by mass.
    struct Body {
        double mean = 0.0, change = 0.0;  // squares of the mean force and of what is beyond it
        double left = 0.0, before = 0.0;  // of the residual, now and before
        double product = 0.0;             // of the search and its image
        double longest = 0.0;             // of the search
        double farthest = 0.0;            // from the origin [m]
        bool is_solved = false;
    };

    /// Calls f(k, p, body) for the k-th stepped point, p.
    template <class F>
    void each(const F& f) {
        const Array<std::uint32_t>& points = solids_.stepped().points();
        for (std::size_t k = 0; k < points.size(); ++k)
            f(k, points[k], bodies_[static_cast<std::size_t>(solids_.body(points[k]))]);
    }
    template <class F>
    void each_unsolved(const F& f) {
        each([&f](std::size_t k, std::uint32_t p, Body& body) {
            if (!body.is_solved) f(k, p, body);
        });
    }
    Vec<double, D> change(std::uint32_t p) const {
        if (solids_.clamped(p)) return {};
        return (1.0 / solids_.mass(p)) * (force_[p] - solids_.steady[p]);
    }
    double square(std::uint32_t p, const Vec<double, D>& a) const {
        return solids_.mass(p) * dot(a, a);
    }
    bool is_solved() const {
        return std::ranges::all_of(bodies_, [](const Body& body) { return body.is_solved; });
    }

    void begin() {
        const std::size_t n = solids_.stepped().points().size();
        answer_.assign(n, {}), left_.assign(n, {});
        each([&](std::size_t k, std::uint32_t p, Body& body) {
            left_[k] = change(p);
            body.change += square(p, left_[k]);
            if (!solids_.clamped(p))
                body.mean += dot(solids_.steady[p], solids_.steady[p]) / solids_.mass(p);
            body.farthest = std::max(body.farthest, norm(solids_.x[p]));
        });
        search_ = left_;
        for (Body& body : bodies_) {
            body.left = body.change;
            body.is_solved = !(body.change > steady * steady * body.mean);
            if (body.is_solved) body.change = 0.0;
        }
    }

    void solve(double dt) {
        const std::size_t n = solids_.stepped().points().size();
        x_.resize(n), v_.resize(n), image_.resize(n), at_rest_.resize(n);
        accelerations_.resize(solids_.size());
        each([&](std::size_t k, std::uint32_t p, const Body&) {
            x_[k] = solids_.x[p], v_[k] = solids_.v[p], solids_.v[p] = {};
        });
        solids_.internal_accelerations(accelerations_);
        each([&](std::size_t k, std::uint32_t p, const Body&) { at_rest_[k] = accelerations_[p]; });
        for (int i = 0; i < iterations && !is_solved(); ++i) apply(0.125 * dt * dt), advance();
        each([&](std::size_t k, std::uint32_t p, const Body&) {
            solids_.x[p] = x_[k], solids_.v[p] = v_[k];
        });
        solids_.internal_accelerations(accelerations_);
    }

    /// Of displacements [m]: small for strain, and large for the rounding of coordinates.
    static double amplitude(double spacing, double farthest) {
        constexpr double small = 1e-4, large = 1e-3, digits = 1e7;
        const double rounding = std::numeric_limits<double>::epsilon() * farthest;
        return std::clamp(digits * rounding, small * spacing, large * spacing);
    }

    /// Finds the image of the search.
    void apply(double factor) {
        for (Body& body : bodies_) body.longest = body.product = 0.0;
        each([&](std::size_t k, std::uint32_t, Body& body) {
            body.longest = std::max(body.longest, norm(search_[k]));
        });
        auto scale = [&](std::uint32_t p, const Body& body) {
            return amplitude(solids_.body_of(p).spacing, body.farthest) / body.longest;
        };
        each([&](std::size_t k, std::uint32_t p, const Body& body) {
            solids_.x[p] = x_[k];
            if (!body.is_solved) solids_.x[p] = x_[k] + scale(p, body) * search_[k];
        });
        solids_.internal_accelerations(accelerations_);
        each_unsolved([&](std::size_t k, std::uint32_t p, Body& body) {
            const Vec<double, D> stiffness = accelerations_[p] - at_rest_[k];
            image_[k] = search_[k] - (factor / scale(p, body)) * stiffness;
            body.product += solids_.mass(p) * dot(search_[k], image_[k]);
        });
    }

    void advance() {
        for (Body& body : bodies_) {
            body.is_solved |= !(body.product > 0.0);
            if (!body.is_solved) body.before = body.left, body.left = 0.0;
        }
        each_unsolved([&](std::size_t k, std::uint32_t p, Body& body) {
            const double step = body.before / body.product;
            answer_[k] = answer_[k] + step * search_[k], left_[k] = left_[k] - step * image_[k];
            body.left += square(p, left_[k]);
        });
        each_unsolved([&](std::size_t k, std::uint32_t, const Body& body) {
            search_[k] = left_[k] + (body.left / body.before) * search_[k];
        });
        for (Body& body : bodies_)
            body.is_solved |= !(body.left > residual * residual * body.change);
    }

    TotalLagrangian<D>& solids_;
    std::span<const Vec<double, D>> force_;
    Array<Body> bodies_;
    Array<Vec<double, D>> x_, v_;                                     // before displacements
    Array<Vec<double, D>> answer_, left_, search_, image_, at_rest_;  // [m/s^2]
    Array<Vec<double, D>> accelerations_;                             // of all points
};

}  // namespace doseki
