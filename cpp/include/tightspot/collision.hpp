// Does the body at a pose, or along an arc, keep its clearance? Exact for polygons, whatever their shape.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "tightspot/footprint.hpp"
#include "tightspot/obstacle_map.hpp"

namespace tightspot {

/// What a pose's body touches.
struct Contact {
    static constexpr int nothing = -2;
    static constexpr int workspace = -1;
    int obstacle = nothing;  ///< index, or one of the two above
    double clearance = 0.0;  ///< signed distance, m
};

class CollisionChecker {
public:
    /// `margin`: demanded clearance to obstacles in m; the body may touch the workspace's border.
    CollisionChecker(Footprint footprint, Polygon workspace, std::vector<Polygon> obstacles, double margin)
        : footprint_(std::move(footprint)),
          workspace_(std::move(workspace)),
          margin_(margin),
          horizon_(0.75 * footprint_.narrowest),
          sweep_tolerance_(0.001 * footprint_.narrowest),
          map_(std::move(obstacles), workspace_, footprint_.radius + margin + horizon_, 0.25 * footprint_.radius),
          placed_(footprint_.parts) {}

    /// How much further the body may move at `pose` before anything comes closer than the margin (a lower bound,
    /// at most `horizon()`); not positive if something is that close already.
    double slack(const Pose& pose) const {
        ++pose_checks_;
        const double c = std::cos(pose.theta), s = std::sin(pose.theta);
        const Point middle{pose.x + c * footprint_.centre.x - s * footprint_.centre.y,
                           pose.y + s * footprint_.centre.x + c * footprint_.centre.y};
        bool has_vertices = false, has_edges = false;
        const auto place_once = [&](bool& is_placed, auto place) {
            if (is_placed) return;
            is_placed = true;
            for (std::size_t i = 0; i < placed_.size(); ++i) place(footprint_.parts[i], pose, c, s, placed_[i]);
        };
        double best = horizon_;
        for (std::size_t w = 0; w < workspace_.size(); ++w) {
            if (workspace_.offsets[w] - dot(workspace_.normals[w], middle) - footprint_.radius >= best) continue;
            place_once(has_vertices, place_vertices);
            best = std::min(best, wall_clearance(w) + border_tolerance);
            if (best <= 0.0) return best;
        }
        for (const int j : map_.near(middle)) {
            const Polygon& obstacle = map_[j];
            const FacingEdge facing = facing_edge(obstacle, middle);
            if (facing.distance - footprint_.radius - margin_ >= best) continue;
            ++pair_tests_;
            place_once(has_vertices, place_vertices);
            if (is_beyond(obstacle, facing.index, best + margin_)) continue;
            place_once(has_edges, place_edges);
            for (const Polygon& part : placed_)
                best = std::min(best, clearance_up_to(part, obstacle, best + margin_) - margin_);
            if (best <= 0.0) return best;
        }
        return best;
    }

    bool is_free(const Pose& pose) const { return slack(pose) > 0.0; }

    /// Whether the body keeps its clearance on the whole of an arc, to within `sweep_tolerance()`. Every two neighbouring
    /// samples' slacks cover the motion between them, so nothing is missed in between.
    /// `slack_at_start`: known slack at `from`; `slack_at_end` receives the one at the arc's end.
    bool arc_is_free(const Pose& from, Arc arc, double slack_at_start, double& slack_at_end) const {
        stretches_.clear();
        Pose end = from;
        return append(end, arc, slack_at_start, slack_at_end) && stretches_are_free();
    }

    /// The same for arcs driven one after the other. Coarse samples of all of them come first: they find most obstacles.
    template <class Arcs>
    bool arcs_are_free(const Pose& from, const Arcs& arcs, double slack_at_start) const {
        stretches_.clear();
        Pose end = from;
        double slack = slack_at_start;
        for (const Arc& arc : arcs)
            if (!append(end, arc, slack, slack)) return false;
        return stretches_are_free();
    }

    /// How far the body can go along a circle, at most `longest`; signed like an arc's length.
    double free_length(const Pose& pose, double longest, double curvature) const {
        const double step = std::copysign(std::min(0.2 * footprint_.narrowest, std::abs(longest)), longest);
        Pose from = pose;
        double done = 0.0, slack_here = slack(pose);
        while (slack_here > 0.0 && std::abs(done) < std::abs(longest)) {
            if (!arc_is_free(from, {step, curvature}, slack_here, slack_here)) break;
            done += step;
            from = advance(pose, {done, curvature});
        }
        return done;
    }

    /// What is closest to the body at `pose`, or what it overlaps most; every obstacle is looked at.
    Contact contact(const Pose& pose) const {
        const double c = std::cos(pose.theta), s = std::sin(pose.theta);
        for (std::size_t i = 0; i < placed_.size(); ++i) place(footprint_.parts[i], pose, c, s, placed_[i]);
        Contact nearest{Contact::nothing, HUGE_VAL};
        for (std::size_t w = 0; w < workspace_.size(); ++w) {
            const double clearance = wall_clearance(w);
            if (clearance < nearest.clearance && clearance < -border_tolerance)
                nearest = {Contact::workspace, clearance};
        }
        if (nearest.obstacle == Contact::workspace) return nearest;
        for (std::size_t j = 0; j < map_.obstacles().size(); ++j) {
            for (const Polygon& part : placed_) {
                const double clearance = signed_distance(part, map_.obstacles()[j]);
                if (clearance < nearest.clearance) nearest = {static_cast<int>(j), clearance};
            }
        }
        return nearest;
    }

    const Footprint& footprint() const { return footprint_; }
    const Polygon& workspace() const { return workspace_; }
    const std::vector<Polygon>& obstacles() const { return map_.obstacles(); }
    double margin() const { return margin_; }
    std::int64_t pose_checks() const { return pose_checks_; }
    std::int64_t pair_tests() const { return pair_tests_; }

    /// Slack is not looked at beyond this, m.
    double horizon() const { return horizon_; }
    /// How far below the margin the clearance may fall between samples, m: a thousandth of the body's width.
    double sweep_tolerance() const { return sweep_tolerance_; }

private:
    /// A part of an arc, with the slacks at its ends.
    struct Stretch {
        Pose from;
        Arc arc;
        double rate;  ///< sweep rate
        double slack_before, slack_after;
    };

    /// Adds an arc to the stretches to be covered unless its end is blocked, and moves `pose` there.
    bool append(Pose& pose, Arc arc, double slack_before, double& slack_after) const {
        const Pose from = pose;
        pose = advance(from, arc);
        const double after = slack(pose);
        if (after <= 0.0) return false;
        stretches_.push_back({from, arc, footprint_.sweep_rate(arc.curvature), slack_before, after});
        slack_after = after;
        return true;
    }

    /// Halves stretches, the long ones first, until the slacks at their ends cover all of them.
    bool stretches_are_free() const {
        for (std::size_t i = 0; i < stretches_.size(); ++i) {
            const Stretch whole = stretches_[i];
            const double covered = std::max(whole.slack_before, 0.0) + whole.slack_after + 2.0 * sweep_tolerance_;
            if (std::abs(whole.arc.length) * whole.rate <= covered) continue;
            const Arc half{0.5 * whole.arc.length, whole.arc.curvature};
            const Pose middle = advance(whole.from, half);
            const double between = slack(middle);
            if (between <= 0.0) return false;
            stretches_.push_back({whole.from, half, whole.rate, whole.slack_before, between});
            stretches_.push_back({middle, half, whole.rate, between, whole.slack_after});
        }
        return true;
    }

    static constexpr double border_tolerance = 1e-9;

    double wall_clearance(std::size_t wall) const {
        double outermost = -HUGE_VAL;
        for (const Polygon& part : placed_)
            for (const Point& v : part.vertices) outermost = std::max(outermost, dot(workspace_.normals[wall], v));
        return workspace_.offsets[wall] - outermost;
    }

    /// The edge line that a point is farthest beyond, and how far.
    struct FacingEdge {
        std::size_t index;
        double distance;
    };

    static FacingEdge facing_edge(const Polygon& obstacle, Point middle) {
        FacingEdge farthest{0, -HUGE_VAL};
        for (std::size_t i = 0; i < obstacle.size(); ++i) {
            const double distance = dot(obstacle.normals[i], middle) - obstacle.offsets[i];
            if (distance > farthest.distance) farthest = {i, distance};
        }
        return farthest;
    }

    /// Whether all of the placed body is at least so far beyond an obstacle's edge line.
    bool is_beyond(const Polygon& obstacle, std::size_t edge, double distance) const {
        return std::all_of(placed_.begin(), placed_.end(),
                           [&](const Polygon& part) { return beyond_edge(obstacle, edge, part) >= distance; });
    }

    /// A lower bound of the signed distance that is above the margin whenever the distance is.
    double clearance_up_to(const Polygon& part, const Polygon& obstacle, double enough) const {
        const double axis = axis_separation(part, obstacle, enough);
        return axis > 0.0 && axis <= margin_ ? disjoint_distance(part, obstacle) : axis;
    }

    Footprint footprint_;
    Polygon workspace_;
    double margin_;
    double horizon_;
    double sweep_tolerance_;
    ObstacleMap map_;
    mutable std::vector<Polygon> placed_;
    mutable std::vector<Stretch> stretches_;
    mutable std::int64_t pose_checks_ = 0;
    mutable std::int64_t pair_tests_ = 0;
};

}  // namespace tightspot
