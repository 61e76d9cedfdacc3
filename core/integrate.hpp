#pragma once
#include "base/parallel.hpp"
#include "particles.hpp"

namespace doseki {

/// Half a step of everything that has a rate (kick-drift-kick leap-frog).
template <int D>
void kick(Particles<D>& particles, double half_dt) {
    const std::size_t n = particles.size();
#pragma omp parallel for schedule(static) if (n > light_loop)
    for (std::size_t p = 0; p < n; ++p) {
        if (particles.is_bound(p)) continue;
        for (int a = 0; a < D; ++a)
            particles.velocity[p][a] += half_dt * particles.acceleration[p][a];
        particles.density[p] += half_dt * particles.density_rate[p];
        if (particles.has_strength)
            add_scaled(particles.deviatoric_stress[p], half_dt,
                       particles.deviatoric_stress_rate[p]);
    }
}

/// A whole step of positions. Returns the largest distance that any particle went.
template <int D>
double drift(Particles<D>& particles, double dt) {
    const std::size_t n = particles.size();
    double fastest = 0.0;
#pragma omp parallel for schedule(static) reduction(max : fastest) if (n > light_loop)
    for (std::size_t p = 0; p < n; ++p) {
        // A fixed particle may have a velocity, as a belt has: it acts on others, nothing moves.
        if (particles.is_wall(p)) continue;
        Vec<double, D> v = particles.velocity[p];
        if (particles.has_flow) v = v + particles.flow.shift[p];
        for (int a = 0; a < D; ++a) particles.position[p][a] += dt * v[a];
        fastest = max(fastest, dot(v, v));
    }
    return dt * sqrt(fastest);
}

}  // namespace doseki
