// Primal-dual interior-point method with a filter line search, for one stagewise problem.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tightspot/stagewise/audit.hpp"
#include "tightspot/stagewise/filter.hpp"
#include "tightspot/stagewise/newton.hpp"

namespace tightspot::stagewise {

template <class Model>
class InteriorPoint : public Newton<Model> {
    using Base = Newton<Model>;
    using S = Sizes<Model>;
    using Base::assembly_, Base::bounds_, Base::complementarity, Base::complementarity_, Base::diverged, Base::direction;
    using Base::factor, Base::goal_residual_, Base::last_regularisation_, Base::layout_, Base::measure, Base::mu_;
    using Base::problem_, Base::row_residual_, Base::scale_, Base::set_goal_residual, Base::set_system;
    using Base::stationarity_, Base::values_, Base::violation_;
    static constexpr double first_regularisation = 3;  // keeps the first steps short; falls threefold each iteration
    static constexpr int patience = 60;  // iterations without progress at a feasible point
    static constexpr double smallest_barrier_of_tolerance = 0.1;

   public:
    explicit InteriorPoint(Problem problem) : Base(std::move(problem)), filter_(500) {
        for (Point* other : {&trial_, &step_, &other_}) other->allocate(layout_, bounds_.size());
        trial_values_.allocate(problem_, layout_);
        corrected_rows_.assign(layout_.rows, 0), corrected_goal_.assign(S::nx, 0);
        corrected_defects_.assign(problem_.steps * S::nx, 0);
        samples_.assign(Audit<Model>::scratch_size(problem_), 0);
    }

    using Base::point;
    std::vector<Record> log;

    Outcome solve(const Options& options, const Callback& callback = {}) {
        using Clock = std::chrono::steady_clock;
        const auto began = Clock::now();
        const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
        Outcome outcome;
        log.clear(), log.reserve(std::clamp(options.max_iterations, 0, 10000) + 1);
        filter_.clear(), last_regularisation_ = 0, large_violation_ = -1;
        options_ = options, mu_ = options.initial_barrier;
        if (!initialise()) return finish(outcome, Status::numerical, seconds());
        int acceptable = 0, failures = 0, since_best = 0;
        double best = std::numeric_limits<double>::infinity();
        for (int iteration = 0;; ++iteration) {
            Record record = measure(iteration);
            outcome.iterations = iteration;
            const double error = std::max({record.violation, record.stationarity, record.complementarity});
            const double all = record.violation + record.stationarity + record.complementarity + record.objective;
            const bool stop = callback && !callback(record);
            Status status = Status::solved;
            since_best = error < 0.5 * best ? 0 : since_best + 1;
            best = std::min(best, error);
            acceptable = error <= options.acceptable_tolerance ? acceptable + 1 : 0;
            if (!std::isfinite(all)) status = Status::numerical;
            else if (error <= options.tolerance) status = Status::solved;
            else if (stop) status = Status::stopped;
            else if (acceptable > options.acceptable_iterations) status = Status::acceptable;
            else if (iteration >= options.max_iterations) status = Status::iteration_limit;
            else if (seconds() > options.time_limit) status = Status::time_limit;
            else if (diverged()) status = Status::diverged;
            else if (since_best > patience && record.violation <= options.acceptable_tolerance)
                status = error <= options.acceptable_tolerance ? Status::acceptable : Status::numerical;
            else {
                update_barrier(iteration);
                if (!advance(record, outcome, failures))
                    status = record.violation > 1e-4 ? Status::infeasible : Status::numerical;
                else {
                    log.push_back(record);
                    continue;
                }
            }
            log.push_back(record);
            const bool claims = status == Status::solved || status == Status::acceptable;
            if (claims && !confirmed(status)) status = Status::numerical;
            return finish(outcome, status, seconds());
        }
    }

   private:
    // Nothing is called solved that the problem's definition does not confirm.
    bool confirmed(Status status) {
        const double tolerance = status == Status::solved ? options_.tolerance : options_.acceptable_tolerance;
        for (double z : point.z)
            if (!(z >= 0)) return false;
        return Audit<Model>(problem_, layout_, point.v, samples_).violation() <= 10 * tolerance;
    }

    Outcome finish(Outcome& outcome, Status status, double seconds) {
        outcome.status = status, outcome.seconds = seconds, outcome.objective = values_.objective;
        outcome.violation = violation_, outcome.stationarity = stationarity_, outcome.complementarity = complementarity_;
        outcome.residual = stationarity_ * scale_;
        return outcome;
    }

    bool initialise() {
        Vector& v = point.v;
        for (double value : v)
            if (!std::isfinite(value)) return false;
        for (int i = 0; i < S::nx; ++i) {
            if (!std::isnan(problem_.start[i])) v[i] = problem_.start[i];
            if (!std::isnan(problem_.goal[i])) v[layout_.x(problem_.steps) + i] = problem_.goal[i];
        }
        if (!problem_.free_time()) v[layout_.time] = problem_.time_low;
        for (const Bound& bound : bounds_) {
            const double other = opposite(bound);
            const double low = bound.side > 0 ? bound.value : other, high = bound.side > 0 ? other : bound.value;
            v[bound.index] = inside(v[bound.index], low, high, options_.bound_push);
        }
        assembly_.evaluate(v.data(), values_);
        if (!(mu_ > 0)) mu_ = std::clamp(1e-3 * values_.objective, 1e-6, 0.1);
        for (int i = 0; i < layout_.rows; ++i) {
            point.s[i] = std::max(values_.rows[i], options_.bound_push);
            const double central = mu_ / point.s[i];
            point.z[i] = options_.warm ? std::clamp(point.z[i], 0.1 * central, 1e3 * central) : central;
        }
        for (std::size_t i = 0; i < bounds_.size(); ++i) {
            const double central = mu_ / bounds_[i].slack(v);
            point.zb[i] = options_.warm ? std::clamp(point.zb[i], 0.1 * central, 1e3 * central) : central;
        }
        if (!options_.warm) {
            std::fill(point.lam.begin(), point.lam.end(), 0.0);
            std::fill(point.nu.begin(), point.nu.end(), 0.0);
        }
        return true;
    }

    double opposite(const Bound& bound) const {
        const int i = bound.index;
        if (i == layout_.time) return bound.side > 0 ? problem_.time_high : problem_.time_low;
        if (i < layout_.input)
            return bound.side > 0 ? problem_.state_high[i % S::nx] : problem_.state_low[i % S::nx];
        const int input = (i - layout_.input) % S::nu;
        return bound.side > 0 ? problem_.input_high[input] : problem_.input_low[input];
    }

    // Free mode, LOQO's rule (Vanderbei and Shanno 1999): a tenth of the mean complementarity, less the more alike all
    // products are, more if the smallest lags behind; never far below what stationarity calls for.
    void update_barrier(int iteration) {
        const std::size_t rows = point.s.size(), bounds = bounds_.size();
        if (iteration == 0 || rows + bounds == 0) return;
        const double *s = point.s.data(), *z = point.z.data();
        const auto of_row = [&](std::size_t i) { return s[i] * z[i]; };
        const auto of_bound = [&](std::size_t i) { return bounds_[i].slack(point.v) * point.zb[i]; };
        const double mean = (total(rows, of_row) + total(bounds, of_bound)) / static_cast<double>(rows + bounds);
        const double infinity = std::numeric_limits<double>::infinity();
        const double least = -std::max(largest(rows, -infinity, [&](std::size_t i) { return -of_row(i); }),
                                       largest(bounds, -infinity, [&](std::size_t i) { return -of_bound(i); }));
        const double evenness = std::max(least / mean, 1e-4);
        const double lag = std::min(0.05 * (1 - evenness) / evenness, 2.0);
        double wanted = std::max(0.08 * lag * lag * lag * mean, 1e-2 * mean);
        wanted = std::max(wanted, std::min(mu_, 5e-3 * stationarity_));
        wanted = std::clamp(wanted, smallest_barrier_of_tolerance * options_.tolerance, 10 * mu_);
        if (wanted == mu_) return;
        mu_ = wanted;
        filter_.clear();
    }

    // One step: direction, line search, update. False if none could be made.
    bool advance(Record& record, Outcome& outcome, int& failures) {
        const Merit from = merit(point, values_, goal_residual_);
        if (large_violation_ < 0) {
            large_violation_ = 1e4 * std::max(1.0, from.violation);
            small_violation_ = 1e-4 * std::max(1.0, from.violation);
        }
        set_system();
        double regularisation = first_regularisation * std::pow(3.0, -record.iteration);
        if (regularisation < 1e-9) regularisation = 0;
        bool moved = false;
        for (int round = 0; round < 6 && !moved; ++round) {
            if (!factor(regularisation, outcome)) return false;
            direction(row_residual_, values_.defects, goal_residual_, step_);
            moved = line_search(from, record);
            if (moved) break;
            filter_.clear();
            regularisation = regularisation == 0 ? std::max(1e-4, last_regularisation_) : 10 * regularisation;
        }
        record.regularisation = regularisation;
        record.barrier = mu_;
        if (!moved) {
            if (++failures > 5) return false;
            alpha_ = std::min(0.5 * longest_primal(step_), 1e-2);
            dual_alpha_ = 0.5 * longest_dual(step_);
            make_trial(alpha_, step_);
        }
        record.primal_step = alpha_, record.dual_step = dual_alpha_;
        update();
        return true;
    }

    double boundary_fraction() const { return std::max(0.99, 1 - mu_); }

    double longest_primal(const Point& step) const {
        const double *s = point.s.data(), *ds = step.s.data();
        double rate = largest(point.s.size(), 0.0, [&](std::size_t i) { return -ds[i] / s[i]; });
        for (const Bound& bound : bounds_)
            rate = std::max(rate, -bound.side * step.v[bound.index] / bound.slack(point.v));
        return rate > boundary_fraction() ? boundary_fraction() / rate : 1.0;
    }

    double longest_dual(const Point& step) const {
        const double *z = point.z.data(), *dz = step.z.data(), *zb = point.zb.data(), *dzb = step.zb.data();
        double rate = largest(point.z.size(), 0.0, [&](std::size_t i) { return -dz[i] / z[i]; });
        rate = largest(bounds_.size(), rate, [&](std::size_t i) { return -dzb[i] / zb[i]; });
        return rate > boundary_fraction() ? boundary_fraction() / rate : 1.0;
    }

    // Violation and barrier objective of a point whose values are known.
    Merit merit(const Point& at, const Values<Model>& values, const Vector& goal) const {
        const double *s = at.s.data(), *c = values.rows.data();
        const auto size = [](const Vector& vector) {
            return total(vector.size(), [&](std::size_t i) { return std::abs(vector[i]); });
        };
        double violation = size(values.defects) + size(goal);
        violation += total(at.s.size(), [&](std::size_t i) { return std::abs(c[i] - s[i]); });
        const double logs = sum_of_logs(at.s.size(), [&](std::size_t i) { return s[i]; }) +
                            sum_of_logs(bounds_.size(), [&](std::size_t i) { return bounds_[i].slack(at.v); });
        return {violation, values.objective - mu_ * logs};
    }

    // Slope of the barrier objective along a step.
    double slope(const Point& step) const {
        const double* v = point.v.data();
        double sum = 0, energy = 0, energy_slope = 0;
        for (int k = 0; k < problem_.steps; ++k)
            for (int i = 0; i < S::nu; ++i) {
                const double u = v[layout_.u(k) + i], weight = problem_.widths[k] * problem_.input_weights[i];
                energy += weight * u * u, energy_slope += 2 * weight * u * step.v[layout_.u(k) + i];
            }
        const double time_step = step.v[layout_.time];
        sum += problem_.time_weight * time_step;
        sum += problem_.time_scaled ? time_step * energy + v[layout_.time] * energy_slope : energy_slope;
        const double *s = point.s.data(), *ds = step.s.data();
        sum -= mu_ * total(point.s.size(), [&](std::size_t i) { return ds[i] / s[i]; });
        for (const Bound& bound : bounds_) sum -= mu_ * bound.side * step.v[bound.index] / bound.slack(point.v);
        return sum;
    }

    // trial_ = point + alpha step, with its values; multipliers are left alone.
    void make_trial(double alpha, const Point& step) {
        for (std::size_t i = 0; i < point.v.size(); ++i) trial_.v[i] = point.v[i] + alpha * step.v[i];
        for (int i = 0; i < layout_.rows; ++i) trial_.s[i] = point.s[i] + alpha * step.s[i];
        assembly_.evaluate(trial_.v.data(), trial_values_);
    }

    Acceptance try_step(double alpha, const Point& step, const Merit& from, double descent, Merit& reached) {
        make_trial(alpha, step);
        set_goal_residual(trial_.v.data(), corrected_goal_);
        reached = merit(trial_, trial_values_, corrected_goal_);
        return accept(filter_, from, reached, descent, alpha, small_violation_, large_violation_);
    }

    bool line_search(const Merit& from, Record& record) {
        const double descent = slope(step_);
        double smallest = 1e-5;
        if (descent < 0) {
            smallest = std::min(smallest, 1e-8 * from.violation / -descent);
            if (from.violation <= small_violation_)
                smallest = std::min(smallest, std::pow(from.violation, 1.1) / std::pow(-descent, 2.3));
            smallest *= 0.05;
        }
        smallest = std::max(smallest, 1e-9);
        alpha_ = longest_primal(step_), dual_alpha_ = longest_dual(step_);
        for (bool first = true; alpha_ > smallest; alpha_ *= 0.5, first = false) {
            ++record.trials;
            Merit reached{};
            Acceptance verdict = try_step(alpha_, step_, from, descent, reached);
            if (!verdict.accepted && first && options_.second_order_correction && reached.violation >= from.violation)
                verdict = corrected(from, descent);
            if (!verdict.accepted) continue;
            if (verdict.augments) filter_.add(from);
            return true;
        }
        return false;
    }

    // Second-order correction of the full step; on success step_ is the corrected one.
    Acceptance corrected(const Merit& from, double descent) {
        for (int i = 0; i < layout_.rows; ++i)
            corrected_rows_[i] = alpha_ * row_residual_[i] + trial_values_.rows[i] - trial_.s[i];
        for (std::size_t i = 0; i < corrected_defects_.size(); ++i)
            corrected_defects_[i] = alpha_ * values_.defects[i] + trial_values_.defects[i];
        for (int i = 0; i < S::nx; ++i) corrected_goal_[i] += alpha_ * goal_residual_[i];
        direction(corrected_rows_, corrected_defects_, corrected_goal_, other_);
        const double alpha = longest_primal(other_);
        Merit reached{};
        if (!std::isfinite(alpha)) return {false, false};
        const Acceptance verdict = try_step(alpha, other_, from, descent, reached);
        if (verdict.accepted) {
            alpha_ = alpha, dual_alpha_ = longest_dual(other_);
            std::swap(step_, other_);
        }
        return verdict;
    }

    // Accept the trial point; multipliers move by their own step length and are kept near the central path.
    void update() {
        std::swap(point.v, trial_.v), std::swap(point.s, trial_.s), std::swap(values_, trial_values_);
        for (std::size_t i = 0; i < point.lam.size(); ++i) point.lam[i] += alpha_ * step_.lam[i];
        for (std::size_t i = 0; i < point.nu.size(); ++i) point.nu[i] += alpha_ * step_.nu[i];
        for (int i = 0; i < layout_.rows; ++i) {
            const double central = mu_ / point.s[i];
            point.z[i] = std::clamp(point.z[i] + dual_alpha_ * step_.z[i], 1e-10 * central, 1e10 * central);
        }
        for (std::size_t i = 0; i < bounds_.size(); ++i) {
            const double central = mu_ / bounds_[i].slack(point.v);
            point.zb[i] = std::clamp(point.zb[i] + dual_alpha_ * step_.zb[i], 1e-10 * central, 1e10 * central);
        }
    }

    Filter filter_;
    Options options_;
    Point trial_, step_, other_;
    Values<Model> trial_values_;
    Vector corrected_rows_, corrected_defects_, corrected_goal_, samples_;
    double alpha_ = 0, dual_alpha_ = 0, large_violation_ = -1, small_violation_ = 0;
};

}  // namespace tightspot::stagewise
