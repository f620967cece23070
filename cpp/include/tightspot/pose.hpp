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

/// The straight line to an arc's end: its signed length, and the angle from the heading to it, half of the arc's turn.
struct Chord {
    double length, half_turn;

    explicit Chord(Arc arc) : length(arc.length), half_turn(0.5 * arc.length * arc.curvature) {
        length *= std::abs(half_turn) < 1e-4 ? 1.0 - half_turn * half_turn / 6.0 : std::sin(half_turn) / half_turn;
    }

    /// From its start to its end, if it starts with that heading.
    Point shift(double heading) const {
        const double direction = heading + half_turn;
        return {length * std::cos(direction), length * std::sin(direction)};
    }

    Pose end(const Pose& start, Point shift) const {
        return {start.x + shift.x, start.y + shift.y, start.theta + 2.0 * half_turn};
    }
};

/// The pose after driving along `arc` from `pose`; the heading is not wrapped.
inline Pose advance(const Pose& pose, Arc arc) {
    const Chord chord(arc);
    return chord.end(pose, chord.shift(pose.theta));
}

/// `target` as seen from `origin`: position in its frame, heading relative to it and wrapped.
inline Pose relative(const Pose& origin, const Pose& target) {
    const double c = std::cos(origin.theta), s = std::sin(origin.theta);
    const double dx = target.x - origin.x, dy = target.y - origin.y;
    return {c * dx + s * dy, -s * dx + c * dy, wrap_angle(target.theta - origin.theta)};
}

}  // namespace tightspot
