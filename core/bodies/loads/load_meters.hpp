#pragma once
#include <string>

#include "base/array.hpp"
#include "bodies/loads/load_meter.hpp"
#include "ranks/exchange.hpp"

namespace doseki {

/// The meters of a run. Every rank has them all and adds up the same numbers.
template <int D>
class LoadMeters {
public:
    void add(LoadMeter<D> meter) {
        meter.prepare();
        meters_.push_back(std::move(meter));
    }
    bool empty() const { return meters_.empty(); }
    const Array<LoadMeter<D>>& all() const { return meters_; }
    void forget_peak(std::size_t meter) { meters_.at(meter).forget_peak(); }

    /// Particles have been sorted.
    void lose_members() { has_members_ = false; }

    /// Before the forces of the flow act for the first half of a step.
    template <class Pushes>
    void begin_step(const Particles<D>& particles, const Ranks& ranks, const Pushes& pushes) {
        if (empty()) return;
        find_members(particles);
        for (LoadMeter<D>& meter : meters_) {
            if (!meter.has_forces()) meter.measure(particles, pushes, sum_over(ranks));
            meter.begin_step();
        }
    }
    /// When those of the second half are known.
    template <class Pushes>
    void end_step(const Particles<D>& particles, const Ranks& ranks, const Pushes& pushes,
                  double dt, double time) {
        if (empty()) return;
        find_members(particles);
        for (LoadMeter<D>& meter : meters_)
            meter.end_step(particles, pushes, sum_over(ranks), dt, time);
    }
    /// A contact of a wall of this [body.NAME].
    void add_contact(std::int32_t body, const WallForce<D>& force, const Hit& hit, double dt) {
        for (LoadMeter<D>& meter : meters_)
            if (meter.is_on(body)) meter.add_contact(force, dt), meter.add_hit(hit);
    }

    void serialise(Archive& archive) {
        for (std::size_t k = 0; k < meters_.size(); ++k)
            archive.nested(std::to_string(k) + "_load_", meters_[k]);
        if (archive.loads()) has_members_ = false;
    }

private:
    static auto sum_over(const Ranks& ranks) {
        return [&ranks](std::span<double> values) { ranks.sum(values); };
    }
    void find_members(const Particles<D>& particles) {
        if (has_members_) return;
        for (LoadMeter<D>& meter : meters_) meter.find_members(particles);
        has_members_ = true;
    }

    Array<LoadMeter<D>> meters_;
    bool has_members_ = false;
};

}  // namespace doseki
