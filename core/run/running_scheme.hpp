#pragma once
// What puts a scheme, with its state and back end, behind the interface of a run. Compiled once
// for all schemes (schemes.cpp.in).

#include <utility>

#include "base/array.hpp"
#include "pairs/pair_counter.hpp"
#include "run/any_scheme.hpp"
#include "run/integrate.hpp"
#include "run/scheme.hpp"

namespace doseki {

template <class SchemeOf>
using ListsOf = typename SchemeOf::Backend::template Lists<SchemeOf::dim>;

template <class SchemeOf>
class RunningScheme final : public AnyScheme<ListsOf<SchemeOf>>, public InDeviceMemory {
    static_assert(Scheme<SchemeOf>, "see run/scheme.hpp for what a scheme must have");
    static constexpr int D = SchemeOf::dim;
    using Lists = ListsOf<SchemeOf>;
    using Backend = typename SchemeOf::Backend;

public:
    RunningScheme(Array<Material> materials, const Options<D>& options)
        : state_(materials, options), scheme_(std::move(materials), options) {}

    static std::unique_ptr<AnyScheme<Lists>> make(Array<Material> materials,
                                                  const Options<D>& options) {
        return std::make_unique<RunningScheme>(std::move(materials), options);
    }

    Particles<D>& particles() override { return state_; }
    OwnFields<D> own_fields() override {
        OwnFields<D> own;
        if constexpr (requires { state_.velocity_gradient; })
            own.surface = &state_.surface, own.shift = &state_.shift,
            own.velocity_gradient = &state_.velocity_gradient;
        if constexpr (requires { state_.deviatoric_stress; })
            if (state_.has_strength) own.deviatoric_stress = &state_.deviatoric_stress;
        return own;
    }
    void kick(double half_dt) override { doseki::kick<Backend>(state(), half_dt); }
    double drift(double dt) override { return doseki::drift<Backend>(state(), dt); }
    Weight<D> weight() const override { return doseki::weight<Backend>(state()); }

    WallPush<D> wall_push() const override { return doseki::wall_push<Backend>(state()); }

    int width() const override { return Backend::width; }
    Array<std::uint32_t> sort(Lists& lists, const ParticlesToSort<D>& particles) override {
        return Backend::sort(lists, particles);
    }
    void build_lists(Lists& lists, std::span<const Vec<double, D>> position,
                     std::span<const double> support, double skin,
                     std::span<const std::int32_t> faces) override {
        Backend::build_lists(lists, position, support, skin, faces);
    }
    SkinCosts skin_costs() const override { return SchemeOf::skin_costs; }
    WordCosts cost_of_lists(const ListWords& words, const PassSeconds& seconds) const override {
        return SchemeOf::cost_of_lists(words, seconds);
    }
    Array<double> pair_counts(const Lists& lists) const override {
        return PairCounter(scheme_, lists).counts();
    }
    double bare_pair_rate(const Lists& lists, double seconds) const override {
        if constexpr (requires { scheme_.bare_pair_rate(lists, seconds); })
            return scheme_.bare_pair_rate(lists, seconds);
        else
            throw std::invalid_argument("the scheme has no bare rate");
    }

    int first_evaluations() const override { return SchemeOf::first_evaluations; }
    bool looks_back() const override { return SchemeOf::looks_back; }
    void advance_density(const Lists& lists, Halo<D>& halo, double dt) override {
        if constexpr (SchemeOf::looks_back) scheme_.advance_density(state_, lists, halo, dt);
    }
    void evaluate(const Lists& lists, Halo<D>& halo, double half_dt, bool new_lists) override {
        scheme_.evaluate(state_, lists, halo, half_dt, new_lists);
    }
    void sum_walls_alone(const Lists& lists, Halo<D>& halo, double inertia) override {
        if constexpr (requires { scheme_.sum_walls_alone(state_, lists, halo, inertia); })
            scheme_.sum_walls_alone(state_, lists, halo, inertia);
    }
    void end_step() override { scheme_.end_step(state_); }
    void push_on(const Lists& lists, const FacePlane<D>& face, std::span<const std::uint32_t> walls,
                 Array<FacePush<D>>& pushes) override {
        if constexpr (requires { scheme_.push_on(state_, lists, face, walls, pushes); })
            scheme_.push_on(state_, lists, face, walls, pushes);
        else
            pushes.assign(walls.size(), {});
    }
    ForceTerms<D> force_terms(const Lists& lists, Halo<D>& halo, std::int64_t p) override {
        return scheme_.force_terms(state_, lists, halo, p);
    }
    double timestep() const override { return scheme_.timestep(); }
    double dissipated_power() const override { return scheme_.dissipated_power(); }
    void forget_power() override { scheme_.forget_power(); }
    SchemeWork<D> work() const override { return scheme_.work(); }
    const Fault& fault() const override { return scheme_.fault(); }
    std::int64_t limiting_particle() const override { return scheme_.limiting_particle(); }

    double kernel_support() const override { return scheme_.kernel_support(); }
    PairArea pair_area() const override { return scheme_.pair_area(); }
    const Array<Material>& materials() const override { return scheme_.materials(); }
    PhaseTimer& phases() override { return scheme_.phases(); }
    ThermodynamicState<double> equation_of_state(std::size_t p) const override {
        return scheme_.equation_of_state(state_, p);
    }
    double shear_energy(std::size_t p) const override { return scheme_.shear_energy(state_, p); }
    Deviator<double, D> deviator(std::size_t p) const override {
        return scheme_.deviator(state_, p);
    }
    Deviator<double, D> stress(std::size_t p) const override { return state_.stress(p); }
    Deviator<double, D> stress_rate(std::size_t p) const override { return state_.stress_rate(p); }
    double balsara(std::size_t p) const override {
        if constexpr (requires { scheme_.balsara(p); })
            return scheme_.balsara(p);
        else
            return 0.0;
    }

    void serialise(Archive& archive) override { scheme_.serialise(archive); }
    std::size_t bytes() const override { return scheme_.bytes(); }

private:
    /// As the scheme has it, so that loops over particles call none of its methods by table.
    typename SchemeOf::State& state() { return state_; }
    const typename SchemeOf::State& state() const { return state_; }

    StateOf<typename SchemeOf::State> state_;
    SchemeOf scheme_;
};

}  // namespace doseki
