// The motion that the judge looks at: inputs, constant on each interval, integrated from the first state.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "tightspot/pose.hpp"

namespace tightspot::judge {

/// How fast a frame can move during an interval of constant input: rad/s, m/s^2, rad/s^2.
struct Bounds {
    double yaw_rate, acceleration, yaw_acceleration;
};

/// How accurately to integrate.
struct Accuracy {
    double tolerance = 1e-7;   // of position and heading, m and rad
    double first_step = 0.125;  // the longest step of the first, coarser solution, s
    double max_steps = 4e5;    // more are too many
    double largest = 1e9;      // numbers beyond this are none
    double reserve = 1e-9;     // kept for rounding, m and rad
    double rounding = 0;       // of a step's sums, relative to the state
};

/// The states at all times. Steps are equal within an interval between knots; their number is raised until the solution
/// and one with steps twice as long differ by no more than the tolerance in position and heading at every common node.
template <class Model>
class Motion {
   public:
    using State = std::array<double, Model::states>;

    /// Knots t, s; the first state; the inputs of the intervals, one after the other.
    Motion(const Model& vehicle, std::vector<double> times, const State& start, std::vector<double> controls)
        : model(vehicle), t(std::move(times)), inputs(std::move(controls)), start_(start) {}

    int intervals() const { return static_cast<int>(t.size()) - 1; }

    const double* input(int interval) const { return inputs.data() + interval * Model::inputs; }

    /// False if the motion leaves the finite numbers or needs too many steps.
    bool integrate(const Accuracy& accuracy) {
        std::vector<double> steps(intervals());
        for (int k = 0; k < intervals(); ++k) steps[k] = std::max(1.0, std::ceil((t[k + 1] - t[k]) / accuracy.first_step));
        std::vector<State> coarse;
        while (3 * sum(steps) < accuracy.max_steps) {
            run(steps, 1, coarse);
            run(steps, 2, node_states);
            if (!finite(accuracy.largest)) return false;
            const std::pair<double, double> apart = difference(coarse);
            const double excess = std::max(apart.first, apart.second) / accuracy.tolerance;
            if (excess <= 1) {
                settle(steps, apart, accuracy);
                return true;
            }
            for (double& count : steps) count = std::ceil(count * std::min(1.1 * std::pow(excess, 0.25), 8.0));
        }
        return false;
    }

    /// The state at a time: one step from the nearest node of the time's interval.
    State at(double time) const {
        const auto above = std::upper_bound(nodes.begin(), nodes.end(), time);
        const auto last = static_cast<std::ptrdiff_t>(nodes.size()) - 2;
        const auto left = std::clamp<std::ptrdiff_t>(above - nodes.begin() - 1, 0, last);
        const auto nearest = left + (time - nodes[left] > nodes[left + 1] - time ? 1 : 0);
        State state;
        const double* from = node_states[nearest].data();
        double turning = model.turning(from);
        model.runge_kutta(from, input(node_interval_[left]), time - nodes[nearest], turning, state.data());
        return state;
    }

    /// Index of the node at a knot.
    std::size_t node_at(int k) const { return static_cast<std::size_t>(first_node_[k]); }

    const State& knot(int k) const { return node_states[first_node_[k]]; }

    /// Smallest and largest value of each state at the nodes.
    std::pair<State, State> extremes() const {
        State low = node_states.front(), high = low;
        for (const State& state : node_states)
            for (int i = 0; i < Model::states; ++i)
                low[i] = std::min(low[i], state[i]), high[i] = std::max(high[i], state[i]);
        return {low, high};
    }

    /// How far the states of a record of the knots are from the motion's at most: of (x, y), and of each state.
    std::pair<double, State> apart(const double* record) const {
        double position = 0;
        State furthest{};
        for (int k = 0; k <= intervals(); ++k) {
            const double* mine = record + k * Model::states;
            const State& own = knot(k);
            position = std::max(position, std::hypot(mine[0] - own[0], mine[1] - own[1]));
            for (int i = 0; i < Model::states; ++i) furthest[i] = std::max(furthest[i], std::abs(mine[i] - own[i]));
        }
        return {position, furthest};
    }

    Model model;
    std::vector<double> t, inputs;
    std::vector<int> substeps;        // steps in each interval
    std::vector<double> nodes;        // times between the steps, s
    std::vector<State> node_states;   // the states there
    double position_error = 0, heading_error = 0;

   private:
    static double sum(const std::vector<double>& steps) {
        double total = 0;
        for (double count : steps) total += count;
        return total;
    }

    void run(const std::vector<double>& steps, int times, std::vector<State>& states) const {
        states.assign(1, start_);
        states.reserve(static_cast<std::size_t>(sum(steps)) * times + 1);
        double turning = model.turning(start_.data());
        for (int k = 0; k < intervals(); ++k) {
            const int count = static_cast<int>(steps[k]) * times;
            const double h = (t[k + 1] - t[k]) / count;
            for (int i = 0; i < count; ++i) {
                State after;
                model.runge_kutta(states.back().data(), input(k), h, turning, after.data());
                states.push_back(after);
            }
        }
    }

    bool finite(double largest) const {
        for (const State& state : node_states)
            for (double value : state)
                if (!(std::abs(value) < largest)) return false;
        return true;
    }

    /// Largest distance of position and of heading at the common nodes; NaN where the coarse solution is none.
    std::pair<double, double> difference(const std::vector<State>& coarse) const {
        double position = 0, heading = 0;
        for (std::size_t i = 0; i < coarse.size(); ++i) {
            const State &a = coarse[i], &b = node_states[2 * i];
            const double apart = std::hypot(a[0] - b[0], a[1] - b[1]), turned = std::abs(a[2] - b[2]);
            if (std::isnan(apart + turned)) return {apart + turned, apart + turned};
            position = std::max(position, apart), heading = std::max(heading, turned);
        }
        return {position, heading};
    }

    void settle(const std::vector<double>& steps, std::pair<double, double> apart, const Accuracy& accuracy) {
        double position = 0, heading = 0;
        for (const State& state : node_states) {
            position = std::max({position, std::abs(state[0]), std::abs(state[1])});
            heading = std::max(heading, std::abs(state[2]));
        }
        const double rounding = accuracy.rounding * static_cast<double>(node_states.size());
        position_error = apart.first + accuracy.reserve + rounding * position;
        heading_error = apart.second + accuracy.reserve + rounding * heading;
        first_node_.assign(1, 0);
        for (int k = 0; k < intervals(); ++k) {
            const int count = 2 * static_cast<int>(steps[k]);
            const double h = (t[k + 1] - t[k]) / count;
            for (int i = 0; i < count; ++i) nodes.push_back(t[k] + i * h), node_interval_.push_back(k);
            substeps.push_back(count);
            first_node_.push_back(first_node_.back() + count);
        }
        nodes.push_back(t.back());
    }

    State start_;
    std::vector<int> first_node_, node_interval_;
};

}  // namespace tightspot::judge
