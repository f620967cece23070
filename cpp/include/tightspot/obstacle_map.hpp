// Which obstacles can matter at a place: a grid whose cells list the obstacles within reach.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "tightspot/polygon.hpp"

namespace tightspot {

/// An axis-parallel grid of square cells over a box.
struct Grid {
    Point origin;
    double cell = 1.0;
    int columns = 1;
    int rows = 1;

    Grid() = default;

    Grid(Point low, Point high, double wanted_cell, int most_per_side) : origin(low) {
        const double extent = std::max(high.x - low.x, high.y - low.y);
        cell = std::max(wanted_cell, extent / most_per_side);
        columns = std::max(1, static_cast<int>(std::ceil((high.x - low.x) / cell)));
        rows = std::max(1, static_cast<int>(std::ceil((high.y - low.y) / cell)));
    }

    int size() const { return columns * rows; }
    int column(double x) const { return clamped((x - origin.x) / cell, columns); }
    int row(double y) const { return clamped((y - origin.y) / cell, rows); }
    int index(Point q) const { return row(q.y) * columns + column(q.x); }
    Point middle(int index) const {
        return {origin.x + (index % columns + 0.5) * cell, origin.y + (index / columns + 0.5) * cell};
    }
    double half_diagonal() const { return cell * std::sqrt(0.5); }

    /// Calls `visit(cell index)` for the cells whose box meets the polygon's bounding box grown by `reach`.
    template <class Visit>
    void for_each_near(const Polygon& polygon, double reach, Visit&& visit) const {
        for_each_near(polygon, reach, 0, 0, columns, rows, visit);
    }

    /// The same among the columns from `left` to before `right` and the rows from `bottom` to before `top`.
    template <class Visit>
    void for_each_near(const Polygon& polygon, double reach, int left, int bottom, int right, int top,
                       Visit&& visit) const {
        Point low = polygon.vertices[0], high = low;
        for (const Point& v : polygon.vertices) {
            low = {std::min(low.x, v.x), std::min(low.y, v.y)};
            high = {std::max(high.x, v.x), std::max(high.y, v.y)};
        }
        if (high.x + reach < origin.x || high.y + reach < origin.y) return;
        if (low.x - reach > origin.x + columns * cell || low.y - reach > origin.y + rows * cell) return;
        const int last_row = std::min(row(high.y + reach), top - 1);
        const int last_column = std::min(column(high.x + reach), right - 1);
        for (int r = std::max(row(low.y - reach), bottom); r <= last_row; ++r)
            for (int c = std::max(column(low.x - reach), left); c <= last_column; ++c) visit(r * columns + c);
    }

private:
    /// The whole part; what is below 0 becomes 0, what is too much the last.
    static int clamped(double value, int count) {
        return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(count - 1)));
    }
};

/// The box around points.
struct Box {
    Point low{HUGE_VAL, HUGE_VAL};
    Point high{-HUGE_VAL, -HUGE_VAL};

    explicit Box(const std::vector<Point>& points) {
        for (const Point& p : points) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
    }
};

/// The circle around a box.
struct Circle {
    Point centre;
    double radius;

    explicit Circle(const Box& box)
        : centre{0.5 * (box.low.x + box.high.x), 0.5 * (box.low.y + box.high.y)},
          radius(0.5 * std::hypot(box.high.x - box.low.x, box.high.y - box.low.y)) {}

    /// Whether `q` is nearer to the circle's disc than `distance`, or in it.
    bool is_within(Point q, double distance) const {
        const double dx = q.x - centre.x, dy = q.y - centre.y, far = distance + radius;
        return dx * dx + dy * dy <= far * far;
    }
};

/// Obstacles, by their indices.
struct Range {
    const int* first;
    const int* last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
};

/// Squares of a grid's cells, each with the obstacles whose boxes, grown by `reach`, meet it.
class Tiles {
public:
    static constexpr int side = 16;  ///< cells

    Tiles() = default;

    Tiles(const Grid& grid, const std::vector<Polygon>& obstacles, double reach)
        : columns_of_cells_(grid.columns), columns_((grid.columns + side - 1) / side) {
        Grid coarse = grid;
        coarse.cell = side * grid.cell;
        coarse.columns = columns_;
        coarse.rows = (grid.rows + side - 1) / side;
        std::vector<std::pair<int, int>> entries;
        for (std::size_t j = 0; j < obstacles.size(); ++j)
            coarse.for_each_near(obstacles[j], reach,
                                 [&](int tile) { entries.emplace_back(tile, static_cast<int>(j)); });
        begin_.assign(coarse.size() + 1, 0);
        for (const auto& [tile, obstacle] : entries) ++begin_[tile + 1];
        for (int i = 0; i < coarse.size(); ++i) begin_[i + 1] += begin_[i];
        near_.resize(entries.size());
        std::vector<int> next(begin_.begin(), begin_.end() - 1);
        for (const auto& [tile, obstacle] : entries) near_[next[tile]++] = obstacle;
    }

    /// The obstacles of the tile in which the cell is, ascending.
    Range near(int cell) const {
        const int tile = cell / columns_of_cells_ / side * columns_ + cell % columns_of_cells_ / side;
        return {near_.data() + begin_[tile], near_.data() + begin_[tile + 1]};
    }

private:
    int columns_of_cells_ = 1;
    int columns_ = 1;
    std::vector<int> begin_{0, 0};
    std::vector<int> near_;
};

/// A cell's list is made when it is first asked for, so that a search pays for the part of the map that it sees. Not for
/// several threads at once.
class ObstacleMap {
public:
    ObstacleMap(std::vector<Polygon> obstacles, const Polygon& workspace, double reach, double cell)
        : obstacles_(std::move(obstacles)), reach_(reach) {
        const Box box(workspace.vertices);
        grid_ = Grid(box.low, box.high, cell, 160);
        lists_.resize(grid_.size());
        tiles_ = Tiles(grid_, obstacles_, reach);
        circles_.reserve(obstacles_.size());
        for (const Polygon& obstacle : obstacles_) circles_.emplace_back(Box(obstacle.vertices));
    }

    /// Every obstacle within `reach` of `q` is in the list (and perhaps a few others). `q` lies in the workspace. The
    /// list is valid until the next call.
    Range near(Point q) const {
        const int index = grid_.index(q);
        if (lists_[index].first < 0) list(index);
        return {near_.data() + lists_[index].first, near_.data() + lists_[index].last};
    }

    const Polygon& operator[](int obstacle) const { return obstacles_[obstacle]; }
    const std::vector<Polygon>& obstacles() const { return obstacles_; }

private:
    struct List {
        int first = -1, last = -1;
    };

    void list(int index) const {
        const Point q = grid_.middle(index);
        const double cutoff = reach_ + grid_.half_diagonal();
        lists_[index].first = static_cast<int>(near_.size());
        for (const int j : tiles_.near(index)) {
            if (!circles_[j].is_within(q, cutoff)) continue;
            const bool is_small = circles_[j].radius < reach_;
            if (is_small || point_distance(obstacles_[j], q) <= cutoff) near_.push_back(j);
        }
        lists_[index].last = static_cast<int>(near_.size());
    }

    std::vector<Polygon> obstacles_;
    std::vector<Circle> circles_;
    double reach_;
    Grid grid_;
    Tiles tiles_;
    mutable std::vector<List> lists_;
    mutable std::vector<int> near_;
};

}  // namespace tightspot
