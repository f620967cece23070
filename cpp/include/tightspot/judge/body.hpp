// The body parts that ride on a motion: where they are at the knots, and how far they bulge between two states.
#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tightspot/judge/motion.hpp"
#include "tightspot/judge/outline.hpp"

namespace tightspot::judge {

/// A convex part fixed to one of the vehicle's frames.
struct Part {
    Outline outline;
    int frame = 0;
    double radius = 0;  // largest distance of a vertex from the frame's origin, m
    double pad = 0;     // what its clearances lose to integration error and rounding, m
};

/// The parts along the motion.
template <class Model>
class Body {
   public:
    using State = typename Motion<Model>::State;

    /// `reserve`: relative, for rounding in the bounds of the motion.
    Body(const Motion<Model>& motion, std::vector<Part> parts, double reserve)
        : parts(std::move(parts)), motion_(motion), reserve_(reserve) {
        for (const Part& part : this->parts) follow(part);
    }

    const Motion<Model>& motion() const { return motion_; }

    Placement placement(int part, const State& state) const {
        return Placement::of(motion_.model.frame(state.data(), parts[part].frame));
    }

    /// Smallest normal . p over the part in a placement.
    double lowest(int part, const Placement& at, Point normal) const {
        double low = std::numeric_limits<double>::infinity();
        for (const Point& p : parts[part].outline.vertices) low = std::min(low, dot(normal, at.moved(p)));
        return low;
    }

    /// The lemma's P h^2 / 8 between two states of an interval, m; infinite where nothing is bounded.
    double loss(int part, int interval, const State& before, const State& after, double h) const {
        const Part& p = parts[part];
        const Bounds b = motion_.model.bounds(before.data(), after.data(), motion_.input(interval), p.frame);
        const double P = b.acceleration + (b.yaw_acceleration + b.yaw_rate * b.yaw_rate) * p.radius;
        return std::isfinite(P) ? P * h * h / 8 * (1 + reserve_) : std::numeric_limits<double>::infinity();
    }

    const Placement& at_knot(int part, int k) const { return placements_[part][k]; }

    const Box& box(int part, int k) const { return boxes_[part][k]; }

    const Box& whole_box(int part) const { return whole_boxes_[part]; }

    /// The lemma's lower bound of normal . p from knot a to knot b.
    double chain(int part, int a, int b, Point normal) const {
        const Track& track = tracks_[part];
        double bound = std::numeric_limits<double>::infinity(), before = track.lowest(a, normal);
        for (int k = a; k < b; ++k) {
            const double after = track.lowest(k + 1, normal);
            bound = std::min(bound, std::min(before, after) - track.losses[k]);
            before = after;
        }
        return bound;
    }

    std::vector<Part> parts;

   private:
    /// The vertices of a part at the knots, and its losses between them.
    struct Track {
        std::size_t corners = 0;
        std::vector<Point> vertices;
        std::vector<double> losses;

        double lowest(int k, Point normal) const {
            const Point* p = vertices.data() + k * corners;
            double low = dot(normal, p[0]);
            for (std::size_t i = 1; i < corners; ++i) low = std::min(low, dot(normal, p[i]));
            return low;
        }
    };

    void follow(const Part& part) {
        const int index = static_cast<int>(tracks_.size());
        Track track;
        track.corners = part.outline.vertices.size();
        std::vector<Placement> placements;
        std::vector<Box> boxes;
        for (int k = 0; k <= motion_.intervals(); ++k) {
            placements.push_back(placement(index, motion_.knot(k)));
            std::vector<Point> moved;
            for (const Point& p : part.outline.vertices) moved.push_back(placements.back().moved(p));
            track.vertices.insert(track.vertices.end(), moved.begin(), moved.end());
            boxes.push_back(Box::of(moved));
        }
        for (int k = 0; k < motion_.intervals(); ++k)
            track.losses.push_back(
                loss(index, k, motion_.knot(k), motion_.knot(k + 1), motion_.t[k + 1] - motion_.t[k]));
        Box whole = boxes.front();
        for (const Box& box : boxes) whole.add(box);
        tracks_.push_back(std::move(track)), placements_.push_back(std::move(placements));
        boxes_.push_back(std::move(boxes)), whole_boxes_.push_back(whole);
    }

    const Motion<Model>& motion_;
    double reserve_;
    std::vector<Track> tracks_;
    std::vector<std::vector<Placement>> placements_;
    std::vector<std::vector<Box>> boxes_;
    std::vector<Box> whole_boxes_;
};

}  // namespace tightspot::judge
