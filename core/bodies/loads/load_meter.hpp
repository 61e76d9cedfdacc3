#pragma once
#include <algorithm>
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "base/error.hpp"
#include "bodies/loads/panel_grid.hpp"
#include "bodies/rotation.hpp"
#include "model/archive.hpp"
#include "model/particles.hpp"

namespace doseki {

/// A force on a wall, and where it acts; the moment is what acts beside that of the force.
template <int D>
struct WallForce {
    Vec<double, D> place, force;
    Vec3 moment{};
    double width = 0.0;  // over which it is spread along the wall [m]
};

/// How hard a body hits a wall as their contact begins: the speed of approach and the radius of the
/// body.
struct Hit {
    double speed = 0.0, radius = 0.0;

    /// That of a Hertz contact goes with this power of both.
    bool is_harder_than(const Hit& other) const { return severity() > other.severity(); }

private:
    double severity() const { return std::pow(speed, 1.2) * radius * radius; }
};

/// What the flow and contacts give to some fixed bodies: impulses since the start, the strongest
/// step and the hardest hit. 2-D: per metre.
template <int D>
class LoadMeter {
public:
    Array<std::int32_t> bodies;  // the [body.NAME] that it is on
    Vec<double, D> about{};      // point of the moments [m]
    PanelGrid<D> grid;

    bool is_on(std::int32_t body) const {
        return std::find(bodies.begin(), bodies.end(), body) != bodies.end();
    }
    /// Call once its bodies and panels are known.
    void prepare() {
        for (Array<double>* sum : {&flow_now_, &flow_impulse_, &contact_impulse_, &contact_before_})
            sum->assign(numbers(), 0.0);
    }

    /// Forces of the flow on the wall particles of this rank; `sum` adds those of other ranks.
    template <class Pushes, class SumOverRanks>
    void measure(const Particles<D>& particles, const Pushes& pushes, const SumOverRanks& sum) {
        std::fill(flow_now_.begin(), flow_now_.end(), 0.0);
        for (const std::uint32_t p : members_) add_whole(flow_now_, flow_on(particles, p), 1.0);
        if (grid.panels() > 0) add_to_panels(particles, pushes);
        sum(std::span<double>(flow_now_));
        has_forces_ = true;
    }
    bool has_forces() const { return has_forces_; }
    /// Finds the wall particles of its bodies, anew where particles have been sorted.
    void find_members(const Particles<D>& particles) {
        members_.clear(), near_face_.clear();
        for (std::uint32_t p = 0; p < particles.size(); ++p) {
            if (!particles.is_fixed(p)) continue;
            const bool own = is_on(particles.tag[p].body);
            if (own) members_.push_back(p);
            if (grid.is_near(particles.position[p], own)) near_face_.push_back(p);
        }
    }

    void begin_step() { contact_before_ = contact_impulse_; }
    /// A contact that presses for dt.
    void add_contact(const WallForce<D>& force, double dt) { add(contact_impulse_, force, dt); }
    void add_hit(const Hit& hit) {
        if (hit.is_harder_than(hit_)) hit_ = hit;
    }
    /// The flow goes on from its forces before the step to those after it. Takes them over.
    template <class Pushes, class SumOverRanks>
    void end_step(const Particles<D>& particles, const Pushes& pushes, const SumOverRanks& sum,
                  double dt, double time) {
        Array<double> mean = flow_now_;
        const bool known = knows_panels_;
        measure(particles, pushes, sum);
        if (!known) std::ranges::copy(panels_of(flow_now_), mean.begin() + first_panel);
        for (std::size_t k = 0; k < mean.size(); ++k) {
            mean[k] = 0.5 * (mean[k] + flow_now_[k]);
            flow_impulse_[k] += dt * mean[k];
            mean[k] += (contact_impulse_[k] - contact_before_[k]) / dt;
        }
        const Vec<double, D> force = force_of(mean);
        if (peak_.time < 0.0 || dot(force, force) > dot(peak_.force, peak_.force))
            peak_ = {force, moment_of(mean), time};
    }

    struct Peak {
        Vec<double, D> force{};  // mean over the step that ends at `time`
        Vec3 moment{};
        double time = -1.0;
    };
    const Peak& peak() const { return peak_; }
    const Hit& hit() const { return hit_; }
    /// The next peak and hit are those from now on.
    void forget_peak() { peak_ = {}, hit_ = {}; }

    Vec<double, D> flow_impulse() const { return force_of(flow_impulse_); }
    Vec<double, D> contact_impulse() const { return force_of(contact_impulse_); }
    Vec3 flow_turning() const { return moment_of(flow_impulse_); }
    Vec3 contact_turning() const { return moment_of(contact_impulse_); }
    /// Impulses normal to the panels, positive where they are pressed on.
    std::span<const double> panels_of_flow() const { return panels_of(flow_impulse_); }
    std::span<const double> panels_of_contacts() const { return panels_of(contact_impulse_); }

    void serialise(Archive& archive) {
        // Panels take sums over pairs, which a run that goes on has not made yet; the rest follows
        // from the particles.
        if (grid.panels() > 0)
            archive("flow_now", flow_now_), archive("has_forces", has_forces_);
        else if (archive.loads())
            has_forces_ = false;
        archive("flow_impulse", flow_impulse_), archive("contact_impulse", contact_impulse_);
        archive("hit_speed", hit_.speed), archive("hit_radius", hit_.radius);
        archive("peak_force", peak_.force), archive("peak_moment", peak_.moment);
        archive("peak_time", peak_.time);
        expect_fit(flow_now_.size() == numbers() && flow_impulse_.size() == numbers() &&
                       contact_impulse_.size() == numbers(),
                   "load_flow_impulse");
    }

private:
    /// Wall particles that face away belong to another face.
    static constexpr double backwards = -0.5;
    static constexpr std::size_t first_panel = D + 3;

    WallForce<D> flow_on(const Particles<D>& particles, std::uint32_t p) const {
        const WallState<D>& wall = particles.wall;
        return {particles.position[p], wall.force[p], about_axes<D>(wall.moment[p]),
                grid.footprint};
    }
    std::size_t numbers() const { return first_panel + grid.panels(); }
    static Vec<double, D> force_of(const Array<double>& sum) {
        Vec<double, D> force;
        std::copy_n(sum.begin(), D, force.component.begin());
        return force;
    }
    static Vec3 moment_of(const Array<double>& sum) {
        Vec3 moment;
        std::copy_n(sum.begin() + D, 3, moment.component.begin());
        return moment;
    }
    static std::span<const double> panels_of(const Array<double>& sum) {
        return std::span<const double>(sum).subspan(first_panel);
    }

    void add_whole(Array<double>& sum, const WallForce<D>& at, double factor) const {
        const Vec3 moment = at.moment + cross(in_space(at.place - about), in_space(at.force));
        for (int a = 0; a < D; ++a) sum[static_cast<std::size_t>(a)] += factor * at.force[a];
        for (int a = 0; a < 3; ++a) sum[static_cast<std::size_t>(D + a)] += factor * moment[a];
    }
    void add(Array<double>& sum, const WallForce<D>& at, double factor) const {
        add_whole(sum, at, factor);
        press(sum, at.place, at.width, -factor * dot(at.force, grid.normal));
    }
    /// What is `wide` at x presses on the panels.
    void press(Array<double>& sum, const Vec<double, D>& x, double wide, double pressing) const {
        grid.for_each_share(x, wide, [&](std::size_t panel, double share) {
            sum[first_panel + panel] += share * pressing;
        });
    }
    /// What fluid in front of the face gives to walls behind its plane, whosever they are: at the
    /// foot of a wall it presses on the bed below as well. Of the bodies themselves also what comes
    /// from no fluid particle: films and friction.
    template <class Pushes>
    void add_to_panels(const Particles<D>& particles, const Pushes& pushes) {
        knows_panels_ = pushes(grid.plane(), std::span<const std::uint32_t>(near_face_), pushes_);
        if (!knows_panels_) return;
        for (std::size_t k = 0; k < near_face_.size(); ++k) {
            const std::uint32_t p = near_face_[k];
            const WallForce<D> at = flow_on(particles, p);
            const FacePush<D>& push = pushes_[k];
            press(flow_now_, grid.pressed_place(at.place, push), at.width, push.front);
            if (is_on(particles.tag[p].body) &&
                dot(particles.wall.normal[p], grid.normal) > backwards)
                press(flow_now_, at.place, at.width, -dot(at.force, grid.normal) - push.all);
        }
    }

    Array<std::uint32_t> members_, near_face_;
    Array<FacePush<D>> pushes_;  // on those near the face
    // Force, moment and panels in one array each, so that ranks add them up at once.
    Array<double> flow_now_, flow_impulse_, contact_impulse_, contact_before_;
    bool has_forces_ = false;   // of the flow, now
    bool knows_panels_ = true;  // a run that starts from a state of another has no pairs yet
    Peak peak_;
    Hit hit_;
};

}  // namespace doseki
