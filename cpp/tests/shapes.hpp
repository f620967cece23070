// Scenes that several tests use.
#pragma once

#include <vector>

#include "tightspot/collision.hpp"
#include "tightspot/hybrid_astar.hpp"

namespace shapes {

using namespace tightspot;

inline Polygon rectangle(double x_min, double x_max, double y_min, double y_max) {
    return Polygon({{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}});
}

/// 4.628 m x 2.097 m, 0.929 m of it behind the rear axle.
inline Footprint car() { return Footprint({rectangle(-0.929, 3.699, -1.0485, 1.0485)}); }

/// A slot of the given width between two obstacles below a road.
inline CollisionChecker slot(double width, double margin) {
    const double middle = 6.3;
    return CollisionChecker(car(), rectangle(-2, 15, -8, 8),
                            {rectangle(0, middle - width / 2, -8, -2), rectangle(middle + width / 2, 15, -8, -2)},
                            margin);
}

inline SearchOptions options() {
    SearchOptions options;
    options.full_curvature = 0.285;
    options.cost.full_curvature = 0.285;
    return options;
}

inline Pose end_of(const Pose& start, const std::vector<Arc>& arcs) {
    Pose pose = start;
    for (const Arc& arc : arcs) pose = advance(pose, arc);
    return pose;
}

}  // namespace shapes
