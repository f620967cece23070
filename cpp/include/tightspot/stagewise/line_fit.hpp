// The line between an obstacle and a body at given poses that has the most room: the one that the barrier alone would
// choose, since no line appears in the objective.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace tightspot::stagewise {

// Maximises the sum of the logarithms of all rows of one pair,
//
//   mu - n . O_j - d_j   and   n . V_i - mu - d_i,   n = (cos phi, sin phi),
//
// over phi and mu, roughly: where that maximum is, the multipliers of the rows are mu_b / s, and the line exerts on the
// vehicle what it does in a Newton step that has converged for the line alone.
class LineFit {
 public:
    double phi = 0, mu = 0;

    void reserve(std::size_t points) { points_.reserve(points); }

    void clear() { points_.clear(), obstacles_ = 0; }
    // First all of the obstacle's, then all of the body's.
    void add_obstacle(double x, double y, double demand) { points_.push_back({x, y, demand}), ++obstacles_; }
    void add_body(double x, double y, double demand) { points_.push_back({x, y, demand}); }

    // From the given normal on; false if no line was found that leaves all rows room.
    bool fit(double from) {
        phi = from;
        Room room = room_at(phi);
        if (!(room.size() > enough)) room = turned();
        if (!(room.size() > enough)) return false;
        mu = 0.5 * (room.low + room.high);
        double reached = potential(phi, mu);
        for (int i = 0; i < most_steps && std::isfinite(reached); ++i)
            if (!improve(reached)) break;
        return std::isfinite(reached);
    }

 private:
    struct Point {
        double x, y, demand;
    };
    // What is left for mu between both sides.
    struct Room {
        double low, high;
        double size() const { return high - low; }
    };
    static constexpr double enough = 1e-6;  // m
    static constexpr int most_steps = 8, directions = 24, halvings = 12;
    static constexpr double close = 1e-2;  // decrease of the sum of logarithms that ends the search

    Room room_at(double at) const {
        const double nx = std::cos(at), ny = std::sin(at);
        Room room{-HUGE_VAL, HUGE_VAL};
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const double along = nx * points_[i].x + ny * points_[i].y;
            if (i < obstacles_)
                room.low = std::max(room.low, along + points_[i].demand);
            else
                room.high = std::min(room.high, along - points_[i].demand);
        }
        return room;
    }

    // The normal with the most room among some, made better by halving their distance.
    Room turned() {
        Room best = room_at(phi);
        double step = 6.283185307179586 / directions;
        const double from = phi;
        for (int i = 1; i < directions; ++i) take_better(from + i * step, best);
        for (int i = 0; i < halvings; ++i) {
            step *= 0.5;
            const double middle = phi;
            take_better(middle - step, best), take_better(middle + step, best);
        }
        return best;
    }
    void take_better(double at, Room& best) {
        const Room room = room_at(at);
        if (room.size() > best.size()) best = room, phi = at;
    }

    // Minus the sum of the rows' logarithms; infinite if one of them is not positive.
    double potential(double at_phi, double at_mu) const {
        const double nx = std::cos(at_phi), ny = std::sin(at_phi);
        double product = 1, sum = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const double along = nx * points_[i].x + ny * points_[i].y - at_mu;
            const double row = (i < obstacles_ ? -along : along) - points_[i].demand;
            if (!(row > 0)) return HUGE_VAL;
            product *= row;
            if (i % 8 == 7) sum += std::log(product), product = 1;
        }
        return -sum - std::log(product);
    }

    // One Newton step, its curvature made positive, shortened until the potential falls; false if that was the last.
    bool improve(double& reached) {
        const double nx = std::cos(phi), ny = std::sin(phi);
        double g_phi = 0, g_mu = 0, phi_phi = 0, phi_mu = 0, mu_mu = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const double along = nx * points_[i].x + ny * points_[i].y, across = nx * points_[i].y - ny * points_[i].x;
            const double side = i < obstacles_ ? -1.0 : 1.0;
            const double weight = 1 / (side * (along - mu) - points_[i].demand), square = weight * weight;
            g_phi -= side * weight * across, g_mu += side * weight;
            phi_phi += square * across * across + side * weight * along, phi_mu -= square * across, mu_mu += square;
        }
        const double ratio = phi_mu / mu_mu, rest = phi_phi - phi_mu * ratio;
        const double turn = -(g_phi - ratio * g_mu) / std::max(std::abs(rest), 1e-10);
        const double shift = -g_mu / mu_mu - ratio * turn;
        double share = std::min(1.0, 0.5 / std::max(std::abs(turn), 1e-10));
        for (int i = 0; i < 6; ++i, share *= 0.4) {
            const double found = potential(phi + share * turn, mu + share * shift);
            if (!(found < reached)) continue;
            const bool last = found > reached - close;
            phi += share * turn, mu += share * shift, reached = found;
            return !last;
        }
        return false;
    }

    std::vector<Point> points_;
    std::size_t obstacles_ = 0;
};

}  // namespace tightspot::stagewise
