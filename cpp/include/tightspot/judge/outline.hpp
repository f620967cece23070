// Convex outlines and the line that separates two of them best.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "tightspot/pose.hpp"

namespace tightspot::judge {

/// A unit normal towards the body, the largest normal . o over the barrier, and how far the body lies beyond it, m.
struct Line {
    Point normal;
    double support = 0, clearance = 0;
};

inline Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }

/// Smallest normal . p over the points.
inline double lowest(Point normal, const std::vector<Point>& points) {
    double low = std::numeric_limits<double>::infinity();
    for (const Point& p : points) low = std::min(low, dot(normal, p));
    return low;
}

/// Counter-clockwise vertices, and the outward unit normals of the edges from each to the next; an edge without length
/// has the normal 0.
struct Outline {
    std::vector<Point> vertices, normals;

    Outline() = default;

    explicit Outline(std::vector<Point> points) : vertices(std::move(points)), normals(vertices.size()) {
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const Point edge = vertices[(i + 1) % vertices.size()] - vertices[i];
            const double length = std::hypot(edge.x, edge.y);
            if (length > 0) normals[i] = {edge.y / length, -edge.x / length};
        }
    }
};

/// Where a frame is.
struct Placement {
    double x, y, cos, sin;

    static Placement of(const Pose& pose) { return {pose.x, pose.y, std::cos(pose.theta), std::sin(pose.theta)}; }

    Point turned(Point p) const { return {cos * p.x - sin * p.y, sin * p.x + cos * p.y}; }

    Point moved(Point p) const { return {x + (cos * p.x - sin * p.y), y + (sin * p.x + cos * p.y)}; }
};

inline void place(const Outline& local, const Placement& at, Outline& placed) {
    placed.vertices.resize(local.vertices.size()), placed.normals.resize(local.normals.size());
    for (std::size_t i = 0; i < local.vertices.size(); ++i) {
        placed.vertices[i] = at.moved(local.vertices[i]);
        placed.normals[i] = at.turned(local.normals[i]);
    }
}

/// Tries the outward edge normals of `from`: keeps the one beyond whose edge `to` lies furthest, times `sign`.
inline void try_edges(const Outline& from, const Outline& to, double sign, Point& normal, double& gap) {
    for (std::size_t i = 0; i < from.normals.size(); ++i) {
        const Point n = from.normals[i], foot = from.vertices[i];
        if (n.x == 0 && n.y == 0) continue;
        double beyond = std::numeric_limits<double>::infinity();
        for (const Point& q : to.vertices) beyond = std::min(beyond, dot(n, q - foot));
        if (beyond > gap) gap = beyond, normal = {sign * n.x, sign * n.y};
    }
}

/// Tries the direction between the closest two vertices of disjoint outlines.
inline void try_vertices(const Outline& body, const Outline& barrier, Point& normal, double gap) {
    Point closest;
    double squared = std::numeric_limits<double>::infinity();
    for (const Point& p : body.vertices)
        for (const Point& q : barrier.vertices) {
            const Point apart = p - q;
            if (const double d = dot(apart, apart); d < squared) squared = d, closest = apart;
        }
    const double length = std::hypot(closest.x, closest.y);
    if (!(length > 0)) return;
    const Point n{closest.x / length, closest.y / length};
    const Point foot = barrier.vertices.front();
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (const Point& q : barrier.vertices) low = std::max(low, dot(n, q - foot));
    for (const Point& p : body.vertices) high = std::min(high, dot(n, p - foot));
    if (high - low > gap) normal = n;
}

/// The line that separates the body from the barrier best, in closed form: the normal that makes the signed distance
/// min(n . body) - max(n . barrier) largest is an edge normal of either or, if they are disjoint, the direction between
/// their closest vertices.
inline Line best_line(const Outline& body, const Outline& barrier) {
    Line line;
    double gap = -std::numeric_limits<double>::infinity();
    try_edges(barrier, body, 1, line.normal, gap);
    try_edges(body, barrier, -1, line.normal, gap);
    if (gap > 0) try_vertices(body, barrier, line.normal, gap);
    const Point n = line.normal, foot = barrier.vertices.front();
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    line.support = low;
    for (const Point& q : barrier.vertices)
        low = std::max(low, dot(n, q - foot)), line.support = std::max(line.support, dot(n, q));
    for (const Point& p : body.vertices) high = std::min(high, dot(n, p - foot));
    line.clearance = high - low;
    return line;
}

/// An axis-parallel box.
struct Box {
    double left, bottom, right, top;

    static Box of(const std::vector<Point>& points) {
        constexpr double far = std::numeric_limits<double>::infinity();
        Box box{far, far, -far, -far};
        for (const Point& p : points) box.add({p.x, p.y, p.x, p.y});
        return box;
    }

    void add(const Box& other) {
        left = std::min(left, other.left), bottom = std::min(bottom, other.bottom);
        right = std::max(right, other.right), top = std::max(top, other.top);
    }

    /// The distance to another one, 0 if they touch: no more than that of what is in them.
    double distance(const Box& other) const {
        const double x = std::max({left - other.right, other.left - right, 0.0});
        const double y = std::max({bottom - other.top, other.bottom - top, 0.0});
        return std::sqrt(x * x + y * y);
    }
};

}  // namespace tightspot::judge
