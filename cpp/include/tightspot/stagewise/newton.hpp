// An iterate of one problem: its values and residuals, and Newton steps from it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tightspot/stagewise/assembly.hpp"
#include "tightspot/stagewise/outcome.hpp"
#include "tightspot/stagewise/point.hpp"
#include "tightspot/stagewise/reductions.hpp"
#include "tightspot/stagewise/sweep.hpp"

namespace tightspot::stagewise {

template <class Model>
class Newton {
   protected:
    using S = Sizes<Model>;
    static constexpr double goal_penalty = 1e6;

   public:
    explicit Newton(Problem problem)
        : problem_(std::move(problem)), layout_(layout_of(problem_, S::nx, S::nu)),
          bounds_(bounds_of(problem_, layout_)), assembly_(problem_, layout_), sweep_(problem_, layout_) {
        point.allocate(layout_, bounds_.size());
        values_.allocate(problem_, layout_);
        assembly_.allocate(gradient_), residual_.assign(layout_.line, 0);
        for (Vector* rows : {&D_, &b_, &row_residual_}) rows->assign(layout_.rows, 0);
        bound_diagonal_.assign(layout_.line, 0), bound_gradient_.assign(layout_.line, 0);
        for (int i = 0; i < layout_.line; ++i) free_.push_back(fixed(i) ? 0.0 : 1.0);
        goal_residual_.assign(S::nx, 0);
    }
    Newton(const Newton&) = delete;
    Newton& operator=(const Newton&) = delete;
    ~Newton() = default;

    Point point;

    const Problem& problem() const { return problem_; }
    const Layout& layout() const { return layout_; }
    const std::vector<Bound>& bounds() const { return bounds_; }
    const Values<Model>& values() const { return values_; }

    // What bounds and fixed values add to the Lagrangian's gradient with respect to states, inputs and t_f.
    Vector bound_multipliers() const {
        Vector result(layout_.line, 0.0);
        for (std::size_t i = 0; i < bounds_.size(); ++i) result[bounds_[i].index] -= bounds_[i].side * point.zb[i];
        for (int i = 0; i < layout_.line; ++i)
            if (fixed(i)) result[i] = -residual_[i];
        return result;
    }

    // The clearance demanded in each row at the last point evaluated.
    Vector demands() const {
        Vector result(layout_.rows, 0.0);
        const int parts = problem_.parts.size();
        for (int k = 0; k < problem_.steps; ++k) {
            RowDemands visitor{values_.covers.data() + k * parts, result.data()};
            visit_rows(problem_, layout_, point.v.data(), values_, k, visitor);
        }
        return result;
    }

    struct Lagrangian {
        Vector gradient, hessian;  // with respect to all variables; the Hessian full
    };

    // For tests: derivatives of f + lam . defects - z . rows at the point, as the Newton system has them.
    Lagrangian lagrangian() {
        const std::size_t n = point.v.size();
        assembly_.evaluate(point.v.data(), values_);
        assembly_.differentiate_all(point.v.data(), values_);
        std::fill(point.zb.begin(), point.zb.end(), 0.0);
        std::fill(point.s.begin(), point.s.end(), std::numeric_limits<double>::infinity());  // no barrier
        lagrangian_gradient();
        Lagrangian out{residual_, Vector(n * n, 0.0)};
        out.gradient.insert(out.gradient.end(), gradient_.lines.begin(), gradient_.lines.end());
        for (int k = 0; k < problem_.steps; ++k) scatter(k, n, out.hessian);
        return out;
    }

   protected:
    // Derivatives at the point and how far it is from optimal.
    Record measure(int iteration) {
        const double* v = point.v.data();
        assembly_.differentiate_all(v, values_);
        set_goal_residual(v, goal_residual_);
        const double *c = values_.rows.data(), *slack = point.s.data();
        for (int i = 0; i < layout_.rows; ++i) row_residual_[i] = c[i] - slack[i];
        violation_ = std::max({magnitude(values_.defects), magnitude(goal_residual_), magnitude(row_residual_)});
        const double scale = multiplier_scale();
        stationarity_ = lagrangian_gradient() / scale;
        scale_ = scale;
        complementarity_ = complementarity(0) / scale;
        Record record;
        record.iteration = iteration, record.objective = values_.objective, record.violation = violation_;
        record.stationarity = stationarity_, record.complementarity = complementarity_, record.barrier = mu_;
        return record;
    }

    static double magnitude(const Vector& values) {
        return largest_magnitude(values.size(), [&](std::size_t i) { return values[i]; });
    }

    void set_goal_residual(const double* v, Vector& out) const {
        for (int i = 0; i < S::nx; ++i)
            out[i] = std::isnan(problem_.goal[i]) ? 0 : v[layout_.x(problem_.steps) + i] - problem_.goal[i];
    }

    double multiplier_scale() const {
        const auto sum = [](const Vector& values) {
            return total(values.size(), [&](std::size_t i) { return std::abs(values[i]); });
        };
        const double count = static_cast<double>(point.lam.size() + point.z.size() + point.zb.size());
        return std::max(100.0, (sum(point.lam) + sum(point.z) + sum(point.zb)) / std::max(count, 1.0)) / 100.0;
    }

    double complementarity(double mu) const {
        const double *s = point.s.data(), *z = point.z.data();
        const double rows = largest_magnitude(point.s.size(), [&](std::size_t i) { return s[i] * z[i] - mu; });
        const double bounds = largest_magnitude(
            bounds_.size(), [&](std::size_t i) { return bounds_[i].slack(point.v) * point.zb[i] - mu; });
        return std::isnan(rows) ? rows : std::max(rows, bounds);
    }

    // Assembles the Hessian and fills residual_; returns its largest entry among free variables, lines included.
    double lagrangian_gradient() {
        for (int i = 0; i < layout_.rows; ++i) D_[i] = point.z[i] / point.s[i];
        std::fill(bound_diagonal_.begin(), bound_diagonal_.end(), 0.0);
        std::fill(bound_gradient_.begin(), bound_gradient_.end(), 0.0);
        for (std::size_t i = 0; i < bounds_.size(); ++i) {
            bound_diagonal_[bounds_[i].index] += point.zb[i] / bounds_[i].slack(point.v);
            bound_gradient_[bounds_[i].index] -= bounds_[i].side * point.zb[i];
        }
        assembly_.set_hessian(point.v.data(), values_, D_.data(), point.z.data(), point.lam.data(),
                              bound_diagonal_.data(), bound_gradient_.data(), gradient_);
        std::fill(residual_.begin(), residual_.end(), 0.0);
        for (int k = 0; k < problem_.steps; ++k) {
            const double *g = gradient_.stages.data() + k * S::nw, *lam = point.lam.data() + k * S::nx;
            const double* F = assembly_.sensitivities.end.data() + k * S::nx * S::na;
            double a[S::na];
            for (int c = 0; c < S::na; ++c) {
                a[c] = g[c];
                for (int j = 0; j < S::nx; ++j) a[c] += F[j * S::na + c] * lam[j];
            }
            for (int i = 0; i < S::nx; ++i) {
                residual_[layout_.x(k) + i] += a[i];
                residual_[layout_.x(k + 1) + i] += g[S::na + i] - lam[i];
            }
            residual_[layout_.time] += a[S::nx];
            for (int i = 0; i < S::nu; ++i) residual_[layout_.u(k) + i] += a[S::nz + i];
        }
        const auto free = [&](std::size_t i) { return free_[i] * residual_[i]; };
        return std::max(largest_magnitude(residual_.size(), free), magnitude(gradient_.lines));
    }

    bool fixed(int index) const {
        if (index < S::nx) return !std::isnan(problem_.start[index]);
        const int last = index - layout_.x(problem_.steps);
        if (last >= 0 && last < S::nx) return !std::isnan(problem_.goal[last]);
        return index == layout_.time && !problem_.free_time();
    }

    bool diverged() const {
        for (double value : point.v)
            if (!(std::abs(value) < 1e10)) return true;
        return false;
    }

    // What of the system depends on mu.
    void set_system() {
        std::fill(bound_gradient_.begin(), bound_gradient_.end(), 0.0);
        for (const Bound& bound : bounds_) bound_gradient_[bound.index] -= bound.side * mu_ / bound.slack(point.v);
    }

    // Factorises with at least the given regularisation; raises it until the reduced Hessian is positive definite.
    bool factor(double& regularisation, Outcome& outcome) {
        while (true) {
            ++outcome.factorisations;
            if (sweep_.factor(assembly_, regularisation, goal_penalty)) break;
            if (regularisation == 0)
                regularisation = last_regularisation_ > 0 ? std::max(1e-20, last_regularisation_ / 3) : 1e-4;
            else
                regularisation *= last_regularisation_ > 0 ? 8 : 100;
            if (!(regularisation < 1e12)) return false;
        }
        if (regularisation > 0) last_regularisation_ = regularisation;
        return true;
    }

    // The Newton step for the given residuals, by the factorisation at hand.
    void direction(const Vector& rows, const Vector& defects, const Vector& goal, Point& step) {
        const double* v = point.v.data();
        const double mu = mu_, *s = point.s.data(), *z = point.z.data(), *D = D_.data(), *r = rows.data();
        double *b = b_.data(), *ds = step.s.data(), *dz = step.z.data();
        for (int i = 0; i < layout_.rows; ++i) b[i] = mu / s[i] - D[i] * r[i];
        assembly_.set_gradient(v, values_, b_.data(), bound_gradient_.data(), gradient_);
        sweep_.solve(assembly_, gradient_, defects.data(), goal.data(), point.nu.data(), goal_penalty, step.v.data(),
                     step.lam.data(), step.nu.data());
        for (std::size_t i = 0; i < step.lam.size(); ++i) step.lam[i] -= point.lam[i];
        for (std::size_t i = 0; i < step.nu.size(); ++i) step.nu[i] -= point.nu[i];
        assembly_.row_steps(v, values_, step.v.data(), step.s.data());
        for (int i = 0; i < layout_.rows; ++i) {
            ds[i] += r[i];
            dz[i] = (mu - z[i] * ds[i]) / s[i] - z[i];
        }
        for (std::size_t i = 0; i < bounds_.size(); ++i) {
            const double move = bounds_[i].side * step.v[bounds_[i].index];
            step.zb[i] = (mu_ - point.zb[i] * move) / bounds_[i].slack(point.v) - point.zb[i];
        }
    }

    Problem problem_;
    Layout layout_;
    std::vector<Bound> bounds_;
    Assembly<Model> assembly_;
    Sweep<Model> sweep_;
    Values<Model> values_;
    Gradient gradient_;
    Vector residual_, D_, b_, row_residual_, bound_diagonal_, bound_gradient_, goal_residual_, free_;
    double mu_ = 0, violation_ = 0, stationarity_ = 0, complementarity_ = 0, scale_ = 1, last_regularisation_ = 0;

   private:
    // Adds interval k's quadratic and its pairs' blocks to a full matrix.
    void scatter(int k, std::size_t n, Vector& full) const {
        std::size_t index[S::nw];
        for (int i = 0; i < S::nx; ++i) index[i] = layout_.x(k) + i, index[S::na + i] = layout_.x(k + 1) + i;
        index[S::nx] = layout_.time;
        for (int i = 0; i < S::nu; ++i) index[S::nz + i] = layout_.u(k) + i;
        const double* W = assembly_.stages.data() + k * S::nw * S::nw;
        for (int i = 0; i < S::nw; ++i)
            for (int j = 0; j < S::nw; ++j) full[index[i] * n + index[j]] += W[i * S::nw + j];
        const int parts = problem_.parts.size();
        for (int p = layout_.pair[k * parts]; p < layout_.pair[(k + 1) * parts]; ++p) {
            const PairBlock<Model>& pair = assembly_.pairs[p];
            const std::size_t phi = layout_.aux(p), mu = phi + 1;
            full[phi * n + phi] += pair.phi_phi, full[mu * n + mu] += pair.mu_mu;
            full[phi * n + mu] += pair.phi_mu, full[mu * n + phi] += pair.phi_mu;
            for (int i = 0; i < S::nw; ++i) {
                full[phi * n + index[i]] += pair.phi[i], full[index[i] * n + phi] += pair.phi[i];
                full[mu * n + index[i]] += pair.mu[i], full[index[i] * n + mu] += pair.mu[i];
            }
        }
    }
};

}  // namespace tightspot::stagewise
