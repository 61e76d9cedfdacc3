#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "fault.hpp"
#include "halo.hpp"
#include "material.hpp"
#include "neighbours.hpp"
#include "options.hpp"
#include "particles.hpp"
#include "phase_timer.hpp"
#include "physics/equation_of_state.hpp"
#include "physics/free_surface.hpp"
#include "poison.hpp"
#include "resolved/flow_depth.hpp"
#include "resolved/flow_terms.hpp"

namespace doseki {

/// The right-hand side of the resolved scheme: fluid among walls, in one pass over the pairs of
/// fluid particles and one over those of walls. Gradients, and the measure of the free surface, are
/// those of the step before where a pair needs them; a timestep is short against what they
/// describe.
template <int D>
class FlowRates {
public:
    using Real = double;
    static constexpr int dim = D;

    FlowRates(std::vector<Material> materials, const Options<D>& options, bool periodic)
        : materials_(std::move(materials)), options_(options), periodic_(periodic) {
        for (const Material& material : materials_) {
            if (material.law == Law::fluid) constants_.c = std::max(constants_.c, material.c0);
            constants_.harmonic |= material.rheology == Rheology::herschel_bulkley;
        }
        constants_.dp = options.flow.dp;
        for (int k = 1; k <= D; ++k) spacing_power_[k] = spacing_power_[k - 1] * options.flow.dp;
        const double support = kernel_support() * options.eta * options.flow.dp;
        const auto lattice = options.flow.wide_kernel
                                 ? lattice_sums<WendlandC6<D>, D>(options.flow.dp, support)
                                 : lattice_sums<WendlandC2<D>, D>(options.flow.dp, support);
        lattice_concentration_ = lattice.concentration;
        constants_.gradient_scale = 1.0 / lattice.moment;
        constants_.form = options.flow.monaghan_cleary ? ViscousForm<double>{0.0, D + 2.0}
                                                       : ViscousForm<double>{1.0, 0.0};
    }

    static constexpr bool has_flow = true;
    double kernel_support() const {
        return options_.flow.wide_kernel ? WendlandC6<D>::support : WendlandC2<D>::support;
    }

    /// See Rates::compute.
    void compute(Particles<D>& particles, const Neighbours<D>& neighbours, Halo<D>& halo,
                 double half_dt, bool new_lists) {
        fluid_count_ = neighbours.moving();
        const bool poisoned = is_poisoned_run();
        if (new_lists && options_.flow.turbulence == Turbulence::mixing_length)
            set_mixing_lengths(particles, column_width(neighbours), halo.ranks);
        pack(particles, halo, half_dt, poisoned);
        if (options_.flow.wide_kernel)
            sum_all<WendlandC6<D>>(particles, neighbours, halo);
        else
            sum_all<WendlandC2<D>>(particles, neighbours, halo);
        reduce_summaries(halo.ranks);
        const std::int64_t left = poisoned ? survivor<double>(particles.acceleration) : -1;
        if (left >= 0) fault_.note(Fault::rates, static_cast<std::size_t>(left));
        fault_ = traced_to_its_source(fault_, particles, materials_);
        agree(halo.ranks, timestep_, limiting_, fault_);
    }

    double timestep() const { return timestep_; }
    double av_power() const { return power_; }
    PhaseTimer& phases() { return phases_; }
    const Fault& fault() const { return fault_; }
    std::int64_t limiting_particle() const { return limiting_; }
    const std::vector<Material>& materials() const { return materials_; }
    Deviator<double, D> deviator(const Particles<D>&, std::size_t) const { return {}; }

    /// Pressure and energy of a particle; of a wall particle, those of the fluid at its place.
    Thermodynamics thermodynamics(const Particles<D>& particles, std::size_t p) const {
        const Material& material = materials_[particles.tag[p].material];
        if (particles.is_wall(p)) return {particles.flow.wall_pressure[p], constants_.c, 0.0};
        const double rho = particles.density[p], e = rho / material.rho0;
        const bool linear = options_.flow.pressure_law == PressureLaw::linear;
        const double energy = linear ? std::log(e) + 1.0 / e - 1.0
                                     : (std::pow(e, 6.0) / 6.0 + 1.0 / e - 7.0 / 6.0) / 7.0;
        return {pressure(material, rho, particles.flow.surface[p]), material.c0,
                material.c0 * material.c0 * energy};
    }

    template <class Archive>
    void serialise(Archive& archive) {
        archive("next_timestep", timestep_), archive("av_power", power_),
            archive("liveliness", liveliness_), archive("strain", strain_);
    }

    std::size_t bytes() const {
        return motion_.capacity() * sizeof(MotionRecord<double, D>) +
               fluid_.capacity() * sizeof(FluidRecord<D>) +
               wall_.capacity() * sizeof(WallRecord<D>) +
               summary_.capacity() * sizeof(ClusterSummary);
    }

private:
    template <class, class>
    friend class PairCounter;

    struct ClusterSummary {
        double timestep = std::numeric_limits<double>::max();
        double power = 0.0, strain = 0.0;
        Fault fault;
        std::int64_t limiting = -1;
    };

    /// Tension holds inside; a free surface takes none.
    double pressure(const Material& material, double rho, double surface) const {
        const double stiffness = material.rho0 * material.c0 * material.c0, e = rho / material.rho0;
        const double p = options_.flow.pressure_law == PressureLaw::linear
                             ? stiffness * (e - 1.0)
                             : stiffness / 7.0 * (std::pow(e, 7.0) - 1.0);
        return surface > SurfaceMeasure::surface ? std::max(0.0, p) : p;
    }

    /// About four spacings, such that whole columns fill a period.
    Vec<double, D - 1> column_width(const Neighbours<D>& neighbours) const {
        Vec<double, D - 1> width;
        for (int a = 0; a < D - 1; ++a) {
            double period = 0.0;
            for (const auto& shift : neighbours.image_shifts()) period = std::max(period, shift[a]);
            const double columns = std::max(1.0, std::floor(period / (4.0 * options_.flow.dp)));
            width[a] = period > 0.0 ? period / columns : 4.0 * options_.flow.dp;
        }
        return width;
    }

    void set_mixing_lengths(Particles<D>& particles, const Vec<double, D - 1>& width,
                            const Ranks& ranks) {
        const double least = options_.flow.smagorinsky * options_.flow.dp;
        const FlowDepth<D> depth(particles, fluid_count_, width, ranks);
        for (std::size_t p = 0; p < fluid_count_; ++p)
            particles.flow.mixing_length[p] = depth.mixing_length(particles.position[p], least);
    }

    /// Time, in h/c, in which the density that follows from motion is drawn to that of the
    /// arrangement of particles: what continuity sums up over many steps forgets how far apart they
    /// are.
    static constexpr double relaxation = 100.0, relaxation_at_rest = 1000.0;
    /// Of rho0. What tears apart leaves a void, not water under tension.
    static constexpr double least_density = 0.98;
    /// Over the sound speed: half of the fastest flow. A gap that bodies close would shift
    /// particles out of the world.
    static constexpr double largest_shift = 0.05;
    /// Root mean square of |L| h/c below which a fluid counts as at rest.
    static constexpr double at_rest = 5e-4;

    /// Of the liquid itself [Pa s].
    static double molecular_viscosity(const Material& material, const Mat<double, D>& L, double rho,
                                      double mean_pressure) {
        if (material.rheology == Rheology::herschel_bulkley)
            return material.herschel_bulkley.viscosity(strain_rate(L));
        if (material.rheology == Rheology::mu_i)
            return material.mu_i.viscosity(strain_rate(L), mean_pressure);
        return rho * material.nu;
    }

    double eddy_viscosity(const Particles<D>& particles, std::size_t p) const {
        if (options_.flow.turbulence == Turbulence::none) return 0.0;
        const bool mixing = options_.flow.turbulence == Turbulence::mixing_length;
        const double l =
            mixing ? particles.flow.mixing_length[p] : options_.flow.smagorinsky * options_.flow.dp;
        return l * l * strain_rate(particles.flow.velocity_gradient[p]);
    }

    /// Sound that runs to and fro is no load on a contact between grains: friction takes the mean
    /// over the relaxation time of the density. What never had a pressure takes the first it gets.
    void update_mean_pressure(Particles<D>& particles, std::size_t p, double dt) {
        double& mean = particles.flow.mean_pressure[p];
        const double share = dt * constants_.c / (relaxation * particles.smoothing_length[p]);
        mean = mean == 0.0 ? fluid_[p].p : mean + std::min(share, 1.0) * (fluid_[p].p - mean);
    }

    void pack(Particles<D>& particles, const Halo<D>& halo, double half_dt, bool poisoned);
    void pack_fluid(Particles<D>& particles, std::size_t p, double half_dt);
    void pack_wall(const Particles<D>& particles, std::size_t p);

    template <class Kernel>
    void sum_all(Particles<D>& particles, const Neighbours<D>& neighbours, Halo<D>& halo);
    template <class Kernel>
    void sum_walls(Particles<D>& particles, const Neighbours<D>& neighbours,
                   const FlowRecords<D>& records);
    template <class Kernel>
    void sum_fluid(Particles<D>& particles, const Neighbours<D>& neighbours, Halo<D>& halo,
                   const FlowRecords<D>& records);

    void finish_wall(Particles<D>& particles, std::size_t p, const WallSums<double, D>& sums);
    void finish_fluid(Particles<D>& particles, std::size_t p, const FluidSums<double, D>& sums,
                      bool shifted);
    void limit_timestep(const Particles<D>& particles, std::size_t p);
    void reduce_summaries(const Ranks& ranks);
    bool has_rough_walls() const {
        return std::any_of(options_.flow.walls.begin(), options_.flow.walls.end(),
                           [](const WallCondition& wall) { return wall.ks > 0.0; });
    }

    template <class Term>
    void sum_over_pairs(const Neighbours<D>& neighbours, std::span<const ClusterList> clusters,
                        std::size_t first, const Term& term) {
        const std::span<const MotionRecord<double, D>> records(motion_);
        if (periodic_)
            for_each_pair<true>(neighbours, clusters, records, frame_, false, term, first);
        else
            for_each_pair<false>(neighbours, clusters, records, frame_, false, term, first);
    }

    std::vector<Material> materials_;
    Options<D> options_;
    bool periodic_;
    FlowConstants constants_{};
    double lattice_concentration_ = 1.0;
    std::array<double, D + 1> spacing_power_{1.0};  // dp^k
    CoordinateFrame<double, D> frame_;
    std::vector<MotionRecord<double, D>> motion_;
    std::vector<FluidRecord<D>> fluid_;
    std::vector<WallRecord<D>> wall_;
    std::vector<ClusterSummary> summary_;
    PhaseTimer phases_;
    std::size_t fluid_count_ = 0;
    double timestep_ = 0.0, power_ = 0.0;
    double strain_ = 0.0;      // root mean square of |L| [1/s]
    double liveliness_ = 0.0;  // 0: fluid at rest, whose momentum pairs conserve; 1: flow
    Fault fault_;
    std::int64_t limiting_ = -1;
};

template <int D>
void FlowRates<D>::pack_fluid(Particles<D>& particles, std::size_t p, double half_dt) {
    FluidRecord<D>& record = fluid_[p];
    const Material& material = materials_[particles.tag[p].material];
    const double rho = particles.density[p] + half_dt * particles.density_rate[p];
    record.rho = rho;
    record.volume = particles.mass[p] / rho, record.rest_volume = particles.mass[p] / material.rho0;
    record.surface = particles.flow.surface[p];
    record.p = pressure(material, rho, record.surface);
    update_mean_pressure(particles, p, 2.0 * half_dt);
    record.mu = molecular_viscosity(material, particles.flow.velocity_gradient[p], rho,
                                    particles.flow.mean_pressure[p]) +
                rho * eddy_viscosity(particles, p);
    for (int a = 0; a < D; ++a)
        for (int b = a; b < D; ++b) {
            const Mat<double, D>& L = particles.flow.velocity_gradient[p];
            record.strain[Sym<double, D>::index(a, b)] = 0.5 * (L(a, b) + L(b, a));
        }
    record.pressure_gradient = particles.flow.pressure_gradient[p].component;
}

template <int D>
void FlowRates<D>::pack_wall(const Particles<D>& particles, std::size_t p) {
    WallRecord<D>& record = wall_[p - fluid_count_];
    const Vec<double, D>& normal = particles.flow.normal[p];
    record.normal = normal.component;
    record.traction = {};
    record.volume =
        particles.is_bound(p) ? particles.mass[p] / particles.density[p] : spacing_power_[D];
    record.depth = particles.flow.wall_depth[p];
    record.g_normal = std::max(0.0, dot(particles.acceleration[p] - options_.gravity, normal));
    record.stick =
        options_.flow.walls.at(static_cast<std::size_t>(particles.tag[p].body)).stick ? 1.0 : 0.0;
}

template <int D>
void FlowRates<D>::pack(Particles<D>& particles, const Halo<D>& halo, double half_dt,
                        bool poisoned) {
    const auto timing = phases_.measure(Phase::pack);
    const std::size_t n = particles.size(), ghosts = halo.ghosts(), moving = halo.moving_ghosts();
    motion_.resize(n + ghosts), wall_.resize(n - fluid_count_ + ghosts);
    fluid_.resize(moving > 0 ? n + moving : fluid_count_);
    summary_.assign((n + lanes<double> - 1) / lanes<double>, {});
    if (poisoned) poison<double>(motion_), poison<double>(fluid_), poison<double>(wall_);
#pragma omp parallel for schedule(static) if (n > light_loop)
    for (std::size_t p = 0; p < n; ++p) {
        MotionRecord<double, D>& record = motion_[p];
        const bool wall = p >= fluid_count_;
        record.x = particles.position[p].component;
        for (int a = 0; a < D; ++a)
            record.v[a] =
                particles.velocity[p][a] + (wall ? 0.0 : half_dt * particles.acceleration[p][a]);
        record.mass = particles.mass[p];
        record.inverse_support = 1.0 / (kernel_support() * particles.smoothing_length[p]);
        if (wall)
            pack_wall(particles, p);
        else
            pack_fluid(particles, p, half_dt);
    }
}

/// On many ranks the fluid's pairs are summed while records of ghosts, or the friction of their
/// beds, come.
template <int D>
template <class Kernel>
void FlowRates<D>::sum_all(Particles<D>& particles, const Neighbours<D>& neighbours,
                           Halo<D>& halo) {
    const bool rough = has_rough_walls();
    const std::size_t first_ghost_wall = fluid_count_;
    halo.start({halo_column(motion_), halo_column(fluid_, HaloColumn::moving),
                halo_column(wall_, HaloColumn::fixed, first_ghost_wall)});
    const auto count = static_cast<std::uint32_t>(particles.size()),
               fluid_count = static_cast<std::uint32_t>(fluid_count_);
    const double inverse_support =
        1.0 / (kernel_support() * (count > 0 ? particles.smoothing_length[0] : 1.0));
    const FlowRecords<D> records{motion_, fluid_, wall_, fluid_count, count, inverse_support};
    const bool has_fluid = fluid_count + halo.moving_ghosts() > 0,
               has_walls = count > fluid_count && has_fluid;
    if (!has_fluid)
        std::fill(particles.flow.wall_force.begin(), particles.flow.wall_force.end(),
                  Vec<double, D>{});
    if (rough || halo.alone()) {
        halo.finish();
        if (has_walls) sum_walls<Kernel>(particles, neighbours, records);
        if (rough)
            halo.start({halo_column(wall_, &WallRecord<D>::traction, HaloColumn::fixed,
                                    first_ghost_wall)});
        sum_fluid<Kernel>(particles, neighbours, halo, records);
    } else {
        sum_fluid<Kernel>(particles, neighbours, halo, records);
        if (has_walls) sum_walls<Kernel>(particles, neighbours, records);
    }
}

template <int D>
template <class Kernel>
void FlowRates<D>::sum_walls(Particles<D>& particles, const Neighbours<D>& neighbours,
                             const FlowRecords<D>& records) {
    const auto timing = phases_.measure(Phase::pass_1);
    const std::size_t first = fluid_count_ / lanes<double>;
    auto finish = [&](std::size_t p, const WallSums<double, D>& sums) {
        finish_wall(particles, p, sums);
    };
    sum_over_pairs(neighbours, neighbours.clusters().subspan(first), first,
                   WallTerm<Kernel, D, decltype(finish)>{records, constants_, finish});
}

template <int D>
template <class Kernel>
void FlowRates<D>::sum_fluid(Particles<D>& particles, const Neighbours<D>& neighbours,
                             Halo<D>& halo, const FlowRecords<D>& records) {
    constexpr std::size_t width = lanes<double>;
    auto finish = [&](std::size_t p, const FluidSums<double, D>& sums) {
        finish_fluid(particles, p, sums, options_.flow.shifting);
    };
    const FluidTerm<Kernel, D, decltype(finish)> term{records, constants_, finish};
    const auto clusters = neighbours.clusters().first((fluid_count_ + width - 1) / width);
    while_ghosts_come(halo, neighbours, clusters, width,
                      [&](std::span<const ClusterList> part, std::size_t first) {
                          const auto timing = phases_.measure(Phase::pass_2);
                          sum_over_pairs(neighbours, part, first, term);
                      });
}

/// Force, pressure and, on a rough bed, the friction of one wall particle.
template <int D>
void FlowRates<D>::finish_wall(Particles<D>& particles, std::size_t p,
                               const WallSums<double, D>& sums) {
    constexpr double least_filled = 0.05;  // of the kernel, by fluid
    WallRecord<D>& record = wall_[p - fluid_count_];
    Vec<double, D> force = sums.force;
    particles.flow.wall_pressure[p] = sums.weight > 0.0 ? sums.pressure / sums.weight : 0.0;
    const WallCondition& wall =
        options_.flow.walls[static_cast<std::size_t>(particles.tag[p].body)];
    const double dp = options_.flow.dp;
    if (wall.ks > 0.0 && record.depth < dp && sums.weight > least_filled) {
        const Vec<double, D> u = (1.0 / sums.weight) * sums.velocity - particles.velocity[p];
        const Vec<double, D> along = tangential(u, particles.flow.normal[p]);
        const double rho = sums.density / sums.weight;
        const double friction =
            bed_friction(rho, sums.height / sums.weight, wall.ks) * spacing_power_[D - 1];
        const Vec<double, D> drag = friction * std::sqrt(dot(along, along)) * along;
        record.traction = ((-1.0 / sums.weight) * drag).component;
        force = force + drag;
    }
    particles.flow.wall_force[p] = force;
}

/// Rates and gradients of one fluid particle from its sums.
template <int D>
void FlowRates<D>::finish_fluid(Particles<D>& particles, std::size_t p,
                                const FluidSums<double, D>& sums, bool shifted) {
    const Mat<double, D> B = inverse_moment(sums.moment);
    auto corrected = [&B](const Vec<double, D>& raw) {
        Vec<double, D> v;
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) v[a] += B(a, b) * raw[b];
        return v;
    };
    auto& flow = particles.flow;
    flow.pressure_gradient[p] = corrected(sums.pressure_gradient);
    Mat<double, D>& L = flow.velocity_gradient[p];
    for (int a = 0; a < D; ++a) {
        Vec<double, D> row;
        for (int b = 0; b < D; ++b) row[b] = sums.velocity_gradient(a, b);
        row = corrected(row);
        for (int b = 0; b < D; ++b) L(a, b) = row[b];
    }
    const double slope = std::sqrt(dot(sums.concentration_gradient, sums.concentration_gradient));
    const double h = particles.smoothing_length[p];
    const auto measure =
        SurfaceMeasure::of((sums.concentration + sums.wall_share) / lattice_concentration_,
                           kernel_support() * h * slope, options_.flow.wide_kernel);
    flow.surface[p] = measure.x;
    flow.shift[p] = {};
    summary_[p / lanes<double>].fault.note_density(fluid_[p].rho,
                                                   materials_[particles.tag[p].material].rho0, p);
    if (!particles.is_free(p)) {
        particles.acceleration[p] = {}, particles.density_rate[p] = 0.0;
        return;
    }
    const FluidRecord<D>& record = fluid_[p];
    const double rho = record.rho, rho0 = materials_[particles.tag[p].material].rho0;
    Vec<double, D> a = (1.0 / rho) * (2.0 * sums.force + sums.traction) + options_.gravity;
    a = a - options_.attraction * options_.attraction * particles.position[p];
    double rate = rho * sums.density_rate;
    double norm = 0.0;
    for (double element : L.element) norm += element * element;
    summary_[p / lanes<double>].strain += norm;
    // Away from walls and surface the mean pressure does nothing, and gradients need not be those
    // of pairs; what disorder makes of either is noise.
    if (sums.wall_share == 0.0 && sums.largest_surface < SurfaceMeasure::surface) {
        const Vec<double, D> noise = sums.pressure_gradient - flow.pressure_gradient[p];
        a = a + (liveliness_ / rho) * (2.0 * record.p * sums.concentration_gradient + noise);
        rate += liveliness_ * rho * (trace(sums.velocity_gradient) - trace(L));
    }
    if (shifted && measure.x < SurfaceMeasure::surface) {
        Vec<double, D> shift =
            shifting_velocity(sums.concentration_gradient, std::max(std::sqrt(norm), strain_), h);
        if (sums.largest_surface > SurfaceMeasure::surface)
            shift = tangential(shift, sums.surface_gradient);
        const double fastest = largest_shift * constants_.c, speed = std::sqrt(dot(shift, shift));
        if (speed > fastest) shift = (fastest / speed) * shift;
        flow.shift[p] = shift;
        for (int k = 0; k < D; ++k)
            for (int l = 0; l < D; ++l) a[k] += L(k, l) * shift[l];
        rate += dot(flow.pressure_gradient[p], shift) / (constants_.c * constants_.c);
    }
    const double memory =
        (relaxation + (1.0 - liveliness_) * (relaxation_at_rest - relaxation)) * h / constants_.c;
    rate += (measure.filling * rho0 - rho) / memory;
    if (rho < least_density * rho0) rate = std::max(0.0, rate);
    particles.acceleration[p] = a;
    particles.density_rate[p] = rate;
    summary_[p / lanes<double>].power += record.volume * sums.power;
    limit_timestep(particles, p);
}

/// dt = min(C_CFL h/(c + |v|), C_f sqrt(h/|a|), h^2/(8 nu)).
template <int D>
void FlowRates<D>::limit_timestep(const Particles<D>& particles, std::size_t p) {
    const double h = particles.smoothing_length[p];
    const Vec<double, D>&a = particles.acceleration[p], &v = particles.velocity[p];
    const double acoustic = options_.cflnumber * h / (constants_.c + std::sqrt(dot(v, v)));
    const double forced =
        options_.cfl_force * std::sqrt(h / std::max(std::sqrt(dot(a, a)), 1e-300));
    const double viscous = 0.125 * h * h * fluid_[p].rho / std::max(fluid_[p].mu, 1e-300);
    const double dt = std::min({acoustic, forced, viscous});
    ClusterSummary& summary = summary_[p / lanes<double>];
    if (dt < summary.timestep)
        summary.timestep = dt, summary.limiting = static_cast<std::int64_t>(p);
    summary.fault.note_rates(dot(a, a) + particles.density_rate[p], p);
}

template <int D>
void FlowRates<D>::reduce_summaries(const Ranks& ranks) {
    // What enters next may be the first fluid there is.
    timestep_ = options_.cflnumber * options_.eta * options_.flow.dp / constants_.c;
    power_ = 0.0;
    fault_ = {}, limiting_ = -1;
    std::array<double, 2> total{0.0, static_cast<double>(fluid_count_)};  // of |L|^2, of particles
    for (const ClusterSummary& summary : summary_) {
        if (summary.timestep < timestep_)
            timestep_ = summary.timestep, limiting_ = summary.limiting;
        power_ += summary.power;
        total[0] += summary.strain;
        fault_.merge(summary.fault);
    }
    ranks.sum(total);
    if (total[1] > 0.0) {
        const double h = options_.eta * options_.flow.dp, rms = std::sqrt(total[0] / total[1]);
        strain_ = rms, liveliness_ = std::clamp(h * rms / (at_rest * constants_.c) - 1.0, 0.0, 1.0);
    }
}

}  // namespace doseki
