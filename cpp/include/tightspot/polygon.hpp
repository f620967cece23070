// Convex polygons with their edges, and how far apart two of them are.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "tightspot/pose.hpp"

namespace tightspot {

/// Counter-clockwise vertices; edge i leads from vertex i to vertex i + 1 and lies on normal . q = offset, the unit
/// normal pointing out.
struct Polygon {
    std::vector<Point> vertices;
    std::vector<Point> normals;
    std::vector<double> offsets;

    Polygon() = default;

    /// Vertices of a convex polygon in either winding; repeated ones are dropped.
    explicit Polygon(const std::vector<Point>& points) {
        vertices.reserve(points.size());
        for (const Point& p : points)
            if (vertices.empty() || std::hypot(p.x - vertices.back().x, p.y - vertices.back().y) > 1e-12)
                vertices.push_back(p);
        while (vertices.size() > 1 &&
               std::hypot(vertices.front().x - vertices.back().x, vertices.front().y - vertices.back().y) <= 1e-12)
            vertices.pop_back();
        if (vertices.size() < 3) throw std::invalid_argument("a polygon needs at least three distinct vertices");
        if (doubled_area() < 0.0) std::reverse(vertices.begin(), vertices.end());
        normals.reserve(vertices.size()), offsets.reserve(vertices.size());
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const Point a = vertices[i], b = vertices[(i + 1) % vertices.size()];
            const double length = std::hypot(b.x - a.x, b.y - a.y);
            const Point normal{(b.y - a.y) / length, -(b.x - a.x) / length};
            normals.push_back(normal);
            offsets.push_back(dot(normal, a));
        }
    }

    std::size_t size() const { return vertices.size(); }

    double doubled_area() const {
        double sum = 0.0;
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const Point a = vertices[i], b = vertices[(i + 1) % vertices.size()];
            sum += a.x * b.y - b.x * a.y;
        }
        return sum;
    }
};

/// Writes the vertices of `local`, moved to `pose`, into `placed`, which must have as many.
inline void place_vertices(const Polygon& local, const Pose& pose, double cosine, double sine, Polygon& placed) {
    for (std::size_t i = 0; i < local.size(); ++i) {
        const Point v = local.vertices[i];
        placed.vertices[i] = {pose.x + cosine * v.x - sine * v.y, pose.y + sine * v.x + cosine * v.y};
    }
}

/// The same for the edges.
inline void place_edges(const Polygon& local, const Pose& pose, double cosine, double sine, Polygon& placed) {
    for (std::size_t i = 0; i < local.size(); ++i) {
        const Point n = local.normals[i];
        placed.normals[i] = {cosine * n.x - sine * n.y, sine * n.x + cosine * n.y};
        placed.offsets[i] = local.offsets[i] + placed.normals[i].x * pose.x + placed.normals[i].y * pose.y;
    }
}

/// Both.
inline void place(const Polygon& local, const Pose& pose, double cosine, double sine, Polygon& placed) {
    place_vertices(local, pose, cosine, sine, placed);
    place_edges(local, pose, cosine, sine, placed);
}

/// The distance from an edge line of `a` to the nearest vertex of `b`; negative if that is behind it.
inline double beyond_edge(const Polygon& a, std::size_t edge, const Polygon& b) {
    double nearest = HUGE_VAL;
    for (const Point& q : b.vertices) nearest = std::min(nearest, dot(a.normals[edge], q));
    return nearest - a.offsets[edge];
}

/// The largest distance from an edge line of `a` to the nearest vertex of `b`, stopping early once above `enough`.
inline double edge_separation(const Polygon& a, const Polygon& b, double enough) {
    double best = -HUGE_VAL;
    for (std::size_t i = 0; i < a.size() && best < enough; ++i) best = std::max(best, beyond_edge(a, i, b));
    return best;
}

/// Separating-axis test over both polygons' normals. Negative: minus the penetration depth. Positive: a lower bound
/// of the distance, exact unless vertex faces vertex. Stops early once above `enough`.
inline double axis_separation(const Polygon& a, const Polygon& b, double enough = HUGE_VAL) {
    const double first = edge_separation(a, b, enough);
    return first >= enough ? first : std::max(first, edge_separation(b, a, enough));
}

/// Distance of a point to the segment from `a` to `b`.
inline double segment_distance(Point q, Point a, Point b) {
    const Point d{b.x - a.x, b.y - a.y}, r{q.x - a.x, q.y - a.y};
    const double t = std::clamp(dot(r, d) / dot(d, d), 0.0, 1.0);
    return std::hypot(r.x - t * d.x, r.y - t * d.y);
}

/// Distance of a point to the polygon, 0 inside.
inline double point_distance(const Polygon& polygon, Point q) {
    bool inside = true;
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        if (dot(polygon.normals[i], q) <= polygon.offsets[i]) continue;
        inside = false;
        nearest =
            std::min(nearest, segment_distance(q, polygon.vertices[i], polygon.vertices[(i + 1) % polygon.size()]));
    }
    return inside ? 0.0 : nearest;
}

/// Distance of two polygons that do not overlap.
inline double disjoint_distance(const Polygon& a, const Polygon& b) {
    double nearest = HUGE_VAL;
    for (const Point& q : a.vertices) nearest = std::min(nearest, point_distance(b, q));
    for (const Point& q : b.vertices) nearest = std::min(nearest, point_distance(a, q));
    return nearest;
}

/// Signed distance: the distance, or minus the penetration depth.
inline double signed_distance(const Polygon& a, const Polygon& b) {
    const double axis = axis_separation(a, b);
    return axis > 0.0 ? disjoint_distance(a, b) : axis;
}

}  // namespace tightspot
