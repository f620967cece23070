// Poses, circular arcs, and moving along them.
#pragma once

#include <cmath>

namespace tightspot {

constexpr double pi = 3.14159265358979323846;

struct Point {
    double x = 0.0;
    double y = 0.0;
};

inline double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }

/// The rear-axle midpoint in m and the heading in rad.
struct Pose {
    double x = 0.0;
    double y = 0.0;
    double theta = 0.0;
};

/// A stretch of constant curvature (1/m, positive to the left). A negative length is driven in reverse.
struct Arc {
    double length = 0.0;
    double curvature = 0.0;
};

/// The angle modulo 2 pi in [-pi, pi].
inline double wrap_angle(double angle) { return std::remainder(angle, 2.0 * pi); }

/// The pose after driving along `arc` from `pose`; the heading is not wrapped.
inline Pose advance(const Pose& pose, Arc arc) {
    const double half_turn = 0.5 * arc.length * arc.curvature;
    const double sinc =
        std::abs(half_turn) < 1e-4 ? 1.0 - half_turn * half_turn / 6.0 : std::sin(half_turn) / half_turn;
    const double chord = arc.length * sinc;
    const double direction = pose.theta + half_turn;
    return {pose.x + chord * std::cos(direction), pose.y + chord * std::sin(direction), pose.theta + 2.0 * half_turn};
}

/// `target` as seen from `origin`: position in its frame, heading relative to it and wrapped.
inline Pose relative(const Pose& origin, const Pose& target) {
    const double c = std::cos(origin.theta), s = std::sin(origin.theta);
    const double dx = target.x - origin.x, dy = target.y - origin.y;
    return {c * dx + s * dy, -s * dx + c * dy, wrap_angle(target.theta - origin.theta)};
}

}  // namespace tightspot
