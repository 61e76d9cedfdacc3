#pragma once
#include <array>
#include <chrono>
#include <numeric>

namespace doseki {

/// What a rank spends beside its own steps: cutting space, moving particles to their owners,
/// packing and unpacking what neighbours need, and waiting for other ranks.
enum class Share { balance, migrate, halo, wait };

inline constexpr std::array<const char*, 4> share_names{"balance", "migrate", "halo", "wait"};

/// Wall time of a rank within its steps, by share. A share measured within another is no part of
/// that one, and what is measured between steps belongs to none: shares and what is left, the work,
/// add up to the whole.
class RankClock {
    using Clock = std::chrono::steady_clock;

public:
    /// Adds the time until it goes out of scope, less that of scopes within.
    class Scope {
    public:
        Scope(RankClock& clock, double* seconds)
            : clock_(clock), seconds_(seconds), around_(clock.current_), start_(Clock::now()) {
            clock.current_ = seconds;
        }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;
        ~Scope() {
            const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
            *seconds_ += spent;
            if (around_) *around_ -= spent;
            clock_.current_ = around_;
        }

    private:
        RankClock& clock_;
        double *seconds_, *around_;
        Clock::time_point start_;
    };

    Scope measure(Share share) {
        const bool in_step = current_ && current_ != &between_;
        return Scope(*this, in_step ? &seconds_[static_cast<std::size_t>(share)] : &between_);
    }
    Scope measure_step() { return Scope(*this, &busy_); }

    const std::array<double, share_names.size()>& seconds() const { return seconds_; }
    /// All that does not belong to a share.
    double busy() const { return busy_; }
    double total() const { return std::accumulate(seconds_.begin(), seconds_.end(), busy_); }

private:
    std::array<double, share_names.size()> seconds_{};
    double busy_ = 0.0, between_ = 0.0;
    double* current_ = nullptr;  // what the innermost scope adds to
};

}  // namespace doseki
