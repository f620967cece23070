// How far the rear-axle midpoint still has to go, if only a disc around it must pass: a lower bound of the way left.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "tightspot/collision.hpp"

namespace tightspot {

/// Dijkstra's distances from a target cell over a grid with 16 neighbours, computed as far as they are asked for.
/// A cell is blocked only if the body's inscribed disc about the rear-axle midpoint cannot stand anywhere in it, so a
/// blocked or unreachable cell is blocked for the vehicle too.
class DistanceGrid {
public:
    DistanceGrid(const CollisionChecker& checker, Point target, double cell) {
        const Box box(checker.workspace().vertices);
        grid_ = Grid(box.low, box.high, cell, 400);
        blocked_.assign(grid_.size(), 0);
        distance_.assign(grid_.size(), std::numeric_limits<float>::infinity());
        settled_.assign(grid_.size(), 0);
        queue_.reserve(static_cast<std::size_t>(grid_.size()) * 4);
        block(checker);
        const int start = grid_.index(target);
        blocked_[start] = 0;
        push(start, 0.0F);
    }

    /// Whether the disc can get from `q` to the target at all, as far as the grid can tell. If not, nor can the body.
    bool is_connected(Point q) { return std::isfinite(lower_bound(q)); }

    /// A lower bound (up to 3 %) of the way from `q` to the target in m; infinite if there is none.
    double lower_bound(Point q) {
        const int index = grid_.index(q);
        while (!settled_[index] && !queue_.empty()) settle_next();
        return std::max(0.0, shrink * static_cast<double>(distance_[index]) - 2.0 * grid_.half_diagonal());
    }

private:
    using Entry = std::pair<float, int>;
    static constexpr double shrink = 1.0 / 1.0276;  // 16 directions overrate an oblique way by at most that

    void block(const CollisionChecker& checker) {
        const double disc = checker.footprint().inscribed;
        if (disc < 0.0) return;  // a point beside the body may be anywhere
        const double border = disc - grid_.half_diagonal();
        const double near = border + checker.margin();
        const Polygon& workspace = checker.workspace();
        for (int i = 0; i < grid_.size(); ++i)
            for (std::size_t w = 0; w < workspace.size(); ++w)
                if (workspace.offsets[w] - dot(workspace.normals[w], grid_.middle(i)) < border) blocked_[i] = 1;
        for (const Polygon& obstacle : checker.obstacles()) {
            grid_.for_each_near(obstacle, std::max(near, 0.0), [&](int index) {
                if (!blocked_[index] && hides_cell(obstacle, grid_.middle(index), near)) blocked_[index] = 1;
            });
        }
    }

    /// Whether no point of the cell around `middle` is as far from the obstacle as the disc demands.
    static bool hides_cell(const Polygon& obstacle, Point middle, double near) {
        if (near > 0.0) return point_distance(obstacle, middle) < near;
        double deepest = -HUGE_VAL;
        for (std::size_t i = 0; i < obstacle.size(); ++i)
            deepest = std::max(deepest, dot(obstacle.normals[i], middle) - obstacle.offsets[i]);
        return deepest < near;
    }

    void push(int index, float distance) {
        if (distance >= distance_[index]) return;
        distance_[index] = distance;
        queue_.emplace_back(distance, index);
        std::push_heap(queue_.begin(), queue_.end(), std::greater<Entry>());
    }

    void settle_next() {
        const int index = queue_.front().second;
        std::pop_heap(queue_.begin(), queue_.end(), std::greater<Entry>());
        queue_.pop_back();
        if (settled_[index]) return;
        settled_[index] = 1;
        const int column = index % grid_.columns, row = index / grid_.columns;
        for (const auto& step : steps) {
            const int c = column + step.columns, r = row + step.rows;
            if (is_blocked(c, r)) continue;
            if (step.is_jump()) {
                const int half_c = step.columns / 2, half_r = step.rows / 2;
                if (is_blocked(column + half_c, row + half_r) &&
                    is_blocked(column + step.columns - half_c, row + step.rows - half_r))
                    continue;
            }
            push(r * grid_.columns + c,
                 distance_[index] + static_cast<float>(grid_.cell * std::hypot(step.columns, step.rows)));
        }
    }

    bool is_blocked(int column, int row) const {
        if (column < 0 || row < 0 || column >= grid_.columns || row >= grid_.rows) return true;
        return blocked_[row * grid_.columns + column] != 0;
    }

    struct Step {
        int columns, rows;
        bool is_jump() const { return std::abs(columns) + std::abs(rows) == 3; }
    };
    static constexpr Step steps[16] = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},  {1, 1}, {1, -1}, {-1, 1}, {-1, -1},
                                       {2, 1}, {2, -1}, {-2, 1}, {-2, -1}, {1, 2}, {1, -2}, {-1, 2}, {-1, -2}};

    Grid grid_;
    std::vector<char> blocked_;
    std::vector<float> distance_;
    std::vector<char> settled_;
    std::vector<Entry> queue_;
};

}  // namespace tightspot
