#pragma once
#include <array>
#include <chrono>

namespace doseki {

/// What a rank spends beside its own steps: cutting space, moving particles to their owners,
/// packing and unpacking what neighbours need, and waiting for other ranks.
enum class Share { balance, migrate, halo, wait };

inline constexpr std::array<const char*, 4> share_names{"balance", "migrate", "halo", "wait"};

/// Wall time of a rank by share.
class RankClock {
    using Clock = std::chrono::steady_clock;

public:
    /// Adds the time until it goes out of scope, or until stop(), to a share.
    class Scope {
    public:
        explicit Scope(double* seconds) : seconds_(seconds), start_(Clock::now()) {}
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;
        ~Scope() { *seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

    private:
        double* seconds_;
        Clock::time_point start_;
    };

    Scope measure(Share share) { return Scope(&seconds_[static_cast<std::size_t>(share)]); }
    Scope measure_total() { return Scope(&total_); }

    const std::array<double, share_names.size()>& seconds() const { return seconds_; }
    double total() const { return total_; }
    /// All that does not belong to a share.
    double busy() const {
        double busy = total_;
        for (double share : seconds_) busy -= share;
        return busy;
    }

private:
    std::array<double, share_names.size()> seconds_{};
    double total_ = 0.0;
};

}  // namespace doseki
