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
    int column(double x) const { return clamped(std::floor((x - origin.x) / cell), columns); }
    int row(double y) const { return clamped(std::floor((y - origin.y) / cell), rows); }
    int index(Point q) const { return row(q.y) * columns + column(q.x); }
    Point middle(int index) const {
        return {origin.x + (index % columns + 0.5) * cell, origin.y + (index / columns + 0.5) * cell};
    }
    double half_diagonal() const { return cell * std::sqrt(0.5); }

    /// Calls `visit(cell index)` for the cells whose box meets the polygon's bounding box grown by `reach`.
    template <class Visit>
    void for_each_near(const Polygon& polygon, double reach, Visit&& visit) const {
        Point low = polygon.vertices[0], high = low;
        for (const Point& v : polygon.vertices) {
            low = {std::min(low.x, v.x), std::min(low.y, v.y)};
            high = {std::max(high.x, v.x), std::max(high.y, v.y)};
        }
        if (high.x + reach < origin.x || high.y + reach < origin.y) return;
        if (low.x - reach > origin.x + columns * cell || low.y - reach > origin.y + rows * cell) return;
        for (int r = row(low.y - reach); r <= row(high.y + reach); ++r)
            for (int c = column(low.x - reach); c <= column(high.x + reach); ++c) visit(r * columns + c);
    }

private:
    static int clamped(double value, int count) {
        return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(count - 1)));
    }
};

/// The box around convex half-planes' vertices.
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

class ObstacleMap {
public:
    ObstacleMap(std::vector<Polygon> obstacles, const Polygon& workspace, double reach, double cell)
        : obstacles_(std::move(obstacles)) {
        const Box box(workspace.vertices);
        grid_ = Grid(box.low, box.high, cell, 160);
        const double cutoff = reach + grid_.half_diagonal();
        std::vector<std::pair<int, int>> entries;
        for (std::size_t j = 0; j < obstacles_.size(); ++j) {
            const Circle circle(Box(obstacles_[j].vertices));
            grid_.for_each_near(obstacles_[j], reach, [&](int index) {
                const Point q = grid_.middle(index);
                const bool is_small = circle.radius < reach;
                if (is_small ? circle.is_within(q, cutoff) : point_distance(obstacles_[j], q) <= cutoff)
                    entries.emplace_back(index, static_cast<int>(j));
            });
        }
        begin_.assign(grid_.size() + 1, 0);
        for (const auto& [index, obstacle] : entries) ++begin_[index + 1];
        for (int i = 0; i < grid_.size(); ++i) begin_[i + 1] += begin_[i];
        near_.resize(entries.size());
        std::vector<int> next(begin_.begin(), begin_.end() - 1);
        for (const auto& [index, obstacle] : entries) near_[next[index]++] = obstacle;
    }

    struct Range {
        const int* first;
        const int* last;
        const int* begin() const { return first; }
        const int* end() const { return last; }
    };

    /// Every obstacle within `reach` of `q` is in the list (and perhaps a few others). `q` lies in the workspace.
    Range near(Point q) const {
        const int index = grid_.index(q);
        return {near_.data() + begin_[index], near_.data() + begin_[index + 1]};
    }

    const Polygon& operator[](int obstacle) const { return obstacles_[obstacle]; }
    const std::vector<Polygon>& obstacles() const { return obstacles_; }

private:
    std::vector<Polygon> obstacles_;
    Grid grid_;
    std::vector<int> begin_;
    std::vector<int> near_;
};

}  // namespace tightspot
