// The kinematic single-track model as the judge knows it: written for the judge alone, apart from the solver's.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "tightspot/judge/motion.hpp"

namespace tightspot::judge {

/// State (x, y, theta, v, delta), input (a, omega): x' = v cos(theta), y' = v sin(theta), theta' = v tan(delta) / L,
/// v' = a, delta' = omega.
struct SingleTrack {
    static constexpr int states = 5, inputs = 2, frames = 1, parameters = 1;

    double wheelbase;  // L, m

    explicit SingleTrack(const double* p) : wheelbase(p[0]) {}

    void rates(const double* x, const double* u, double* f) const {
        f[0] = x[3] * std::cos(x[2]), f[1] = x[3] * std::sin(x[2]), f[2] = x[3] * std::tan(x[4]) / wheelbase;
        f[3] = u[0], f[4] = u[1];
    }

    Pose frame(const double* x, int) const { return {x[0], x[1], x[2]}; }

    /// On an interval with input u between two states. v and delta are linear in time, so that their absolute values
    /// are largest at an end; beyond 90 degrees of steering nothing is bounded.
    Bounds bounds(const double* before, const double* after, const double* u, int) const {
        const double speed = std::max(std::abs(before[3]), std::abs(after[3]));
        const double steering = std::max(std::abs(before[4]), std::abs(after[4]));
        const double a = std::abs(u[0]), omega = std::abs(u[1]);
        constexpr double right_angle = 1.57079632679489661923, unbounded = std::numeric_limits<double>::infinity();
        if (!(steering < right_angle)) return {unbounded, unbounded, unbounded};
        const double tangent = std::tan(steering), yaw_rate = speed * tangent / wheelbase;
        return {yaw_rate, std::hypot(a, speed * yaw_rate),
                (a * tangent + speed * omega * (1 + tangent * tangent)) / wheelbase};
    }
};

}  // namespace tightspot::judge
