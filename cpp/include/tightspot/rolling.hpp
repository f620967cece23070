// Times for a path of arcs: from rest to rest between gear changes, with the wheels turning on the way.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tightspot/pose.hpp"

namespace tightspot {

/// What the vehicle can do; lengths in m, angles in rad, times in s.
struct RollingLimits {
    double wheelbase, steering, steering_rate;
    double forwards, backwards;          ///< largest speeds, both positive
    double slowest, fastest;             ///< bounds of the acceleration
    double half_window;                  ///< of the path to either side of a pose, over which steering is averaged
};

/// Speeds below this part of the largest are none: a crawl.
constexpr double crawl = 1e-3;

/// A path of poses driven pose after pose: knots (t, v, delta) at the poses, and the inputs (a, omega) between them.
class Rolling {
   public:
    /// Of poses that all differ from the ones before; of each way between two of them its length, gear (+1 or -1) and
    /// curvature. The steering angles `first` and `last` are taken from the path where they are NaN.
    Rolling(const std::vector<double>& ways, const std::vector<double>& gears, const std::vector<double>& curvatures,
            double first, double last, const RollingLimits& limits)
        : limits_(limits), ways_(ways), gears_(gears), s_(1, 0.0) {
        std::vector<double> wanted;
        for (std::size_t i = 0; i < ways.size(); ++i) {
            s_.push_back(s_.back() + ways[i]);
            wanted.push_back(std::atan(curvatures[i] * limits.wheelbase));
        }
        steer(wanted, std::isnan(first) ? wanted.front() : first, std::isfinite(last) ? last : wanted.back());
        time();
    }

    std::vector<double> t, v, delta, a, omega;

   private:
    // The mean of the piecewise constant angle over the window, led to the first and the last angle at the ends.
    void steer(const std::vector<double>& wanted, double first, double last) {
        const double half = std::min(limits_.half_window, s_.back() / 2), end = s_.back();
        std::vector<double> edges(1, -half), values(1, first), integral(1, 0.0);
        edges.insert(edges.end(), s_.begin(), s_.end()), edges.push_back(end + half);
        values.insert(values.end(), wanted.begin(), wanted.end()), values.push_back(last);
        for (std::size_t i = 0; i < values.size(); ++i)
            integral.push_back(integral.back() + values[i] * (edges[i + 1] - edges[i]));
        std::size_t below = 0, above = 0;
        const auto at = [&](double where, std::size_t& i) {
            while (i + 2 < edges.size() && edges[i + 1] <= where) ++i;
            return where >= edges.back() ? integral.back() : integral[i] + values[i] * (where - edges[i]);
        };
        for (double s : s_) {
            const double upper = at(s + half, above);
            delta.push_back((upper - at(s - half, below)) / (2 * half));
        }
        const double lead = first - delta.front(), tail = last - delta.back();
        for (std::size_t k = 0; k < s_.size(); ++k) {
            delta[k] += lead * std::max(1 - s_[k] / half, 0.0) + tail * std::max(1 - (end - s_[k]) / half, 0.0);
            delta[k] = std::min(std::max(delta[k], -limits_.steering), limits_.steering);
        }
    }

    // How far each knot is from the nearest stop along the path.
    std::vector<double> room() const {
        std::vector<double> found(s_.size());
        const std::size_t last = gears_.size();
        std::size_t before = 0;
        for (std::size_t k = 0; k <= last; ++k) {
            if (stops(k)) before = k;
            found[k] = s_[k] - s_[before];
        }
        for (std::size_t k = last + 1, after = last; k-- > 0;) {
            if (stops(k)) after = k;
            found[k] = std::min(found[k], s_[after] - s_[k]);
        }
        return found;
    }

    bool stops(std::size_t k) const { return k == 0 || k == gears_.size() || gears_[k] != gears_[k - 1]; }

    // A trapezoid of speed over each stretch of one gear, slower where the wheels take longer to swing.
    void time() {
        const std::size_t count = ways_.size();
        const double rate = std::min(limits_.fastest, -limits_.slowest);
        std::vector<double> ramp = room(), mean(count), durations(count);
        for (double& r : ramp) r = std::sqrt(2 * rate * r);
        for (std::size_t k = 0; k < count; ++k) {
            const double top = gears_[k] > 0 ? limits_.forwards : limits_.backwards;
            const double swing = std::abs(delta[k + 1] - delta[k]);
            mean[k] = std::min(top, (ramp[k + 1] + ramp[k]) / 2);
            mean[k] = std::min(mean[k], limits_.steering_rate * ways_[k] / std::max(swing, 1e-12));
            mean[k] = std::max(mean[k], crawl * top);
            durations[k] = std::max(ways_[k] / mean[k], swing / limits_.steering_rate);
        }
        t.push_back(0.0);
        for (std::size_t k = 0; k <= count; ++k) {
            if (k < count) t.push_back(t.back() + durations[k]);
            v.push_back(stops(k) ? 0.0 : gears_[k] * std::min(mean[k], mean[k - 1]));
        }
        const auto clipped = [](double value, double low, double high) { return std::min(std::max(value, low), high); };
        for (std::size_t k = 0; k < count; ++k) {
            a.push_back(clipped((v[k + 1] - v[k]) / durations[k], limits_.slowest, limits_.fastest));
            omega.push_back(clipped((delta[k + 1] - delta[k]) / durations[k], -limits_.steering_rate, limits_.steering_rate));
        }
    }

    RollingLimits limits_;
    const std::vector<double>&ways_, &gears_;
    std::vector<double> s_;
};

}  // namespace tightspot
