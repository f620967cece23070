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

    /// theta' in a state, rad/s.
    double turning(const double* x) const { return x[3] * std::tan(x[4]) / wheelbase; }

    /// One classical Runge-Kutta step of h seconds. The rates of v and delta are constant and those of theta depend on
    /// nothing else, so that the two stages in the middle turn equally fast, and a step begins as fast as the last ended.
    ///
    /// `turn`: theta' in the state x; on return, in the state after the step.
    void runge_kutta(const double* x, const double* u, double h, double& turn, double* after) const {
        const double half = 0.5 * h, v = x[3] + half * u[0];
        const double between = v * std::tan(x[4] + half * u[1]) / wheelbase;
        after[3] = x[3] + h * u[0], after[4] = x[4] + h * u[1];
        const double last = turning(after), start = x[2];
        const double second = start + half * turn, third = start + half * between, fourth = start + h * between;
        const double east = x[3] * std::cos(start) + 2 * v * (std::cos(second) + std::cos(third)) + after[3] * std::cos(fourth);
        const double north = x[3] * std::sin(start) + 2 * v * (std::sin(second) + std::sin(third)) + after[3] * std::sin(fourth);
        after[0] = x[0] + h / 6 * east, after[1] = x[1] + h / 6 * north;
        after[2] = start + h / 6 * (turn + 4 * between + last);
        turn = last;
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
