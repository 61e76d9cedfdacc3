#pragma once
#include <array>
#include <cmath>
#include <string>

#include "base/array.hpp"
#include "base/error.hpp"
#include "bodies/elastic/bonds.hpp"
#include "bodies/elastic/deformable_body.hpp"
#include "bodies/elastic/division.hpp"
#include "bodies/elastic/solid_spans.hpp"
#include "bodies/elastic/stepped_points.hpp"
#include "bodies/rotation.hpp"
#include "device/lists_of_build.hpp"
#include "model/body_step.hpp"
#include "physics/kernel/wendland_c2.hpp"

namespace doseki {

template <class T, int D>
struct DeformationAccumulators;
template <int D>
struct ElasticRecords;
template <int D>
struct RigidMotion;

/// The points of a body that is to be: where they are without stress, and how they start.
template <int D>
struct SolidPoints {
    Array<Vec<double, D>> rest, position, velocity;
    Array<std::uint8_t> clamped;
};

/// Of strain, and of the springs of Eq. (83) [J], 2-D: [J/m].
struct ElasticEnergy {
    double strain = 0.0, springs = 0.0;

    double sum() const { return strain + springs; }
};

/// How a body moves that keeps its shape: the place of what was at `rest_centre`, and how it is
/// turned since then.
template <int D>
struct RigidPlacement {
    Vec<double, D> rest_centre, centre, velocity;
    Vec3 angular_momentum;  // about `centre`
    Mat<double, 3> turn;
};

/// A point of a body that breaks as it was when forces acted last: its place, deformation gradient
/// and correction.
template <int D>
struct ActedPoint {
    Vec<double, D> x;
    Mat<double, D> F, B;
};

/// Part of a point in a place that points carry along.
struct PointShare {
    std::uint32_t point;
    double share;
};

/// Deformable bodies in a total-Lagrangian description: pairs are those of the places at rest,
/// found once. Stress and strain are strictly inside one body, since at rest bodies are set far
/// apart. Forces are the gradient of a discrete energy, so that without damping position Verlet
/// keeps energy as well as momentum and angular momentum. Points are stored in the order of their
/// sort at rest; `slot` finds them. How they are stepped is in deformable/advance.hpp, which
/// deformable.cpp compiles.
template <int D>
class TotalLagrangian {
public:
    TotalLagrangian() : neighbours_(Domain<D>{}) {}

    /// Clamped points stay where they are. A point's mass is rho0 times spacing^D. A body that
    /// `is_rigid` takes part in nothing until it is made deformable.
    void add(const DeformableBody& body, const SolidPoints<D>& points, bool is_rigid = false) {
        const auto number = static_cast<std::int32_t>(bodies_.size());
        const Vec<double, D> apart = room_for(body, points.rest);
        for (std::size_t k = 0; k < points.rest.size(); ++k) {
            rest_.push_back(points.rest[k] + apart);
            x.push_back(points.position[k]);
            v.push_back(points.clamped[k] ? Vec<double, D>{} : points.velocity[k]);
            body_.push_back(number), clamped_.push_back(points.clamped[k]);
            gone_.push_back(0), held_shape_.push_back({});
        }
        bodies_.push_back(body), apart_.push_back(apart);
        rigid_.push_back(is_rigid), held_energy_.push_back(0.0);
    }
    /// Takes a body out for good: it takes part in nothing from now on. Returns the energy that it
    /// had beside that of motion [J], 2-D: [J/m].
    double take_out(std::size_t body);
    bool has_left(std::size_t body) const { return rigid_[body] == left; }
    /// Whether a body has points that stay where they are.
    bool is_clamped(std::size_t body) const;
    /// Whether a body moves as a rigid one, which someone else steps, or has left.
    bool is_rigid(std::size_t body) const { return rigid_[body] != 0; }
    /// Points of all bodies that are not rigid.
    const SteppedPoints& stepped() const { return stepped_; }
    Array<std::uint32_t> points_of(std::size_t body) const {
        Array<std::uint32_t> points;
        auto add = [&](std::uint32_t p) {
            if (!gone(p) && body_[p] == static_cast<std::int32_t>(body)) points.push_back(p);
        };
        if (is_rigid(body))
            for (std::uint32_t p = 0; p < size(); ++p) add(p);
        else
            for (const std::uint32_t p : stepped_.points()) add(p);
        return points;
    }
    /// Makes a rigid body deformable, with the momenta of the placement.
    void make_deformable(std::size_t body, const RigidPlacement<D>& placement);
    /// Makes a body rigid that moves as in `motion`: it keeps its shape with the elastic energy
    /// that is in it; what it had of motion beyond `kinetic` [J] counts as damped.
    void make_rigid(std::size_t body, const RigidMotion<D>& motion, double kinetic);
    /// Tension [Pa] at which the first of the bonds of a body cracks while none has.
    double strength(std::size_t body) const;
    /// Of the weakest of the bonds that a body has within itself, see Bonds.
    double least_intactness(std::size_t body) const;

    /// Finds pairs, corrects gradients, takes the first accelerations. Call once, after the bodies
    /// are in. The longest stable step [s] is found unless it is given.
    void start(const Vec<double, D>& gravity, double stable_step = 0.0);

    /// Velocities, by a force of others on each point alone [N], 2-D: [N/m].
    void push_by(std::span<const Vec<double, D>> force, double dt);
    /// Moves `steady` to such a force by a share of what they differ in; the first is it at once.
    void follow(std::span<const Vec<double, D>> force, double share);

    /// Accelerations by internal forces alone, with x and v as they are [m/s^2]; those of points
    /// that are not stepped mean nothing.
    void internal_accelerations(std::span<Vec<double, D>> accelerations);

    /// Steps of their own over `dt`, under `load`, `steady` and gravity.
    void advance(double dt, const Vec<double, D>& gravity) {
        const int steps = max(1, static_cast<int>(std::ceil(dt / timestep())));
        for (int n = 0; n < steps; ++n)
            drift(0.5 * dt / steps), push(dt / steps, gravity), drift(0.5 * dt / steps);
    }
    /// The parts of such a step: positions, which returns the largest distance gone, and
    /// velocities, before which `load` may be set; tells what that load and gravity gave.
    double drift(double dt);
    BodyStep<D> push(double dt, const Vec<double, D>& gravity);

    /// The longest that is stable, for bodies strained as they are [s]; infinite where all are
    /// rigid.
    double timestep() const;
    /// The same of unstrained ones, also of those that are rigid.
    double unstrained_timestep() const { return courant * stable_step_; }
    std::size_t size() const { return x.size(); }
    std::size_t bodies() const { return bodies_.size(); }
    double mass(std::size_t p) const { return body_of(p).rho0 * volume(p); }
    double volume(std::size_t p) const { return std::pow(body_of(p).spacing, D); }
    const DeformableBody& body_of(std::size_t p) const {
        return bodies_[static_cast<std::size_t>(body_[p])];
    }
    std::int32_t body(std::size_t p) const { return body_[p]; }
    const DeformableBody& material(std::size_t body) const { return bodies_[body]; }
    bool breaks(std::size_t body) const { return bodies_[body].breaks(); }
    /// Whether the point has become dust: it stays where it is and does nothing.
    bool gone(std::size_t p) const { return gone_[p] != 0; }
    /// The body of each point, -1 of those that are gone and of rigid ones.
    Array<std::int32_t> holders() const {
        Array<std::int32_t> holder(size(), -1);
        for (const std::uint32_t p : stepped_.points())
            if (!gone(p)) holder[p] = body_[p];
        return holder;
    }
    bool clamped(std::size_t p) const { return clamped_[p] != 0; }
    /// Where the point that was added as number k is stored.
    std::uint32_t slot(std::size_t k) const { return slot_[k]; }
    /// Points within the support of one at rest, itself among them; those of the same body.
    Array<std::uint32_t> pairs_of(std::size_t p) const;
    Array<std::uint32_t> neighbours_of(std::size_t p) const;
    /// How the points of its body around point p have moved, as its deformation gradient says
    /// where all bonds are whole.
    Mat<double, D> motion_around(std::size_t p) const;
    /// The place that goes with point p by this, from `offset` at rest: shares of points, which add
    /// up to 1.
    Array<PointShare> carriers(std::size_t p, const Vec<double, D>& offset) const;
    /// At rest, moment of the pairs of point p with those neighbours for which holds(j).
    template <class Holds>
    Mat<double, D> shape_around(std::size_t p, const Holds& holds) const;
    /// Whether the bonds of a point span the space, so that it has a stress.
    bool spans(std::size_t p) const { return spans_[p] != 0; }
    /// Gives points to new bodies, which are like their parents, or to none. Bonds between points
    /// of different ones end.
    void divide(const Division& division);
    Vec<double, D> rest_position(std::size_t p) const {
        return rest_[p] - apart_[static_cast<std::size_t>(body_[p])];
    }
    const Mat<double, D>& deformation(std::size_t p) const { return deformation_[p]; }
    /// First Piola-Kirchhoff stress without damping.
    Mat<double, D> stress(std::size_t p) const { return body_of(p).stress(deformation_[p]); }
    /// Of where points will be in a time `ahead`; changes nothing.
    ElasticEnergy elastic_energy(double ahead = 0.0) const;
    /// Of the places on the way of a step `dt`, as forces find it: across_step.
    double energy_across(double dt) const {
        auto at = [&](double share) { return elastic_energy(share * dt).sum(); };
        return across_step(at(0.0), at(0.5), at(1.0));
    }
    template <class Counts>  // of point p with those of its bonds to points j for which counts(j)
    double energy_with(std::size_t p, const Counts& counts) const;
    double kinetic_energy() const;
    /// Energy that cracks and that damping took so far [J], 2-D: [J/m].
    double fracture_work() const { return bonds_.work(); }
    double damping_work() const { return damping_work_; }

    /// Of bodies that may break: which pairs hold, how many do not, what the last step did.
    const Bonds<D>& bonds() const { return bonds_; }
    /// Ends for good the bonds between points a and b for which apart(a, b): those of two bodies.
    template <class Apart>
    void part_bonds(const Apart& apart) {
        bonds_.part(apart);
        find_spans(), find_acted();
    }

    /// Restored, bodies go on with the same pairs in the same order: a sort leaves sorted points
    /// alone.
    void serialise(Archive& archive, const Vec<double, D>& gravity) {
        Array<double> numbers;
        if (!archive.loads())
            for (const DeformableBody& body : bodies_) {
                const auto of_body = body.numbers();
                numbers.insert(numbers.end(), of_body.begin(), of_body.end());
            }
        archive("elastic_numbers", numbers), archive("elastic_apart", apart_),
            archive("elastic_rest", rest_);
        archive("elastic_position", x), archive("elastic_velocity", v),
            archive("elastic_body", body_);
        archive("elastic_clamped", clamped_), archive("elastic_slot", slot_);
        archive("elastic_rigid", rigid_), archive("elastic_held_energy", held_energy_);
        archive("elastic_held_shape", held_shape_);
        archive("elastic_gone", gone_);
        double stable_step = stable_step_;
        archive("elastic_stable_step", stable_step);
        Array<Vec<double, D>> accelerations = a;
        Array<Mat<double, D>> deformations = deformation_;
        archive("elastic_acceleration", accelerations),
            archive("elastic_deformation", deformations);
        if (archive.loads()) {
            expect_fit(stable_step > 0.0, "elastic_stable_step");
            expect_whole(numbers.size(), accelerations.size(), deformations.size());
            const auto slots = slot_;
            bodies_.clear();
            for (std::size_t k = 0; k < numbers.size(); k += DeformableBody::count)
                bodies_.push_back(DeformableBody::of(&numbers[k]));
            start(gravity, stable_step);
            slot_ = slots;
            number_points();
        }
        bonds_.serialise(archive);
        Array<Vec<double, D>> acted;
        for (const ActedPoint<D>& point : acted_) acted.push_back(point.x);
        archive("elastic_acted", acted);
        if (archive.loads()) {
            stepped_.choose(size(), [](std::uint32_t) { return true; });
            find_spans();
            choose_stepped();
            expect_fit(acted.size() == acted_.size(), "elastic_acted");
            for (std::size_t p = 0; p < acted_.size(); ++p) acted_[p].x = acted[p];
            find_acted();
            a = accelerations, deformation_ = deformations;
        }
        archive("elastic_damping_work", damping_work_);
        expect_fit(std::isfinite(damping_work_), "elastic_damping_work");
    }

    Array<Vec<double, D>> x, v, a;  // [m], [m/s], [m/s^2]
    Array<Vec<double, D>> load;     // force of contacts within a step [N], 2-D: [N/m]
    Array<Vec<double, D>> steady;   // force of others that is the same in all steps

private:
    /// Throws std::invalid_argument unless restored arrays are those of the same bodies.
    void expect_whole(std::size_t numbers, std::size_t accelerations,
                      std::size_t deformations) const {
        const std::size_t n = x.size();
        expect_fit(numbers == apart_.size() * DeformableBody::count, "elastic_numbers");
        expect_fit(rigid_.size() == apart_.size() && held_energy_.size() == apart_.size(),
                   "elastic_rigid");
        expect_fit(held_shape_.size() == n, "elastic_held_shape");
        expect_fit(rest_.size() == n && v.size() == n && body_.size() == n &&
                       clamped_.size() == n && gone_.size() == n && slot_.size() == n &&
                       accelerations == n && deformations == n,
                   "elastic_position");
        for (const std::int32_t body : body_) expect_index(body, apart_.size(), "elastic_body");
        for (const std::uint32_t slot : slot_) expect_index(slot, n, "elastic_slot");
    }

    /// Of the longest stable step.
    static constexpr double courant = 0.7;

    /// Weight of the pair with a point j at R from another at rest, in sums over those of one body.
    double pair_weight(std::size_t j, const Vec<double, D>& R) const {
        return -volume(j) * WendlandC2<D>::gradient_factor(norm(R), 1.0 / body_of(j).support());
    }
    Vec<double, D> room_for(const DeformableBody& body, std::span<const Vec<double, D>> position);
    void sort();
    void number_points() {
        number_.resize(size());
        for (std::uint32_t k = 0; k < size(); ++k) number_[slot_[k]] = k;
    }
    void correct_gradients();
    Array<std::uint8_t> representatives() const;
    void limit_timestep();
    template <class F>
    void sum_internal_forces(double half_dt, const F& take);
    void compute_accelerations(double half_dt, const Vec<double, D>& gravity);
    Array<Vec<double, D>> linear_response(const Array<Vec<double, D>>& displacement,
                                          const Array<Vec<double, D>>& velocity);
    template <class Epilogue>
    void sum_springs(const ElasticRecords<D>& records, const Epilogue& epilogue) const;
    ElasticRecords<D> records() const { return {motion_, place_, solid_}; }
    SolidSpans<D> spans() {
        return {bodies_, body_, clamped_, correction_, deformation_,   motion_, place_,
                solid_,  x,     v,        a,           damping_force_, load,    steady};
    }

    // Where loops may run elsewhere: bodies/deformable/internal_forces.hpp.
    template <class Where, class Term, class Epilogue>
    void sum_over_pairs(const Term& term, const Epilogue& epilogue,
                        const Array<std::uint32_t>* only) const;  // none: all clusters
    template <class Where, class Term, class Epilogue>
    void sum_over_pairs(const Term& term, const Epilogue& epilogue) const;
    template <class Where>
    void predict(double half_dt);
    template <class F>
    void sum_whole_forces(double half_dt, const F& take);
    BodyStep<D> push_points(double dt, const Vec<double, D>& gravity);

    // Of bodies that may break: bodies/deformable/breaking.hpp.
    void find_bonds();
    void find_spans();
    void take_shape(std::size_t p, const Mat<double, D>& shape);
    double weakening(std::size_t p) const;
    BondPoint<D> bond_point(std::size_t p) const;
    template <class F>
    void sum_bonded_forces(const F& take);
    void push_bonded(double dt, const Vec<double, D>& gravity);
    void update_bonded(std::size_t p, const DeformationAccumulators<double, D>& sums,
                       const Mat<double, D>& shape);
    void update_deformations(const Array<std::uint32_t>& clusters = {});
    Array<std::uint32_t> cracked_clusters() const;
    BondPoint<D> acted_point(std::size_t p) const;
    void note_acted();
    void find_acted();
    void advance_bonds(double dt);

    void choose_stepped() {
        auto moves = [this](std::uint32_t p) {
            return !gone(p) && !is_rigid(static_cast<std::size_t>(body_[p]));
        };
        stepped_.choose(size(), moves);
        bonds_.step_only(moves);
    }

    /// Arrays for elastic_energy(), of which only the rows of stepped points are used.
    struct EnergyRows {
        Array<ElasticPlaceRecord<D>> place;
        Array<ElasticRecord<D>> solid;
        Array<ElasticEnergy> energy;
    };

    Array<DeformableBody> bodies_;
    static constexpr std::uint8_t left = 2;
    Array<std::uint8_t> rigid_;  // by body: 1, or `left`
    // Of rigid ones: their elastic energy, and by point how their shape differs from that at rest.
    Array<double> held_energy_;
    Array<Vec<double, D>> held_shape_;
    SteppedPoints stepped_;
    mutable EnergyRows energy_rows_;
    Array<Vec<double, D>> apart_;  // by body: shift of its places at rest
    double reach_ = 0.0;           // how far along x places at rest are taken
    Array<Vec<double, D>> rest_;
    Array<std::int32_t> body_;
    Array<std::uint8_t> clamped_, gone_;
    Array<std::uint32_t> slot_, number_;  // of the point of each number, and of each slot
    Array<Mat<double, D>> correction_, deformation_;
    ListsOfBuild<D> neighbours_;
    Array<MotionRecord<double, D>> motion_;
    Array<ElasticPlaceRecord<D>> place_;
    Array<ElasticRecord<D>> solid_;
    Bonds<D> bonds_;
    Array<Mat<double, D>> stress_;         // of breakable bodies, without damping
    Array<double> tension_;                // its largest principal value, of the material
    Array<std::uint8_t> spans_;            // whether the bonds of a point span the space, Eq. (120)
    Array<double> sharpness_;              // of gradients there, where they do, in spacings
    Array<ActedPoint<D>> acted_;           // of breakable bodies
    double sharpest_whole_ = 0.0;          // while all bonds are whole
    Array<Vec<double, D>> damping_force_;  // on each point, of both dampers [N], 2-D: [N/m]
    double damping_work_ = 0.0;
    bool springs_damp_ = false;
    double stable_step_ = std::numeric_limits<double>::max();  // for bodies at rest [s]
};

// Compiled once: deformable.cpp.
extern template class TotalLagrangian<2>;
extern template class TotalLagrangian<3>;

}  // namespace doseki
