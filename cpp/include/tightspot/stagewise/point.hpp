// Iterates: variables, slacks and multipliers, and the bounds on variables.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tightspot/stagewise/problem.hpp"

namespace tightspot::stagewise {

// side * (v[index] - value) >= 0.
struct Bound {
    int index;
    double side, value;

    double slack(const Vector& v) const { return side * (v[index] - value); }
};

// The bounds on free variables: x_0 and x_N where start and goal leave them free, all other states, inputs, t_f.
inline std::vector<Bound> bounds_of(const Problem& problem, const Layout& layout) {
    std::vector<Bound> bounds;
    const auto add = [&](int index, double low, double high) {
        if (std::isfinite(low)) bounds.push_back({index, 1.0, low});
        if (std::isfinite(high)) bounds.push_back({index, -1.0, high});
    };
    for (int k = 0; k <= layout.steps; ++k)
        for (int i = 0; i < layout.nx; ++i) {
            const bool fixed = (k == 0 && !std::isnan(problem.start[i])) ||
                               (k == layout.steps && !std::isnan(problem.goal[i]));
            if (!fixed) add(layout.x(k) + i, problem.state_low[i], problem.state_high[i]);
        }
    for (int k = 0; k < layout.steps; ++k)
        for (int i = 0; i < layout.nu; ++i) add(layout.u(k) + i, problem.input_low[i], problem.input_high[i]);
    if (problem.free_time()) add(layout.time, problem.time_low, problem.time_high);
    return bounds;
}

// A value moved inside its bounds, by `push` relative to their size or distance.
inline double inside(double value, double low, double high, double push) {
    const double width = high - low;
    const double below = std::min(push * std::max(1.0, std::abs(low)), push * width);
    const double above = std::min(push * std::max(1.0, std::abs(high)), push * width);
    if (std::isfinite(low)) value = std::max(value, low + below);
    if (std::isfinite(high)) value = std::min(value, high - above);
    return value;
}

struct Point {
    Vector v, s;            // variables; slacks of the rows
    Vector lam, nu;         // multipliers of dynamics and goal
    Vector z, zb;           // multipliers of rows and bounds
    Vector sb;              // slacks of the bounds, by v alone: see settle_bounds

    void allocate(const Layout& layout, std::size_t bounds) {
        v.assign(layout.variables, 0), s.assign(layout.rows, 1);
        lam.assign(layout.steps * layout.nx, 0), nu.assign(layout.nx, 0);
        z.assign(layout.rows, 1), zb.assign(bounds, 1), sb.assign(bounds, 1);
    }

    void settle_bounds(const std::vector<Bound>& bounds) {
        for (std::size_t i = 0; i < bounds.size(); ++i) sb[i] = bounds[i].slack(v);
    }
};

}  // namespace tightspot::stagewise
