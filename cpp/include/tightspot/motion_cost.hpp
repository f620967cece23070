// What a path costs, in metres of straight driving forwards.
#pragma once

#include <cmath>
#include <vector>

#include "tightspot/pose.hpp"
#include "tightspot/reeds_shepp.hpp"

namespace tightspot {

/// The part of a vehicle's state that costs depend on: the last gear (0 at a standstill) and curvature.
struct Motion {
    int gear = 0;
    double curvature = 0.0;
};

struct MotionCost {
    double gear_change = 2.0;      ///< each change of direction
    double reverse = 1.0;          ///< factor on the way driven in reverse
    double steering = 0.1;         ///< further part of the way driven at full steering
    double steering_change = 0.5;  ///< from straight to full steering
    double full_curvature = 1.0;   ///< 1/m

    static int gear(Arc arc) { return arc.length < 0.0 ? -1 : 1; }

    double step(const Motion& before, Arc arc) const {
        const double way = std::abs(arc.length) * (arc.length < 0.0 ? reverse : 1.0);
        const double turned = std::abs(arc.curvature) / full_curvature;
        const double swung = std::abs(arc.curvature - before.curvature) / full_curvature;
        const bool changes = before.gear != 0 && before.gear != gear(arc);
        return way * (1.0 + steering * turned) + steering_change * swung + (changes ? gear_change : 0.0);
    }

    /// Turning the wheels back to straight at the end.
    double stop(const Motion& before) const { return steering_change * std::abs(before.curvature) / full_curvature; }

    /// Cost of the way, its gear changes and its steering, up to a standstill with straight wheels.
    double path(const std::vector<Arc>& arcs, Motion motion = {}) const {
        double sum = 0.0;
        for (const Arc& arc : arcs) {
            sum += step(motion, arc);
            motion = {gear(arc), arc.curvature};
        }
        return sum + stop(motion);
    }

    /// The same for a word; `time` is -1 if the word is driven from its end to its start.
    double word(const Word& word, double radius, Motion motion, int time) const {
        double sum = 0.0;
        for (int i = 0; i < word.size; ++i) {
            if (std::abs(word.lengths[i]) <= reeds_shepp::negligible) continue;
            Arc arc = word.arc(i, radius);
            arc.length *= time;
            sum += step(motion, arc);
            motion = {gear(arc), arc.curvature};
        }
        return sum + stop(motion);
    }

    /// A word's way and gear changes without its steering.
    double word_without_steering(const Word& word, double radius, int gear_before, int time) const {
        double sum = 0.0;
        int last = gear_before;
        for (int i = 0; i < word.size; ++i) {
            if (std::abs(word.lengths[i]) <= reeds_shepp::negligible) continue;
            const double length = word.lengths[i] * radius * time;
            const int now = length < 0.0 ? -1 : 1;
            sum += std::abs(length) * (now < 0 ? reverse : 1.0) + (last != 0 && last != now ? gear_change : 0.0);
            last = now;
        }
        return sum;
    }
};

/// Gears in which a path must begin and end: +1, -1, or 0 for either.
struct EndGears {
    int first = 0;
    int last = 0;

    /// Those of a word, in its own order; `time` is -1 if it is driven from its end to its start. 0 if it is empty.
    static EndGears of(const Word& word, int time) {
        EndGears gears;
        for (int i = 0; i < word.size; ++i) {
            if (std::abs(word.lengths[i]) <= reeds_shepp::negligible) continue;
            gears.last = word.lengths[i] * time < 0.0 ? -1 : 1;
            if (gears.first == 0) gears.first = gears.last;
        }
        return gears;
    }

    EndGears reversed() const { return {last, first}; }
    bool is_free() const { return first == 0 && last == 0; }
};

/// Joins neighbouring arcs of one curvature and gear, and drops arcs without length.
inline std::vector<Arc> merged(const std::vector<Arc>& arcs) {
    std::vector<Arc> joined;
    for (const Arc& arc : arcs) {
        if (std::abs(arc.length) <= 1e-12) continue;
        const bool continues = !joined.empty() && std::abs(joined.back().curvature - arc.curvature) < 1e-12 &&
                               MotionCost::gear(joined.back()) == MotionCost::gear(arc);
        if (continues) {
            joined.back().length += arc.length;
        } else {
            joined.push_back(arc);
        }
    }
    return joined;
}

/// The same path driven from its end to its start.
inline std::vector<Arc> reversed(const std::vector<Arc>& arcs) {
    std::vector<Arc> back;
    for (auto arc = arcs.rbegin(); arc != arcs.rend(); ++arc) back.push_back({-arc->length, arc->curvature});
    return back;
}

}  // namespace tightspot
