// What the body must stay clear of; each barrier offers a line for a body part somewhere.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "tightspot/judge/outline.hpp"

namespace tightspot::judge {

/// Convex obstacle parts; the line is the best separating one.
struct Obstacles {
    std::vector<Outline> outlines;
    std::vector<Box> boxes;

    explicit Obstacles(std::vector<Outline> all) : outlines(std::move(all)) {
        for (const Outline& outline : outlines) boxes.push_back(Box::of(outline.vertices));
    }

    int size() const { return static_cast<int>(outlines.size()); }

    Line line(int barrier, const Outline& body) const { return best_line(body, outlines[barrier]); }

    /// No more than the clearance of anything in the box; minus infinity if nothing can be said so cheaply.
    double at_least(int barrier, const Box& box) const {
        const double distance = boxes[barrier].distance(box);
        return distance > 0 ? distance : -std::numeric_limits<double>::infinity();
    }
};

/// Edges of the workspace: the barrier is what lies beyond, so the line is the edge.
struct Walls {
    std::vector<Point> normals;    // to the inside
    std::vector<double> supports;  // the inside is normal . q >= support

    int size() const { return static_cast<int>(normals.size()); }

    Line line(int barrier, const Outline& body) const {
        const Point n = normals[barrier];
        return {n, supports[barrier], lowest(n, body.vertices) - supports[barrier]};
    }

    double at_least(int barrier, const Box& box) const {
        const Point n = normals[barrier];
        return n.x * (n.x > 0 ? box.left : box.right) + n.y * (n.y > 0 ? box.bottom : box.top) - supports[barrier];
    }
};

}  // namespace tightspot::judge
