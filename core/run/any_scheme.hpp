#pragma once
// A scheme as a run sees it: simulations are compiled once for each dimension and each kind of
// lists, whatever schemes and precisions there are.

#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "base/array.hpp"
#include "base/phase_timer.hpp"
#include "boundaries/face_push.hpp"
#include "cells/list_wear.hpp"
#include "model/archive.hpp"
#include "model/fault.hpp"
#include "model/force_terms.hpp"
#include "model/material.hpp"
#include "model/options.hpp"
#include "model/particles.hpp"
#include "model/scheme_work.hpp"
#include "pairs/backend.hpp"
#include "physics/equation_of_state/thermodynamic_state.hpp"
#include "physics/wall.hpp"
#include "ranks/balance.hpp"
#include "ranks/halo.hpp"
#include "run/account.hpp"

namespace doseki {

/// Fields that tables of particles show where a scheme keeps them; null where it does not.
template <int D>
struct OwnFields {
    const FluidField<double>* surface = nullptr;
    const FluidField<Vec<double, D>>* shift = nullptr;  // beside their velocity [m/s]
    const FluidField<Mat<double, D>>* velocity_gradient = nullptr;
    Field<Deviator<double, D>>* deviatoric_stress = nullptr;
};

/// A scheme, its state and its back end. What the methods mean is said in scheme.hpp and at the
/// schemes; p is the index of a particle.
template <class Lists>
class AnyScheme {
public:
    static constexpr int D = Lists::dim;

    virtual ~AnyScheme() = default;

    virtual Particles<D>& particles() = 0;
    virtual OwnFields<D> own_fields() = 0;
    virtual void kick(double half_dt) = 0;
    virtual double drift(double dt) = 0;
    /// Of the free particles.
    virtual Weight<D> weight() const = 0;
    virtual WallPush<D> wall_push() const = 0;

    virtual int width() const = 0;
    virtual Array<std::uint32_t> sort(Lists& lists, const ParticlesToSort<D>& particles) = 0;
    virtual void build_lists(Lists& lists, std::span<const Vec<double, D>> position,
                             std::span<const double> support, double skin,
                             std::span<const std::int32_t> faces) = 0;
    virtual SkinCosts skin_costs() const = 0;
    virtual WordCosts cost_of_lists(const ListWords& words, const PassSeconds& seconds) const = 0;
    /// How many neighbours within support each particle has.
    virtual Array<double> pair_counts(const Lists& lists) const = 0;
    /// Throws std::invalid_argument where the scheme has none.
    virtual double bare_pair_rate(const Lists& lists, double seconds) const = 0;

    virtual int first_evaluations() const = 0;
    virtual bool looks_back() const = 0;
    /// Where it looks back: over a step.
    virtual void advance_density(const Lists& lists, Halo<D>& halo, double dt) = 0;
    virtual void evaluate(const Lists& lists, Halo<D>& halo, double half_dt, bool new_lists) = 0;
    /// Of what evaluate() does at the start, the sums of wall particles. Films between them go on
    /// with this share of their last change.
    virtual void sum_walls_alone(const Lists& lists, Halo<D>& halo, double inertia) = 0;
    virtual void end_step() = 0;
    /// What fluid gives to wall particles against the normal of a face.
    virtual void push_on(const Lists& lists, const FacePlane<D>& face,
                         std::span<const std::uint32_t> walls, Array<FacePush<D>>& pushes) = 0;
    /// The same as a function of the last three, which is false where forces are not `known`.
    auto pushes(const Lists& lists, bool known) {
        return [this, &lists, known](const auto& face, std::span<const std::uint32_t> walls,
                                     auto& pushes) {
            if (known) push_on(lists, face, walls, pushes);
            return known;
        };
    }
    virtual ForceTerms<D> force_terms(const Lists& lists, Halo<D>& halo, std::int64_t p) = 0;
    virtual double timestep() const = 0;
    virtual double dissipated_power() const = 0;
    /// What pairs dissipate and the scheme does is no longer that of this rank.
    virtual void forget_power() = 0;
    virtual SchemeWork<D> work() const = 0;
    virtual const Fault& fault() const = 0;
    virtual std::int64_t limiting_particle() const = 0;

    virtual double kernel_support() const = 0;
    /// Of the particles of bodies, on which films press; of nothing where the scheme has none.
    virtual PairArea pair_area() const = 0;
    virtual const Array<Material>& materials() const = 0;
    virtual PhaseTimer& phases() = 0;
    virtual ThermodynamicState<double> equation_of_state(std::size_t p) const = 0;
    virtual double shear_energy(std::size_t p) const = 0;
    virtual Deviator<double, D> deviator(std::size_t p) const = 0;
    virtual Deviator<double, D> stress(std::size_t p) const = 0;
    virtual Deviator<double, D> stress_rate(std::size_t p) const = 0;
    /// Zero where the scheme has no such switch.
    virtual double balsara(std::size_t p) const = 0;

    /// What it keeps beside the fields of particles.
    virtual void serialise(Archive& archive) = 0;
    virtual std::size_t bytes() const = 0;

    /// Bytes of the fields of particles.
    std::size_t state_bytes() {
        std::size_t bytes = 0;
        for (const NamedField& field : particles().fields()) bytes += field.memory->bytes_held();
        return bytes;
    }
};

/// Makes schemes of one name and precision. Each announces itself.
template <class Lists>
class SchemeKind {
public:
    static constexpr int D = Lists::dim;
    using Made = std::unique_ptr<AnyScheme<Lists>>;
    using Make = Made(Array<Material> materials, const Options<D>& options);

    SchemeKind(std::string name, std::string precision, Make& make)
        : name_(std::move(name)), precision_(std::move(precision)), make_(make) {
        all().push_back(this);
    }

    /// Throws std::invalid_argument where there is no such scheme.
    static const SchemeKind& of(const std::string& name, const std::string& precision) {
        for (const SchemeKind* kind : all())
            if (kind->name_ == name && kind->precision_ == precision) return *kind;
        throw std::invalid_argument("no simulation of scheme \"" + name + "\" in " +
                                    std::to_string(D) + " dimensions and " + precision +
                                    " precision");
    }

    Made make(Array<Material> materials, const Options<D>& options) const {
        return make_(std::move(materials), options);
    }

private:
    static Array<const SchemeKind*>& all() {
        static Array<const SchemeKind*> kinds;
        return kinds;
    }

    std::string name_, precision_;
    Make& make_;
};

}  // namespace doseki
