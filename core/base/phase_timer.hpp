#pragma once
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>

#include "base/parallel.hpp"

namespace doseki {

/// What a step consists of. In the resolved scheme `continuity` and pass 2 are sums over fluid, for
/// densities and for forces, pass 1 those over walls. In ueta2022 the stress of particles is worked
/// out inside pass 1, cluster by cluster, and subtracted from it.
enum class Phase { sort, list_build, pack, continuity, pass_1, stress, pass_2, integrate, bodies };

inline constexpr std::array<const char*, 9> phase_names{"sort",       "list_build", "pack",
                                                        "continuity", "pass_1",     "stress",
                                                        "pass_2",     "integrate",  "bodies"};

/// Wall time by phase. Off until asked for; on, it reads the clock twice a phase and at one cluster
/// in `sampling`.
class PhaseTimer {
    using Clock = std::chrono::steady_clock;

public:
    static constexpr std::uint32_t sampling = 64;

    /// Adds the time until it goes out of scope to a phase.
    class Scope {
    public:
        Scope(PhaseTimer* timer, Phase phase) : timer_(timer), phase_(phase) {
            if (timer_) start_ = Clock::now();
        }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;
        ~Scope() {
            if (timer_) timer_->at(phase_) += seconds_since(start_);
        }

    private:
        PhaseTimer* timer_;
        Phase phase_;
        Clock::time_point start_{};
    };

    /// Starts again from zero, or stops.
    void restart(bool on) { on_ = on, seconds_ = {}, sampled_ns_ = 0; }

    Scope measure(Phase phase) { return Scope(on_ ? this : nullptr, phase); }

    bool samples(std::uint32_t cluster) const { return on_ && cluster % sampling == 0; }

    /// Runs `work`, the stress of one sampled cluster; may be called by many threads at once.
    template <class Work>
    void sample_stress(const Work& work) {
        const auto start = Clock::now();
        work();
        const auto ns =
            std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start).count();
        add_from_any_thread(sampled_ns_, std::int64_t{ns});
    }

    /// Seconds by phase since restart(), where the stress was shared by `threads`.
    std::array<double, phase_names.size()> seconds(int threads) const {
        auto seconds = seconds_;
        double& pass_1 = seconds[static_cast<std::size_t>(Phase::pass_1)];
        // A thread that lost its core within a sample would count for more than there was.
        const double sampled = 1e-9 * static_cast<double>(sampled_ns_) * sampling / threads;
        const double stress = std::min(sampled, pass_1);
        seconds[static_cast<std::size_t>(Phase::stress)] = stress;
        pass_1 -= stress;
        return seconds;
    }

private:
    static double seconds_since(Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    }
    double& at(Phase phase) { return seconds_[static_cast<std::size_t>(phase)]; }

    bool on_ = false;
    std::array<double, phase_names.size()> seconds_{};
    std::int64_t sampled_ns_ = 0;
};

}  // namespace doseki
