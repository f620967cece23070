// Sample poses seen from the frames of moving obstacles, whose poses o = (p_o, theta_o) are linear in t_f:
//
//   q' = (R(theta_o)' (p - p_o), theta - theta_o)
//
// Rows of moving obstacles are written in q' like others in q. What they contribute is carried back from there to the
// pose and to t_f, first and second derivatives exactly.
#pragma once

#include <cmath>
#include <vector>

#include "tightspot/stagewise/row_quadratic.hpp"

namespace tightspot::stagewise {

// Derivatives of one q' at a point. With b the frame's velocity in its own axes and w its turn, both for each second of
// t_f: dq'/dt_f = (w y' - b_x, -w x' - b_y, -w).
struct ViewDerivatives {
    double cos = 1, sin = 0, turn = 0;  // of theta_o; d theta_o / d t_f
    double time[3] = {}, time_time[2] = {};

    ViewDerivatives() = default;
    ViewDerivatives(const View& view, double final_time, const double* seen) {
        const double angle = view.motion->at(view.sample, 2, final_time);
        const double* slope = view.motion->slopes.data() + 3 * view.sample;
        cos = std::cos(angle), sin = std::sin(angle), turn = slope[2];
        const double b_x = cos * slope[0] + sin * slope[1], b_y = cos * slope[1] - sin * slope[0];
        time[0] = turn * seen[1] - b_x, time[1] = -turn * seen[0] - b_y, time[2] = -turn;
        time_time[0] = turn * (time[1] - b_y), time_time[1] = turn * (b_x - time[0]);
    }

    // Adds to a force on q what one on q' is there; returns its part along t_f.
    double pull(const double* force, double* pose) const {
        pose[0] += cos * force[0] - sin * force[1], pose[1] += sin * force[0] + cos * force[1];
        pose[2] += force[2];
        return time[0] * force[0] + time[1] * force[1] + time[2] * force[2];
    }
    void push(const double* step, double time_step, double* seen) const {
        seen[0] = cos * step[0] + sin * step[1] + time[0] * time_step;
        seen[1] = cos * step[1] - sin * step[0] + time[1] * time_step;
        seen[2] = step[2] + time[2] * time_step;
    }
    // From the Hessian h (xx, xy, yy, x theta, y theta, theta theta) in q' and the force, adds that in q, mixed with t_f,
    // and returns that of t_f alone.
    double pull(const double* h, const double* force, double* pose, double* mixed) const {
        const double full[3][3] = {{h[0], h[1], h[3]}, {h[1], h[2], h[4]}, {h[3], h[4], h[5]}};
        double half[3][3] = {}, turned[3][3] = {}, along[3], turned_force[3] = {};
        for (int i = 0; i < 3; ++i) along[i] = pull(full[i], half[i]);  // half = full J, along = full dq'/dt_f
        for (int c = 0; c < 3; ++c) {
            const double column[3] = {half[0][c], half[1][c], half[2][c]};
            pull(column, turned[c]);
        }
        pose[0] += turned[0][0], pose[1] += turned[0][1], pose[2] += turned[1][1];
        pose[3] += turned[0][2], pose[4] += turned[1][2], pose[5] += turned[2][2];
        pull(force, turned_force);
        mixed[0] -= turn * turned_force[1], mixed[1] += turn * turned_force[0];
        return pull(along, mixed) + force[0] * time_time[0] + force[1] * time_time[1];
    }
};

// What views add along t_f.
struct TimeCurvature {
    Vector times;        // by interval
    Vector pose_times;   // mixed with the pose, 3 of each sample
    Vector cover_times;  // mixed with the cover, by (interval, part)

    void clear() {
        for (Vector* all : {&times, &pose_times, &cover_times}) std::fill(all->begin(), all->end(), 0.0);
    }
};

class Views {
   public:
    Views(const RowGroups& rows, int samples, int intervals, int parts)
        : rows_(rows), samples_(samples), parts_(parts), derivatives_(rows.views.size()) {
        if (rows.views.empty()) return;
        curvature.times.assign(intervals, 0), curvature.pose_times.assign(3 * samples, 0);
        curvature.cover_times.assign(intervals * parts, 0);
    }

    bool any(int interval) const { return rows_.first_view[interval] < rows_.first_view[interval + 1]; }

    // Sets the poses (x, y, cos theta, sin theta) that come after the samples'.
    void evaluate(double final_time, Vector& poses) const {
        for (std::size_t i = 0; i < rows_.views.size(); ++i) {
            const View& view = rows_.views[i];
            const auto at = [&](int j) { return view.motion->at(view.sample, j, final_time); };
            const double* pose = poses.data() + 4 * view.sample;
            double* seen = poses.data() + 4 * (samples_ + i);
            const double cosine = std::cos(at(2)), sine = std::sin(at(2)), x = pose[0] - at(0), y = pose[1] - at(1);
            seen[0] = cosine * x + sine * y, seen[1] = cosine * y - sine * x;
            seen[2] = cosine * pose[2] + sine * pose[3], seen[3] = cosine * pose[3] - sine * pose[2];
        }
    }

    void differentiate(double final_time, const Vector& poses) {
        for (std::size_t i = 0; i < rows_.views.size(); ++i)
            derivatives_[i] = {rows_.views[i], final_time, poses.data() + 4 * (samples_ + i)};
    }

    // Carries forces back to samples and t_f.
    void pull(Forces& forces) const {
        for (std::size_t i = 0; i < rows_.views.size(); ++i) {
            const View& view = rows_.views[i];
            forces.times[view.interval] += derivatives_[i].pull(forces.poses.data() + 3 * (samples_ + i),
                                                                forces.poses.data() + 3 * view.sample);
        }
    }

    // Carries curvature back to samples and, in `curvature`, to t_f.
    void pull(const Forces& forces, RowCurvature& of_rows) {
        curvature.clear();
        for (std::size_t i = 0; i < rows_.views.size(); ++i) {
            const View& view = rows_.views[i];
            const std::size_t seen = samples_ + i;
            curvature.times[view.interval] +=
                derivatives_[i].pull(of_rows.poses.data() + 6 * seen, forces.poses.data() + 3 * seen,
                                     of_rows.poses.data() + 6 * view.sample, curvature.pose_times.data() + 3 * view.sample);
            for (int part = 0; part < parts_; ++part)
                curvature.cover_times[view.interval * parts_ + part] +=
                    derivatives_[i].pull(of_rows.pose_covers.data() + 3 * (seen * parts_ + part),
                                         of_rows.pose_covers.data() + 3 * (view.sample * parts_ + part));
        }
    }

    // Steps of the seen poses from those of the samples.
    void push(double time_step, Vector& poses) const {
        for (std::size_t i = 0; i < rows_.views.size(); ++i)
            derivatives_[i].push(poses.data() + 3 * rows_.views[i].sample, time_step, poses.data() + 3 * (samples_ + i));
    }

    // The view that a line's pose is (see RowGroups::samples), `nullptr` if it is a sample itself.
    const View* view(int place) const { return place < samples_ ? nullptr : &rows_.views[place - samples_]; }
    const ViewDerivatives& derivatives(int place) const { return derivatives_[place - samples_]; }

    TimeCurvature curvature;

   private:
    const RowGroups& rows_;
    int samples_, parts_;
    std::vector<ViewDerivatives> derivatives_;
};

}  // namespace tightspot::stagewise
