// Paths as samples.
#pragma once

#include <cmath>
#include <vector>

#include "tightspot/motion_cost.hpp"

namespace tightspot {

struct Sample {
    Pose pose;
    double curvature;  ///< of the arc that leads here
    int gear;          ///< +1 forwards, -1 in reverse
};

/// Poses along `arcs` at most `spacing` apart, the ends of every arc among them; the first is `start`.
inline std::vector<Sample> sample(const Pose& start, const std::vector<Arc>& arcs, double spacing) {
    std::vector<Sample> samples;
    const Arc first = arcs.empty() ? Arc{} : arcs.front();
    samples.push_back({start, first.curvature, MotionCost::gear(first)});
    Pose from = start;
    for (const Arc& arc : arcs) {
        const int count = std::max(1, static_cast<int>(std::ceil(std::abs(arc.length) / spacing - 1e-9)));
        for (int i = 1; i <= count; ++i)
            samples.push_back(
                {advance(from, {arc.length * i / count, arc.curvature}), arc.curvature, MotionCost::gear(arc)});
        from = samples.back().pose;
    }
    return samples;
}

}  // namespace tightspot
