#pragma once
// The sums of deformable bodies: on the threads of the processor or, where no bonds break, where
// the points are.

#include "base/bulk.hpp"
#include "bodies/elastic/total_lagrangian.hpp"
#include "device/backend_of_build.hpp"

namespace doseki {

/// Where loops run: on the threads of the processor,
struct OnThreads {
    using Backend = BackendOfBuild<double>;

    template <class F>
    static void for_each(std::size_t count, const F& f) {
        for_each_particle(count, f);
    }
    template <class... Arguments>
    static void sum_pairs(const Arguments&... arguments) {
        Backend::sum_pairs_on_threads(arguments...);
    }
};
/// or where all particles are.
struct WhereParticlesAre {
    using Backend = BackendOfBuild<double>;

    template <class F>
    static void for_each(std::size_t count, const F& f) {
        bulk::for_each(count, f);
    }
    template <class... Arguments>
    static void sum_pairs(const Arguments&... arguments) {
        Backend::sum_pairs(arguments...);
    }
};

template <int D>
struct PredictPoint {
    SolidSpans<D> solids;
    std::span<const std::uint32_t> which;
    double half_dt;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const { solids.predict(which[n], half_dt); }
};

template <int D>
struct UpdatePoint {
    SolidSpans<D> solids;

    DOSEKI_DEVICE_FN void operator()(std::size_t p,
                                     const DeformationAccumulators<double, D>& sums) const {
        solids.update(p, sums);
    }
};

template <int D>
struct DampSprings {
    SolidSpans<D> solids;

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const MisfitMoments<double, D>& sums) const {
        solids.damp_springs(p, sums);
    }
};

template <int D>
struct AcceleratePoint {
    SolidSpans<D> solids;
    Vec<double, D> gravity;

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const InternalForce<double, D>& force) const {
        solids.accelerate(p, force, gravity);
    }
};

/// Without loads and gravity.
template <int D>
struct InternalAcceleration {
    SolidSpans<D> solids;
    std::span<Vec<double, D>> acceleration;

    DOSEKI_DEVICE_FN void operator()(std::size_t p, const InternalForce<double, D>& force) const {
        acceleration[p] =
            solids.clamped[p] ? Vec<double, D>{} : (1.0 / solids.body_of(p).rho0) * force.all;
    }
};

template <int D>
template <class Where, class Term, class Epilogue>
void TotalLagrangian<D>::sum_over_pairs(const Term& term, const Epilogue& epilogue,
                                        const Array<std::uint32_t>* only) const {
    const PairsOf<typename Where::Backend, D> pairs{
        neighbours_.clusters(), motion_, {}, {.only = only}};
    Where::sum_pairs(neighbours_, pairs, term, epilogue);
}

template <int D>
template <class Where, class Term, class Epilogue>
void TotalLagrangian<D>::sum_over_pairs(const Term& term, const Epilogue& epilogue) const {
    sum_over_pairs<Where>(term, epilogue, stepped_.clusters());
}

template <int D>
template <class Where>
void TotalLagrangian<D>::predict(double half_dt) {
    const std::span<const std::uint32_t> which = stepped_.points();
    Where::for_each(which.size(), PredictPoint<D>{spans(), which, half_dt});
}

}  // namespace doseki
