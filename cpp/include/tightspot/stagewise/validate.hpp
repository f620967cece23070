// What a problem must fulfil before it is solved; after this no index is out of range and no number is not one.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "tightspot/stagewise/problem.hpp"

namespace tightspot::stagewise {

namespace detail {

inline bool all_finite(const Vector& values) {
    for (double value : values)
        if (!std::isfinite(value)) return false;
    return true;
}

inline bool sound(const Polygons& polygons) {
    if (polygons.first.empty() || polygons.first.front() != 0) return false;
    for (int i = 0; i < polygons.size(); ++i)
        if (polygons.count(i) < 1) return false;
    const std::size_t count = static_cast<std::size_t>(polygons.first.back());
    return polygons.x.size() == count && polygons.y.size() == count && all_finite(polygons.x) && all_finite(polygons.y);
}

inline bool in_order(const Vector& low, const Vector& high, std::size_t size) {
    if (low.size() != size || high.size() != size) return false;
    for (std::size_t i = 0; i < size; ++i)
        if (!(low[i] < high[i]) || !(low[i] < 1e300) || !(high[i] > -1e300)) return false;
    return true;
}

inline bool finite_or_free(const Vector& values, std::size_t size) {
    if (values.size() != size) return false;
    for (double value : values)
        if (std::isinf(value)) return false;
    return true;
}

// A penetration must cost something at every t_f.
inline bool sound(const Penalty& penalty, double time_low) {
    return penalty.constant >= 0 && penalty.timed >= 0 && std::isfinite(penalty.constant + penalty.timed) &&
           penalty.at(time_low) > 0;
}

template <class Item>
bool sorted_within(const std::vector<Item>& items, int steps, int parts) {
    int last = 0;
    for (const Item& item : items) {
        if (item.interval < 0 || item.interval >= steps || item.part < 0 || item.part >= parts) return false;
        const int key = item.interval * parts + item.part;
        if (key < last) return false;
        last = key;
    }
    return true;
}

inline bool sound_demands(const std::vector<Demand>& demands, std::size_t size) {
    if (demands.size() != size) return false;
    for (const Demand& demand : demands)
        if (demand.used && !(std::isfinite(demand.constant) && std::isfinite(demand.weight))) return false;
    return true;
}

}  // namespace detail

// Empty if the problem is sound, otherwise which of its fields is not.
inline std::string flaw(const Problem& problem, int nx, int nu, int parameters) {
    using namespace detail;
    const std::size_t n = problem.steps > 0 ? static_cast<std::size_t>(problem.steps) : 0;
    const std::size_t states = static_cast<std::size_t>(nx), inputs = static_cast<std::size_t>(nu);
    if (n == 0) return "widths";
    if (problem.widths.size() != n || !all_finite(problem.widths)) return "widths";
    for (double width : problem.widths)
        if (!(width > 0)) return "widths";
    std::size_t samples = 0;
    if (problem.pieces.size() != n) return "pieces";
    if (problem.substeps.size() != n) return "substeps";
    for (std::size_t k = 0; k < n; ++k) {
        if (problem.pieces[k] < 1 || problem.pieces[k] > 1000) return "pieces";
        if (problem.substeps[k] < 1 || problem.substeps[k] > 1000) return "substeps";
        samples += static_cast<std::size_t>(problem.pieces[k]) + 1;
    }
    if (problem.parameters.size() != static_cast<std::size_t>(parameters) || !all_finite(problem.parameters))
        return "parameters";
    if (problem.input_weights.size() != inputs || !all_finite(problem.input_weights)) return "input_weights";
    if (!std::isfinite(problem.time_weight)) return "time_weight";
    if (!in_order(problem.state_low, problem.state_high, states)) return "state bounds";
    if (!in_order(problem.input_low, problem.input_high, inputs)) return "input bounds";
    if (!(problem.time_low <= problem.time_high && problem.time_low > 0 && std::isfinite(problem.time_low)))
        return "final time bounds";
    if (!finite_or_free(problem.start, states)) return "start";
    if (!finite_or_free(problem.goal, states)) return "goal";
    if (!sound(problem.parts) || problem.parts.size() < 1) return "part_vertices";
    if (!sound(problem.obstacles)) return "obstacle_vertices";
    if (problem.radii.size() != static_cast<std::size_t>(problem.parts.size()) || !all_finite(problem.radii))
        return "radii";
    if (!sorted_within(problem.pairs, problem.steps, problem.parts.size())) return "pairs";
    for (const Pair& pair : problem.pairs) {
        if (pair.obstacle < 0 || pair.obstacle >= problem.obstacles.size()) return "pairs";
        if (!std::isfinite(pair.origin[0] + pair.origin[1])) return "pair origins";
        if (!std::isfinite(pair.obstacle_side + pair.obstacle_weight)) return "pair sides";
        if (!std::isfinite(pair.extra)) return "pair_extras";
        if (pair.penalty.soft && !sound(pair.penalty, problem.time_low)) return "pair_penalties";
    }
    if (!sorted_within(problem.walls, problem.steps, problem.parts.size())) return "walls";
    for (const Wall& wall : problem.walls)
        if (!std::isfinite(wall.normal[0] + wall.normal[1] + wall.offset)) return "walls";
    if (!sound_demands(problem.pair_demands, samples)) return "pair_demands";
    if (!sound_demands(problem.wall_demands, samples)) return "wall_demands";
    for (const Motion& motion : problem.motions) {
        const bool known = motion.obstacle >= 0 && motion.obstacle < problem.obstacles.size();
        if (!known || problem.motion_of(motion.obstacle) != &motion) return "motion_obstacles";
        if (!std::isfinite(motion.time)) return "motion_times";
        if (motion.poses.size() != 3 * samples || !all_finite(motion.poses)) return "motion_poses";
        if (motion.slopes.size() != 3 * samples || !all_finite(motion.slopes)) return "motion_slopes";
    }
    return "";
}

}  // namespace tightspot::stagewise
