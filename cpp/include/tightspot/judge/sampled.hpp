// How near a body part comes to everything at given poses.
#pragma once

#include <limits>
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

}  // namespace tightspot::judge
