// The stagewise problem as plain numbers: what transcription/stage_problem.py builds.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "tightspot/stagewise/pack.hpp"

namespace tightspot::stagewise {

using Vector = std::vector<double>;
using Indices = std::vector<int>;

// Convex polygons, one after another: polygon i has the vertices first[i] to first[i + 1] - 1.
struct Polygons {
    Vector x, y;
    Indices first{0};

    int size() const { return static_cast<int>(first.size()) - 1; }
    int count(int i) const { return first[i + 1] - first[i]; }
};

// Clearance demanded at one sample pose, m: constant + weight * (the interval's cover for that part).
// Unused rows have `used` = 0.
struct Demand {
    double constant = 0, weight = 0;
    int used = 0;
};

// What a metre of penetration costs, constant + timed * t_f; pairs that may not penetrate have `soft` = 0.
struct Penalty {
    double constant = 0, timed = 0;
    int soft = 0;

    double at(double time) const { return constant + timed * time; }
};

// One body part against one obstacle part during one interval. Its line has a unit normal (cos phi, sin phi) and the
// offset mu, with coordinates relative to `origin`, which changes the numbers' conditioning and nothing else.
struct Pair {
    int interval = 0, part = 0, obstacle = 0;
    double origin[2] = {0, 0};
    double obstacle_side = 0, obstacle_weight = 0;  // the demand on the obstacle's side of the line
    double extra = 0;                               // what the body's side demands beyond the samples' demands
    Penalty penalty = {};
};

// How an obstacle part moves: its frame's pose (x, y, theta) at each sample is linear in t_f,
// poses + (t_f - time) slopes, three numbers a sample. Its vertices and its pairs' lines are in that frame.
struct Motion {
    int obstacle = 0;
    double time = 0;
    Vector poses, slopes;

    double at(int sample, int i, double final_time) const {
        return poses[3 * sample + i] + (final_time - time) * slopes[3 * sample + i];
    }
};

// Half-plane normal . q <= offset that one body part must stay in during one interval.
struct Wall {
    int interval = 0, part = 0;
    double normal[2] = {0, 0};
    double offset = 0;
};

// Variables: states x_0..x_N, inputs u_0..u_{N-1}, t_f, (phi, mu) of each pair, and the penetration sigma of each soft one.
//
//   minimise    time_weight t_f + (t_f or 1) sum_k widths[k] sum_i input_weights[i] u_k[i]^2 + sum penalty(t_f) sigma
//   subject to  x_{k+1} = F_k(x_k, u_k, t_f): pieces[k] * substeps[k] Runge-Kutta steps,
//               bounds, start and goal (NaN: free), walls and pairs.
//
// A pair whose obstacle part moves is written in that part's frame: V, n and mu there, and the part's own vertices.
//
// Samples of interval k: the state x_k, the states after each of its pieces but the last, and x_{k+1}. Rows of
// interval k, part by part: for every sample, wall and vertex, offset - normal . V - demand >= 0; then for every pair
// the obstacle's side, mu - side - n . O_j >= 0, and for every sample and vertex n . V - mu - demand >= 0; of a soft pair
// n . V - mu - demand + sigma >= 0 and, last, sigma >= 0. Pairs and walls are sorted by interval, then part.
struct Problem {
    int steps = 0;
    Vector widths;
    Indices pieces, substeps;
    Vector parameters;
    double time_weight = 0;
    Vector input_weights;
    bool time_scaled = true;
    Vector state_low, state_high, input_low, input_high;
    double time_low = 0, time_high = 0;
    Vector start, goal;
    Polygons parts, obstacles;
    Vector radii;
    std::vector<Pair> pairs;
    std::vector<Wall> walls;
    std::vector<Demand> pair_demands, wall_demands;  // by sample, all intervals
    std::vector<Motion> motions;                     // of the obstacle parts that move

    bool free_time() const { return time_low < time_high; }
    const Motion* motion_of(int obstacle) const {
        for (const Motion& motion : motions)
            if (motion.obstacle == obstacle) return &motion;
        return nullptr;
    }
};

// Consecutive intervals with equally many pieces and substeps, at most `lanes`, whose motion is computed at once.
struct Convoy {
    int first, count, pieces, substeps;
    int step;  // its first Runge-Kutta step among those of all convoys

    int steps() const { return pieces * substeps; }
};

// Where things are in the flat vectors.
struct Layout {
    int nx = 0, nu = 0, steps = 0;
    int input = 0, time = 0, line = 0, sigma = 0, variables = 0;  // offsets into the variables; their number
    int rows = 0;
    Indices sample, row;                      // first of each interval; N + 1 entries
    Indices pair, wall;                       // first of each (interval, part); N * parts + 1 entries
    Indices soft, soft_pairs;                 // each pair's place among the penetrations, -1: none; each penetration's pair
    Indices penetration;                      // first of each interval; N + 1 entries
    std::vector<Convoy> convoys;
    int convoy_steps = 0;

    int x(int k) const { return k * nx; }
    int u(int k) const { return input + k * nu; }
    int aux(int pair_index) const { return line + 2 * pair_index; }
};

inline void form_convoys(const Problem& problem, Layout& layout) {
    for (int k = 0; k < problem.steps; ++k) {
        Convoy* last = layout.convoys.empty() ? nullptr : &layout.convoys.back();
        if (last && last->count < lanes && last->pieces == problem.pieces[k] && last->substeps == problem.substeps[k]) {
            ++last->count;
            continue;
        }
        layout.convoys.push_back({k, 1, problem.pieces[k], problem.substeps[k], layout.convoy_steps});
        layout.convoy_steps += layout.convoys.back().steps();
    }
}

inline Layout layout_of(const Problem& problem, int nx, int nu) {
    Layout layout;
    const int n = problem.steps, parts = problem.parts.size();
    layout.nx = nx, layout.nu = nu, layout.steps = n;
    layout.input = (n + 1) * nx;
    layout.time = layout.input + n * nu;
    layout.line = layout.time + 1;
    layout.sigma = layout.line + 2 * static_cast<int>(problem.pairs.size());
    layout.sample.assign(1, 0), layout.row.assign(1, 0), layout.penetration.assign(1, 0);
    layout.pair.assign(1, 0), layout.wall.assign(1, 0);
    std::size_t pair = 0, wall = 0;
    for (int k = 0; k < n; ++k) {
        const int first = layout.sample.back(), samples = problem.pieces[k] + 1;
        layout.sample.push_back(first + samples);
        int wall_samples = 0, pair_samples = 0;
        for (int p = first; p < first + samples; ++p)
            wall_samples += problem.wall_demands[p].used, pair_samples += problem.pair_demands[p].used;
        for (int part = 0; part < parts; ++part) {
            for (; wall < problem.walls.size() && problem.walls[wall].interval == k && problem.walls[wall].part == part;
                 ++wall)
                layout.rows += wall_samples * problem.parts.count(part);
            for (; pair < problem.pairs.size() && problem.pairs[pair].interval == k && problem.pairs[pair].part == part;
                 ++pair) {
                const Pair& each = problem.pairs[pair];
                layout.soft.push_back(each.penalty.soft ? static_cast<int>(layout.soft_pairs.size()) : -1);
                if (each.penalty.soft) layout.soft_pairs.push_back(static_cast<int>(pair));
                layout.rows += problem.obstacles.count(each.obstacle) + pair_samples * problem.parts.count(part) +
                               (each.penalty.soft ? 1 : 0);
            }
            layout.wall.push_back(static_cast<int>(wall));
            layout.pair.push_back(static_cast<int>(pair));
        }
        layout.row.push_back(layout.rows);
        layout.penetration.push_back(static_cast<int>(layout.soft_pairs.size()));
    }
    layout.variables = layout.sigma + static_cast<int>(layout.soft_pairs.size());
    form_convoys(problem, layout);
    return layout;
}

}  // namespace tightspot::stagewise
