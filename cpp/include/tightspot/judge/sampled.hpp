// How near a body part comes to everything at given poses.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "tightspot/judge/barriers.hpp"

namespace tightspot::judge {

/// The signed distance of the part from each obstacle at each pose, m, one pose after the other. Where bounding boxes
/// are farther apart than `far`, it is the distance of the boxes, which is no larger.
inline std::vector<double> sampled_clearances(const Outline& part, const std::vector<Pose>& poses,
                                              const Obstacles& obstacles, double far) {
    std::vector<double> found;
    found.reserve(poses.size() * obstacles.outlines.size());
    Outline placed;
    for (const Pose& pose : poses) {
        place(part, Placement::of(pose), placed);
        const Box box = Box::of(placed.vertices);
        for (int i = 0; i < obstacles.size(); ++i) {
            const double apart = obstacles.boxes[i].distance(box);
            found.push_back(apart > far ? apart : best_line(placed, obstacles.outlines[i]).clearance);
        }
    }
    return found;
}

/// How far the part is inside each wall at each pose, m; negative outside.
inline std::vector<double> sampled_depths(const Outline& part, const std::vector<Pose>& poses, const Walls& walls) {
    std::vector<double> found;
    Outline placed;
    for (const Pose& pose : poses) {
        place(part, Placement::of(pose), placed);
        for (int i = 0; i < walls.size(); ++i) found.push_back(walls.line(i, placed).clearance);
    }
    return found;
}

/// A body part at samples of a motion; those of interval k are `first[k]` to `first[k + 1]`, both included.
struct SampledPart {
    const Outline& part;
    std::vector<std::size_t> first;
    std::vector<Placement> placements;
    std::vector<Box> boxes;
    Box whole;  ///< around all of them

    SampledPart(const Outline& of, const std::vector<Pose>& poses, std::vector<std::size_t> first_of_intervals)
        : part(of), first(std::move(first_of_intervals)), whole(Box::of({})) {
        placements.reserve(poses.size()), boxes.reserve(poses.size());
        for (const Pose& pose : poses) {
            placements.push_back(Placement::of(pose));
            boxes.push_back(Box::of(corners(placements.size() - 1)));
            whole.add(boxes.back());
        }
    }

    std::size_t intervals() const { return first.size() - 1; }

    const std::vector<Point>& corners(std::size_t sample) {
        corners_.clear();
        for (const Point& p : part.vertices) corners_.push_back(placements[sample].moved(p));
        return corners_;
    }

    /// Smallest normal . p over the part.
    double lowest(Point normal, std::size_t sample) const {
        const Placement& at = placements[sample];
        const Point local{at.cos * normal.x + at.sin * normal.y, at.cos * normal.y - at.sin * normal.x};
        return judge::lowest(local, part.vertices) + dot(normal, {at.x, at.y});
    }

private:
    std::vector<Point> corners_;
};

/// The smallest clearance of a part from an obstacle on each interval, m, both of its ends included. What is farther
/// than `far` at a sample counts with the distance of the boxes. The ends are looked at first: the line of the nearer
/// one shows of most samples between them that they are no nearer.
template <class Keep>
void least_clearances(const SampledPart& body, const Obstacles& obstacles, int obstacle, double far, Keep&& keep) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Outline placed;
    const auto look = [&](std::size_t sample, double enough, Line& line) {
        const double apart = obstacles.boxes[obstacle].distance(body.boxes[sample]);
        if (apart > far || (apart > 0 && apart >= enough)) return apart;
        if (body.lowest(line.normal, sample) - line.support >= enough) return enough;
        place(body.part, body.placements[sample], placed);
        line = obstacles.line(obstacle, placed);
        return line.clearance;
    };
    Line after{{}, infinity, 0};  // shows nothing
    double at_end = look(0, infinity, after);
    for (std::size_t k = 0; k < body.intervals(); ++k) {
        const Line before = after;
        const double at_start = at_end;
        at_end = look(body.first[k + 1], infinity, after);
        Line nearer = at_start < at_end ? before : after;
        double least = std::min(at_start, at_end);
        for (std::size_t s = body.first[k] + 1; s < body.first[k + 1]; ++s)
            least = std::min(least, look(s, least, nearer));
        keep(k, least);
    }
}

/// The smallest distance of a part inside a wall on each interval, m, both of its ends included.
template <class Keep>
void least_depths(SampledPart& body, const Walls& walls, Keep&& keep) {
    const std::size_t edges = walls.normals.size();
    std::vector<double> depths;
    depths.reserve(body.placements.size() * edges);
    for (std::size_t s = 0; s < body.placements.size(); ++s) {
        const std::vector<Point>& corners = body.corners(s);
        for (std::size_t w = 0; w < edges; ++w) depths.push_back(lowest(walls.normals[w], corners) - walls.supports[w]);
    }
    for (std::size_t k = 0; k < body.intervals(); ++k)
        for (std::size_t w = 0; w < edges; ++w) {
            double least = depths[body.first[k] * edges + w];
            for (std::size_t s = body.first[k] + 1; s <= body.first[k + 1]; ++s)
                least = std::min(least, depths[s * edges + w]);
            keep(k, w, least);
        }
}

/// How near a body comes to everything on each interval of a motion.
struct Nearness {
    std::vector<int> near;           ///< obstacles whose boxes a part's whole motion comes as near to as asked for
    std::vector<double> apart;       ///< from each part's whole motion to each obstacle by boxes, m, part after part
    std::vector<double> clearances;  ///< smallest to the near ones, m: interval after interval, part after part
    std::vector<double> depths;      ///< smallest inside each wall, m: the same
};

/// Of parts at the same samples; see `least_clearances`.
inline Nearness nearness(std::vector<SampledPart>& bodies, const Obstacles& obstacles, const Walls& walls, double far) {
    const std::size_t all = obstacles.boxes.size(), parts = bodies.size(), edges = walls.normals.size();
    Nearness found;
    for (const SampledPart& body : bodies)
        for (const Box& box : obstacles.boxes) found.apart.push_back(box.distance(body.whole));
    for (std::size_t j = 0; j < all; ++j) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < parts; ++i) least = std::min(least, found.apart[i * all + j]);
        if (least <= far) found.near.push_back(static_cast<int>(j));
    }
    const std::size_t near = found.near.size(), intervals = bodies.front().intervals();
    found.clearances.resize(intervals * parts * near), found.depths.resize(intervals * parts * edges);
    for (std::size_t i = 0; i < parts; ++i) {
        for (std::size_t j = 0; j < near; ++j)
            least_clearances(bodies[i], obstacles, found.near[j], far, [&](std::size_t k, double least) {
                found.clearances[(k * parts + i) * near + j] = least;
            });
        least_depths(bodies[i], walls, [&](std::size_t k, std::size_t w, double least) {
            found.depths[(k * parts + i) * edges + w] = least;
        });
    }
    return found;
}

}  // namespace tightspot::judge
