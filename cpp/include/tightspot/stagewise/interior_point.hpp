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
#include "tightspot/stagewise/fitted_lines.hpp"
#include "tightspot/stagewise/newton.hpp"

namespace tightspot::stagewise {

template <class Model>
class InteriorPoint : public Newton<Model> {
    using Base = Newton<Model>;
    using S = Sizes<Model>;
    using Base::assembly_, Base::bounds_, Base::complementarity_, Base::diverged, Base::direction;
    using Base::factor, Base::goal_residual_, Base::last_regularisation_, Base::layout_, Base::measure, Base::mu_;
    using Base::problem_, Base::products_, Base::row_residual_, Base::scale_, Base::set_goal_residual, Base::set_system;
    using Base::stationarity_, Base::values_, Base::violation_;
    using Pace = typename Base::Pace;
    static constexpr double first_regularisation = 0.3;  // keeps the first steps short; falls threefold each iteration
    static constexpr double little_less = 0.99;
    static constexpr double short_step = 0.2, worthwhile = 1.5;  // see fitting_search
    static constexpr int fitting_trials = 6;
    static constexpr double usual_rows = 1000;  // see share_of_rows
    static constexpr int patience = 60;  // iterations without progress: in optimality, or towards feasibility
    static constexpr double infeasible_violation = 1e-4;
    static constexpr double smallest_barrier_of_tolerance = 0.1;

   public:
    explicit InteriorPoint(Problem problem) : Base(std::move(problem)), filter_(500), lines_(problem_, assembly_) {
        for (Point* other : {&trial_, &step_, &other_}) other->allocate(layout_, bounds_.size());
        assembly_.allocate(trial_values_);
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
        int acceptable = 0, failures = 0, since_best = 0, since_nearer = 0;
        double best = std::numeric_limits<double>::infinity(), nearest = best;
        for (int iteration = 0;; ++iteration) {
            Record record = measure(iteration);
            outcome.iterations = iteration;
            const double error = std::max({record.violation, record.stationarity, record.complementarity});
            const double all = record.violation + record.stationarity + record.complementarity + record.objective;
            const bool stop = callback && !callback(record);
            Status status = Status::solved;
            since_best = error < 0.5 * best ? 0 : since_best + 1;
            best = std::min(best, error);
            since_nearer = record.violation < 0.9 * nearest ? 0 : since_nearer + 1;
            if (since_nearer == 0) nearest = record.violation;
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
            else if (since_nearer > 2 * patience && nearest > infeasible_violation)
                status = Status::infeasible;
            else {
                update_barrier(iteration);
                if (!advance(record, outcome, failures))
                    status = record.violation > infeasible_violation ? Status::infeasible : Status::numerical;
                else {
                    log.push_back(record);
                    continue;
                }
            }
            log.push_back(record);
            outcome.audited = Audit<Model>(problem_, layout_, point.v, samples_).violation();
            const bool claims = status == Status::solved || status == Status::acceptable;
            if (claims && !confirmed(status, outcome.audited)) status = Status::numerical;
            return finish(outcome, status, seconds());
        }
    }

   private:
    // Nothing is called solved that the problem's definition does not confirm.
    bool confirmed(Status status, double audited) const {
        const double tolerance = status == Status::solved ? options_.tolerance : options_.acceptable_tolerance;
        for (double z : point.z)
            if (!(z >= 0)) return false;
        return audited <= 10 * tolerance;
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
        if (!(mu_ > 0)) mu_ = first_barrier();
        for (int i = 0; i < layout_.rows; ++i) {
            point.s[i] = std::max(values_.rows[i], options_.slack_push);
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

    // What a decimetre of penetration costs, on average, if some is allowed: multipliers of rows then begin as large as
    // they may become, and all rows are given way to before any.
    double first_barrier() const {
        const std::size_t soft = layout_.soft_pairs.size();
        if (soft == 0) return share_of_rows() * std::clamp(values_.objective, 1e-6, 1e-2);
        double sum = 0;
        for (std::size_t j = 0; j < soft; ++j) sum += assembly_.penalty(j).at(point.v[layout_.time]);
        return std::max(0.1 * sum / static_cast<double>(soft), 1e-6);
    }

    double opposite(const Bound& bound) const {
        const int i = bound.index;
        if (i == layout_.time) return bound.side > 0 ? problem_.time_high : problem_.time_low;
        if (i < layout_.input)
            return bound.side > 0 ? problem_.state_high[i % S::nx] : problem_.state_low[i % S::nx];
        const int input = (i - layout_.input) % S::nu;
        return bound.side > 0 ? problem_.input_high[input] : problem_.input_low[input];
    }

    // The barrier is a sum over rows, the objective is not: with more rows, each of them must weigh less, or the path is
    // pushed to where all obstacles are far before the objective is heard. Penalties of soft pairs are sums, too.
    double share_of_rows() const {
        if (!layout_.soft_pairs.empty()) return 1;
        return std::min(1.0, usual_rows / static_cast<double>(point.s.size() + bounds_.size()));
    }

    // Free mode, LOQO's rule (Vanderbei and Shanno 1999): a share of the mean complementarity, less the more alike all
    // products are, more if the smallest lags behind; never far below what stationarity calls for.
    void update_barrier(int iteration) {
        const std::size_t rows = point.s.size(), bounds = bounds_.size();
        if (iteration == 0 || rows + bounds == 0) return;
        const double mean = products_.sum / static_cast<double>(rows + bounds), least = products_.least;
        const double evenness = std::max(least / mean, 1e-4);
        const double lag = std::min(0.05 * (1 - evenness) / evenness, 2.0);
        double wanted = std::max(0.04 * lag * lag * lag * mean, 1e-2 * mean);
        wanted = std::max(wanted, std::min(mu_, 5e-3 * share_of_rows() * stationarity_));
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
        double regularisation = options_.warm ? 0 : first_regularisation * std::pow(3.0, -record.iteration);
        if (regularisation < 1e-9) regularisation = 0;
        bool moved = false;
        for (int round = 0; round < 6 && !moved; ++round) {
            if (!factor(regularisation, outcome)) return false;
            pace_ = direction(row_residual_, values_.defects, goal_residual_, step_);
            moved = line_search(from, record);
            if (moved) break;
            filter_.clear();
            regularisation = regularisation == 0 ? std::max(1e-4, last_regularisation_) : 10 * regularisation;
        }
        record.regularisation = regularisation;
        record.barrier = mu_;
        if (!moved) {
            if (++failures > 5) return false;
            alpha_ = std::min(0.5 * longest(pace_.primal), 1e-2);
            dual_alpha_ = 0.5 * longest(pace_.dual);
            make_trial(alpha_, step_);
        }
        record.primal_step = alpha_, record.dual_step = dual_alpha_;
        update();
        return true;
    }

    double boundary_fraction() const { return std::max(0.99, 1 - mu_); }

    // The longest step that leaves of everything what the fraction to the boundary leaves.
    double longest(double rate) const { return rate > boundary_fraction() ? boundary_fraction() / rate : 1.0; }

    // Violation and barrier objective of a point whose values are known.
    Merit merit(const Point& at, const Values<Model>& values, const Vector& goal) const {
        Sum gaps;
        Logarithms logarithms;
        over_packs(at.s.size(), [&](auto zero, std::size_t i) {
            using P = decltype(zero);
            const P s = load<P>(&at.s[i]);
            gaps.add(magnitude(load<P>(&values.rows[i]) - s)), logarithms.add(s);
        });
        over_packs(at.sb.size(), [&](auto zero, std::size_t i) { logarithms.add(load<decltype(zero)>(&at.sb[i])); });
        double logs = 0;
        if (logarithms.usable()) {
            logs = logarithms.value();
        } else {
            for (double s : at.s) logs += std::log(s);
            for (double s : at.sb) logs += std::log(s);
        }
        const double violation = gaps.value() + sum_of_magnitudes(values.defects.data(), values.defects.size()) +
                                 sum_of_magnitudes(goal.data(), goal.size());
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
        for (std::size_t j = 0; j < layout_.soft_pairs.size(); ++j) {
            const Penalty& penalty = assembly_.penalty(j);
            const std::size_t at = layout_.sigma + j;
            sum += penalty.at(v[layout_.time]) * step.v[at] + penalty.timed * v[at] * time_step;
        }
        return sum - mu_ * pace_.slope;
    }

    // trial_ = point + alpha step, with its values; multipliers are left alone. Where a row has more room than its slack
    // says, the slack takes it: that lowers both the violation and the barrier objective. It does so, too, where the row
    // has a little less; otherwise the last steps would be about rows that are far from being violated.
    void make_trial(double alpha, const Point& step) {
        const auto move = [&](const Vector& from, const Vector& by, Vector& to) {
            over_packs(from.size(), [&](auto zero, std::size_t i) {
                using P = decltype(zero);
                store(P(load<P>(&from[i]) + alpha * load<P>(&by[i])), &to[i]);
            });
        };
        move(point.v, step.v, trial_.v), move(point.s, step.s, trial_.s);
        trial_.settle_bounds(bounds_);
        assembly_.evaluate(trial_.v.data(), trial_values_);
        for (int i = 0; i < layout_.rows; ++i) {
            const double s = trial_.s[i], row = trial_values_.rows[i];
            trial_.s[i] = row > little_less * s ? row : s;
        }
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
        if (fitting_search(from, descent, record)) return true;
        lines_.clear();
        alpha_ = longest(pace_.primal), dual_alpha_ = longest(pace_.dual);
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

    // Longer steps than lines allow. A line can turn by half a circle at most, but a linear model of its rows turns it on
    // and on with the vehicle, so that one line of hundreds stops all. Where that makes the step short, those lines are
    // fitted to the poses reached instead: no line appears in the objective, so for given poses it is the barrier's alone.
    bool fitting_search(const Merit& from, double descent, Record& record) {
        const double stopped = longest(pace_.primal);
        if (stopped > short_step) return false;
        alpha_ = longest(lines_.rates(point, step_).primal);
        for (int trial = 0; trial < fitting_trials && alpha_ > worthwhile * stopped; ++trial, alpha_ *= 0.5) {
            ++record.trials;
            make_trial(alpha_, step_);
            const double limit = boundary_fraction() / alpha_;
            if (!lines_.fit(limit, point, trial_, trial_values_, layout_)) continue;
            set_goal_residual(trial_.v.data(), corrected_goal_);
            const Merit reached = merit(trial_, trial_values_, corrected_goal_);
            const Acceptance verdict = accept(filter_, from, reached, descent, alpha_, small_violation_, large_violation_);
            if (!verdict.accepted) continue;
            if (verdict.augments) filter_.add(from);
            dual_alpha_ = longest(lines_.dual_rate(limit));
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
        const Pace pace = direction(corrected_rows_, corrected_defects_, corrected_goal_, other_);
        const double alpha = longest(pace.primal);
        Merit reached{};
        if (!std::isfinite(alpha)) return {false, false};
        const Acceptance verdict = try_step(alpha, other_, from, descent, reached);
        if (verdict.accepted) {
            alpha_ = alpha, dual_alpha_ = longest(pace.dual);
            std::swap(step_, other_);
        }
        return verdict;
    }

    // Accept the trial point; multipliers move by their own step length and are kept near the central path.
    void update() {
        std::swap(point.v, trial_.v), std::swap(point.s, trial_.s), std::swap(point.sb, trial_.sb);
        std::swap(values_, trial_values_);
        for (std::size_t i = 0; i < point.lam.size(); ++i) point.lam[i] += alpha_ * step_.lam[i];
        for (std::size_t i = 0; i < point.nu.size(); ++i) point.nu[i] += alpha_ * step_.nu[i];
        const auto move = [&](const Vector& s, const Vector& dz, Vector& z) {
            over_packs(s.size(), [&](auto zero, std::size_t i) {
                using P = decltype(zero);
                const P central = mu_ / load<P>(&s[i]), moved = load<P>(&z[i]) + dual_alpha_ * load<P>(&dz[i]);
                store(P(smaller(larger(1e-10 * central, moved), 1e10 * central)), &z[i]);
            });
        };
        move(point.s, step_.z, point.z), move(point.sb, step_.zb, point.zb);
        lines_.over_rows([&](int row) { point.z[row] = mu_ / point.s[row]; });
    }

    Filter filter_;
    FittedLines<Model> lines_;
    Options options_;
    Point trial_, step_, other_;
    Pace pace_;  // of step_
    Values<Model> trial_values_;
    Vector corrected_rows_, corrected_defects_, corrected_goal_, samples_;
    double alpha_ = 0, dual_alpha_ = 0, large_violation_ = -1, small_violation_ = 0;
};

}  // namespace tightspot::stagewise
