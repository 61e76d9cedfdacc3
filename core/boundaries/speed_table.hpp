#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/array.hpp"

namespace doseki {

/// The speed of an inflow over time: rows of time [s], distance gone since the first row [m] and
/// speed [m/s]. In between the speed is linear in time, so the distance is a parabola and known
/// exactly.
struct SpeedTable {
    Array<double> time, distance, speed;

    static SpeedTable constant(double start, double stop, double speed) {
        return {{start, stop}, {0.0, speed * (stop - start)}, {speed, speed}};
    }

    double start() const { return time.front(); }
    double stop() const { return time.back(); }
    bool steady() const { return std::equal(speed.begin() + 1, speed.end(), speed.begin()); }

    double distance_at(double t) const {
        t = std::clamp(t, start(), stop());
        const std::size_t k = row_at(t);
        const double since = t - time[k];
        return distance[k] + speed[k] * since + 0.5 * slope(k) * since * since;
    }

    double speed_at(double t) const {
        if (t >= stop()) return speed.back();
        t = std::max(t, start());
        const std::size_t k = row_at(t);
        return speed[k] + slope(k) * (t - time[k]);
    }

    /// Of values that hold at the times of the rows, linear in between; before and after the ends.
    double value_at(const Array<double>& values, double t) const {
        if (t >= stop()) return values.back();
        const std::size_t k = row_at(std::max(t, start()));
        const double length = time[k + 1] - time[k];
        const double share = length > 0.0 ? std::clamp((t - time[k]) / length, 0.0, 1.0) : 1.0;
        return values[k] + share * (values[k + 1] - values[k]);
    }

    /// When the distance is first reached; never: infinity.
    double time_at(double s) const {
        const auto reached = std::lower_bound(distance.begin() + 1, distance.end(), s);
        if (reached == distance.end()) return std::numeric_limits<double>::infinity();
        const auto k = static_cast<std::size_t>(reached - distance.begin()) - 1;
        const double rest = s - distance[k], a = slope(k), u = speed[k];
        // The root of u tau + a tau^2/2 = rest that loses no digits.
        if (a == 0.0) return time[k] + rest / u;
        return time[k] + 2.0 * rest / (u + std::sqrt(std::max(0.0, u * u + 2.0 * a * rest)));
    }

private:
    /// The row from which time t is reached; of rows at the same time the last.
    std::size_t row_at(double t) const {
        const auto later = std::upper_bound(time.begin(), time.end() - 1, t);
        return static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, later - time.begin())) - 1;
    }

    double slope(std::size_t k) const {
        const double length = time[k + 1] - time[k];
        return length > 0.0 ? (speed[k + 1] - speed[k]) / length : 0.0;
    }
};

}  // namespace doseki
