// How far the rear-axle midpoint still has to go, if only a disc around it must pass: a lower bound of the way left.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "tightspot/collision.hpp"

namespace tightspot {

/// Distances from a target cell over a grid with 16 neighbours, computed as far as they are asked for. Steps along an
/// axis, a diagonal and a knight's move cost 5, 7 and 11 fifths of a cell (G. Borgefors: Distance transformations in
/// digital images, CVGIP 34, 1986), so that cells are settled from buckets, without comparisons.
/// Which cells are blocked is found out by tiles, when the distances come near them.
/// A cell is blocked only if the body's inscribed disc about the rear-axle midpoint cannot stand anywhere in it, so a
/// blocked or unreachable cell is blocked for the vehicle too.
class DistanceGrid {
public:
    DistanceGrid(const CollisionChecker& checker, Point target, double cell) : checker_(checker) {
        const Box box(checker.workspace().vertices);
        grid_ = Grid(box.low, box.high, cell, 400);
        width_ = grid_.columns + 2 * rim;
        const std::size_t size = static_cast<std::size_t>(width_) * static_cast<std::size_t>(grid_.rows + 2 * rim);
        state_.assign(size, blocked);
        for (int row = 0; row < grid_.rows; ++row) std::fill_n(state_.begin() + padded(0, row), grid_.columns, unseen);
        distance_.assign(size, unreached);
        for (std::size_t i = 0; i < steps.size(); ++i) offsets_[i] = steps[i].rows * width_ + steps[i].columns;
        border_ = checker.footprint().inscribed - grid_.half_diagonal();
        near_ = border_ + checker.margin();
        tiles_ = Tiles(grid_, checker.obstacles(), std::max(near_, 0.0));
        const int start = padded(grid_.column(target.x), grid_.row(target.y));
        if (state_[start] == unseen) look_at(start);
        state_[start] = free;
        push(start, 0);
    }

    /// Whether the disc can get from `q` to the target at all, as far as the grid can tell. If not, nor can the body.
    bool is_connected(Point q) { return std::isfinite(lower_bound(q)); }

    /// A lower bound (up to 4 %) of the way from `q` to the target in m; infinite if there is none.
    double lower_bound(Point q) {
        const int index = padded(grid_.column(q.x), grid_.row(q.y));
        if (is_blocked(index)) return HUGE_VAL;
        while (distance_[index] > settled_ && waiting_ > 0) settle_next_bucket();
        if (distance_[index] == unreached) return HUGE_VAL;
        return std::max(0.0, shrink * grid_.cell * distance_[index] - 2.0 * grid_.half_diagonal());
    }

private:
    static constexpr int rim = 2;  ///< blocked cells around the grid, as wide as the longest step
    static constexpr char free = 0, blocked = 1, unseen = 2;
    static constexpr int unreached = std::numeric_limits<int>::max();
    /// Lengths in fifths of a cell overrate no way by more than the last factor.
    static constexpr double shrink = 1.0 / 5.0 / 1.0199;

    int padded(int column, int row) const { return (row + rim) * width_ + column + rim; }

    bool is_blocked(int index) {
        if (state_[index] == unseen) look_at(index);
        return state_[index] == blocked;
    }

    /// Settles which cells of a cell's tile are blocked.
    void look_at(int index) {
        const int left = (index % width_ - rim) / Tiles::side * Tiles::side;
        const int bottom = (index / width_ - rim) / Tiles::side * Tiles::side;
        const int right = std::min(left + Tiles::side, grid_.columns), top = std::min(bottom + Tiles::side, grid_.rows);
        for (int row = bottom; row < top; ++row)
            std::fill_n(state_.begin() + padded(left, row), right - left, free);
        if (checker_.footprint().inscribed < 0.0) return;  // a point beside the body may be anywhere
        for (int row = bottom; row < top; ++row)
            for (int column = left; column < right; ++column)
                if (is_outside(grid_.middle(row * grid_.columns + column))) state_[padded(column, row)] = blocked;
        for (const int j : tiles_.near(bottom * grid_.columns + left)) {
            const Polygon& obstacle = checker_.obstacles()[j];
            grid_.for_each_near(obstacle, std::max(near_, 0.0), left, bottom, right, top, [&](int cell) {
                char& state = state_[padded(cell % grid_.columns, cell / grid_.columns)];
                if (state != blocked && hides_cell(obstacle, grid_.middle(cell), near_)) state = blocked;
            });
        }
    }

    /// Whether the disc reaches out of the workspace wherever in the cell around `middle` it stands.
    bool is_outside(Point middle) const {
        const Polygon& workspace = checker_.workspace();
        for (std::size_t w = 0; w < workspace.size(); ++w)
            if (workspace.offsets[w] - border_ < dot(workspace.normals[w], middle)) return true;
        return false;
    }

    /// Whether no point of the cell around `middle` is as far from the obstacle as the disc demands.
    static bool hides_cell(const Polygon& obstacle, Point middle, double near) {
        if (near > 0.0) return point_distance(obstacle, middle) < near;
        double deepest = -HUGE_VAL;
        for (std::size_t i = 0; i < obstacle.size(); ++i)
            deepest = std::max(deepest, dot(obstacle.normals[i], middle) - obstacle.offsets[i]);
        return deepest < near;
    }

    void push(int index, int distance) {
        if (distance >= distance_[index]) return;
        distance_[index] = distance;
        buckets_[static_cast<std::size_t>(distance) % buckets_.size()].push_back(index);
        ++waiting_;
    }

    /// Steps lengthen a way by less than the number of buckets, so each bucket holds one distance at a time.
    void settle_next_bucket() {
        ++settled_;
        std::vector<int>& bucket = buckets_[static_cast<std::size_t>(settled_) % buckets_.size()];
        waiting_ -= bucket.size();
        for (const int index : bucket)
            if (distance_[index] == settled_) relax(index);
        bucket.clear();
    }

    void relax(int index) {
        for (std::size_t i = 0; i < steps.size(); ++i) {
            const int next = index + offsets_[i];
            if (is_blocked(next)) continue;
            if (steps[i].is_jump() && is_blocked(index + steps[i].rows / 2 * width_ + steps[i].columns / 2) &&
                is_blocked(next - steps[i].rows / 2 * width_ - steps[i].columns / 2))
                continue;
            push(next, settled_ + steps[i].fifths);
        }
    }

    struct Step {
        int columns, rows, fifths;
        constexpr bool is_jump() const { return fifths == 11; }
    };
    static constexpr std::array<Step, 16> steps{{{1, 0, 5},
                                                 {-1, 0, 5},
                                                 {0, 1, 5},
                                                 {0, -1, 5},
                                                 {1, 1, 7},
                                                 {1, -1, 7},
                                                 {-1, 1, 7},
                                                 {-1, -1, 7},
                                                 {2, 1, 11},
                                                 {2, -1, 11},
                                                 {-2, 1, 11},
                                                 {-2, -1, 11},
                                                 {1, 2, 11},
                                                 {1, -2, 11},
                                                 {-1, 2, 11},
                                                 {-1, -2, 11}}};

    const CollisionChecker& checker_;
    Grid grid_;
    Tiles tiles_;
    double border_;  ///< how far inside the workspace, m, and ...
    double near_;    ///< ... how far from obstacles a cell's middle must be
    int width_ = 0;
    std::array<int, 16> offsets_{};
    std::vector<char> state_;
    std::vector<int> distance_;  ///< fifths of a cell
    std::array<std::vector<int>, 12> buckets_;
    std::size_t waiting_ = 0;
    int settled_ = -1;  ///< every distance up to this is final
};

}  // namespace tightspot
