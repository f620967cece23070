// Separating lines to start from, in closed form, for every pair of a stagewise problem.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tightspot/judge/outline.hpp"
#include "tightspot/stagewise/problem.hpp"

namespace tightspot::stagewise {

// What lines are asked for: the guess's states (x, y, theta first), `nx` numbers a knot, and pairs (interval, part,
// obstacle). Poses in between are interpolated; of intervals that are not whole only the one at the end counts.
struct GuessedMotion {
    const double* states;
    int nx;
    const Indices& pieces;
    const std::vector<char>& whole;

    judge::Placement pose(int k, int piece) const {
        const double weight = whole[k] ? static_cast<double>(piece) / pieces[k] : 1.0;
        const double *from = states + k * nx, *to = from + nx;
        double q[3];
        for (int i = 0; i < 3; ++i) q[i] = (1 - weight) * from[i] + weight * to[i];
        return {q[0], q[1], std::cos(q[2]), std::sin(q[2])};
    }

    // The same, seen from a frame that has these poses (x, y, theta) at the interval's samples.
    judge::Placement pose(int k, int piece, const double* frames) const {
        const judge::Placement world = pose(k, piece);
        if (!frames) return world;
        const double* frame = frames + 3 * (whole[k] ? piece : pieces[k]);
        const double c = std::cos(frame[2]), s = std::sin(frame[2]), x = world.x - frame[0], y = world.y - frame[1];
        return {c * x + s * y, c * y - s * x, c * world.cos + s * world.sin, c * world.sin - s * world.cos};
    }
};

// A line {q: n . q = offset}, n = (cos phi, sin phi), its point next to the body's reference point, and how far the body
// lies beyond the obstacle along n: negative if they overlap.
struct StartLine {
    double phi, offset, x, y, gap;
};

class StartLines {
   public:
    StartLines(const Polygons& parts, const Polygons& obstacles)
        : parts_(outlines(parts)), obstacles_(outlines(obstacles)) {}

    // The best normal at the middle pose of interval k, and the offset midway between the obstacle and the body at all of
    // the interval's poses. `frames`: the poses of the obstacle's frame at the interval's samples if it moves, else null.
    StartLine of(const GuessedMotion& motion, int k, int part, int obstacle, const double* frames = nullptr) {
        const int pieces = motion.pieces[k];
        const judge::Placement middle = motion.pose(k, (pieces + 1) / 2, frames);
        judge::place(parts_[part], middle, body_);
        const judge::Line line = judge::best_line(body_, obstacles_[obstacle]);
        double nearest = HUGE_VAL;
        for (int piece = 0; piece <= pieces; ++piece) {
            judge::place(parts_[part], motion.pose(k, piece, frames), body_);
            nearest = std::min(nearest, judge::lowest(line.normal, body_.vertices));
        }
        const tightspot::Point n = line.normal;
        const double offset = (nearest + line.support) / 2, away = n.x * middle.x + n.y * middle.y - offset;
        return {std::atan2(n.y, n.x), offset, middle.x - away * n.x, middle.y - away * n.y,
                nearest - line.support};
    }

   private:
    static std::vector<judge::Outline> outlines(const Polygons& polygons) {
        std::vector<judge::Outline> result;
        for (int i = 0; i < polygons.size(); ++i) {
            std::vector<tightspot::Point> vertices;
            for (int j = polygons.first[i]; j < polygons.first[i + 1]; ++j)
                vertices.push_back({polygons.x[j], polygons.y[j]});
            result.emplace_back(std::move(vertices));
        }
        return result;
    }

    std::vector<judge::Outline> parts_, obstacles_;
    judge::Outline body_;
};

}  // namespace tightspot::stagewise
