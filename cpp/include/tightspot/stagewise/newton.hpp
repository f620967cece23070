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
          bounds_(bounds_of(problem_, layout_)), assembly_(problem_, layout_), sweep_(problem_, layout_, assembly_) {
        point.allocate(layout_, bounds_.size());
        assembly_.allocate(values_);
        assembly_.allocate(gradient_), residual_.assign(layout_.line, 0), free_residual_.assign(layout_.line, 0);
        for (Vector* rows : {&D_, &b_, &row_residual_, &inverse_}) rows->assign(layout_.rows, 0);
        bound_inverse_.assign(bounds_.size(), 0);
        bound_diagonal_.assign(layout_.line, 0), bound_gradient_.assign(layout_.line, 0);
        free_.resize(layout_.line);
        for (int i = 0; i < layout_.line; ++i) free_[i] = fixed(i) ? 0.0 : 1.0;
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

    // Other values of start and goal. False, and nothing changes, if others of them are free than before.
    bool move_ends(const Vector& start, const Vector& goal) {
        const auto as_free = [](const Vector& one, const Vector& other) {
            return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                              [](double a, double b) { return std::isnan(a) == std::isnan(b) && !std::isinf(a); });
        };
        if (!as_free(start, problem_.start) || !as_free(goal, problem_.goal)) return false;
        problem_.start = start, problem_.goal = goal;
        return true;
    }

    // Numbers of the rows in the problem's order (see Problem) from those in the solver's, and back.
    Vector in_order(const Vector& of_rows) const {
        Vector result(of_rows.size());
        for (std::size_t i = 0; i < result.size(); ++i) result[i] = of_rows[assembly_.rows.place[i]];
        return result;
    }
    void put_in_place(const Vector& in_order, Vector& of_rows) const {
        for (std::size_t i = 0; i < in_order.size(); ++i) of_rows[assembly_.rows.place[i]] = in_order[i];
    }

    // What bounds and fixed values add to the Lagrangian's gradient with respect to states, inputs and t_f.
    Vector bound_multipliers() const {
        Vector result(layout_.line, 0.0);
        for (std::size_t i = 0; i < bounds_.size(); ++i) result[bounds_[i].index] -= bounds_[i].side * point.zb[i];
        for (int i = 0; i < layout_.line; ++i)
            if (fixed(i)) result[i] = -residual_[i];
        return result;
    }

    // The clearance demanded in each row at the last point evaluated, in the problem's order.
    Vector demands() const {
        Vector result(layout_.rows, 0.0);
        assembly_.row_demands(values_, result.data());
        return in_order(result);
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
        weigh();
        lagrangian_gradient(true);
        Lagrangian out{residual_, Vector(n * n, 0.0)};
        for (int pair = 0; pair < static_cast<int>(problem_.pairs.size()); ++pair)
            for (int which : {0, 1}) out.gradient.push_back(assembly_.line_force(gradient_, pair, which));
        const Vector& penetrations = gradient_.forces.penetrations;
        out.gradient.insert(out.gradient.end(), penetrations.begin(), penetrations.end());
        for (int k = 0; k < problem_.steps; ++k) scatter(k, n, out.hessian);
        return out;
    }

   protected:
    // Derivatives at the point and how far it is from optimal.
    Record measure(int iteration) {
        const double* v = point.v.data();
        assembly_.differentiate_all(v, values_);
        set_goal_residual(v, goal_residual_);
        weigh();
        violation_ = std::max({size(values_.defects), size(goal_residual_), size(row_residual_)});
        const double count = static_cast<double>(point.lam.size() + point.z.size() + point.zb.size());
        const double multipliers = sum_of_magnitudes(point.lam.data(), point.lam.size()) + multipliers_;
        scale_ = std::max(100.0, multipliers / std::max(count, 1.0)) / 100.0;
        stationarity_ = lagrangian_gradient() / scale_;
        complementarity_ = products_.most / scale_;
        Record record;
        record.iteration = iteration, record.objective = values_.objective, record.violation = violation_;
        record.stationarity = stationarity_, record.complementarity = complementarity_, record.barrier = mu_;
        return record;
    }

    static double size(const Vector& values) { return largest_magnitude(values.data(), values.size()); }

    void set_goal_residual(const double* v, Vector& out) const {
        for (int i = 0; i < S::nx; ++i)
            out[i] = std::isnan(problem_.goal[i]) ? 0 : v[layout_.x(problem_.steps) + i] - problem_.goal[i];
    }

    // Reciprocals, weights D = z/s, residuals c - s, and the products s z of rows and bounds.
    void weigh() {
        Sum products, multipliers;
        Most most(0), least(-std::numeric_limits<double>::infinity());
        const auto reciprocal = [&](auto s, auto z, double* inverse) {
            const auto product = s * z, one = 1.0 / s;
            products.add(product), multipliers.add(z), most.add(product), least.add(-product);
            store(one, inverse);
            return one;
        };
        over_packs(point.s.size(), [&](auto zero, std::size_t i) {
            using P = decltype(zero);
            const P s = load<P>(&point.s[i]), z = load<P>(&point.z[i]);
            store(P(z * reciprocal(s, z, &inverse_[i])), &D_[i]);
            store(P(load<P>(&values_.rows[i]) - s), &row_residual_[i]);
        });
        point.settle_bounds(bounds_);
        over_packs(bounds_.size(), [&](auto zero, std::size_t i) {
            using P = decltype(zero);
            reciprocal(load<P>(&point.sb[i]), load<P>(&point.zb[i]), &bound_inverse_[i]);
        });
        const double sum = products.value();
        products_ = {sum, -least.value(), std::isnan(sum) ? sum : most.value()};
        multipliers_ = multipliers.value();
    }

    // Assembles the Hessian and fills residual_; returns its largest entry among free variables, lines included.
    // See Assembly::set_hessian for `whole`.
    double lagrangian_gradient(bool whole = false) {
        std::fill(bound_diagonal_.begin(), bound_diagonal_.end(), 0.0);
        std::fill(bound_gradient_.begin(), bound_gradient_.end(), 0.0);
        for (std::size_t i = 0; i < bounds_.size(); ++i) {
            bound_diagonal_[bounds_[i].index] += point.zb[i] * bound_inverse_[i];
            bound_gradient_[bounds_[i].index] -= bounds_[i].side * point.zb[i];
        }
        assembly_.set_hessian(point.v.data(), values_, D_.data(), point.z.data(), point.lam.data(),
                              bound_diagonal_.data(), bound_gradient_.data(), whole, gradient_);
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
        for (std::size_t i = 0; i < residual_.size(); ++i) free_residual_[i] = free_[i] * residual_[i];
        return std::max({size(free_residual_), size(gradient_.forces.lines), size(gradient_.forces.penetrations)});
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
        for (std::size_t i = 0; i < bounds_.size(); ++i)
            bound_gradient_[bounds_[i].index] -= bounds_[i].side * mu_ * bound_inverse_[i];
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

    // How fast a step uses up slacks and multipliers.
    struct Pace {
        double primal = 0, dual = 0;  // the largest -ds/s and -dz/z
        double slope = 0;             // of the sum of the slacks' logarithms
    };

    // The Newton step for the given residuals, by the factorisation at hand.
    Pace direction(const Vector& rows, const Vector& defects, const Vector& goal, Point& step) {
        const double mu = mu_;
        over_packs(rows.size(), [&](auto zero, std::size_t i) {
            using P = decltype(zero);
            store(P(mu * load<P>(&inverse_[i]) - load<P>(&D_[i]) * load<P>(&rows[i])), &b_[i]);
        });
        assembly_.set_gradient(point.v.data(), values_, b_.data(), bound_gradient_.data(), gradient_);
        sweep_.solve(assembly_, gradient_, defects.data(), goal.data(), point.nu.data(), goal_penalty, step.v.data(),
                     step.lam.data(), step.nu.data());
        for (std::size_t i = 0; i < step.lam.size(); ++i) step.lam[i] -= point.lam[i];
        for (std::size_t i = 0; i < step.nu.size(); ++i) step.nu[i] -= point.nu[i];
        assembly_.row_steps(values_, gradient_, step.v.data(), step.s.data());
        for (std::size_t i = 0; i < bounds_.size(); ++i) step.sb[i] = bounds_[i].side * step.v[bounds_[i].index];
        Most primal(0), dual(0);
        Sum slope;
        const auto multiplier = [&](auto ds, auto z, auto inverse) {
            const auto rate = ds * inverse, dz = mu * inverse - z * rate - z;
            primal.add(-rate), slope.add(rate), dual.add(-dz / z);
            return dz;
        };
        over_packs(rows.size(), [&](auto zero, std::size_t i) {
            using P = decltype(zero);
            const P ds = load<P>(&step.s[i]) + load<P>(&rows[i]);
            store(ds, &step.s[i]);
            store(P(multiplier(ds, load<P>(&point.z[i]), load<P>(&inverse_[i]))), &step.z[i]);
        });
        over_packs(bounds_.size(), [&](auto zero, std::size_t i) {
            using P = decltype(zero);
            const P dz = multiplier(load<P>(&step.sb[i]), load<P>(&point.zb[i]), load<P>(&bound_inverse_[i]));
            store(dz, &step.zb[i]);
        });
        return {primal.value(), dual.value(), slope.value()};
    }

    // Of the products s z of rows and bounds.
    struct Products {
        double sum = 0, least = 0, most = 0;
    };

    Problem problem_;
    Layout layout_;
    std::vector<Bound> bounds_;
    Assembly<Model> assembly_;
    Sweep<Model> sweep_;
    Values<Model> values_;
    Gradient gradient_;
    Vector residual_, free_residual_, D_, b_, row_residual_, inverse_, bound_inverse_, bound_diagonal_, bound_gradient_;
    Vector goal_residual_, free_;
    Products products_;
    double mu_ = 0, violation_ = 0, stationarity_ = 0, complementarity_ = 0, scale_ = 1, last_regularisation_ = 0;
    double multipliers_ = 0;  // sum of those of rows and bounds

   private:
    // Adds interval k's quadratic and its pairs' blocks to a full matrix.
    void scatter(int k, std::size_t n, Vector& full) const {
        std::size_t index[S::nw];
        for (int i = 0; i < S::nx; ++i) index[i] = layout_.x(k) + i, index[S::na + i] = layout_.x(k + 1) + i;
        index[S::nx] = layout_.time;
        for (int i = 0; i < S::nu; ++i) index[S::nz + i] = layout_.u(k) + i;
        const StageQuadratic<Model>& stage = assembly_.stages[k];
        for (int i = 0; i < S::na; ++i)
            for (int j = 0; j < S::na; ++j) full[index[i] * n + index[j]] += stage.own[i * S::na + j];
        for (int i = 0; i < S::nx; ++i) {
            const std::size_t ahead = index[S::na + i] * n;
            for (int j = 0; j < S::nx; ++j) full[ahead + index[S::na + j]] += stage.ahead[i * S::na + j];
            for (int j = 0; assembly_.coupled(k) && j < S::na; ++j) {
                full[ahead + index[j]] += stage.mixed[i * S::na + j];
                full[index[j] * n + index[S::na + i]] += stage.mixed[i * S::na + j];
            }
        }
        const int parts = problem_.parts.size();
        for (int p = layout_.pair[k * parts]; p < layout_.pair[(k + 1) * parts]; ++p) {
            const PairBlock<Model> pair = assembly_.pair_block(p);
            const std::size_t phi = layout_.aux(p), mu = phi + 1;
            full[phi * n + phi] += pair.phi_phi, full[mu * n + mu] += pair.mu_mu;
            full[phi * n + mu] += pair.phi_mu, full[mu * n + phi] += pair.phi_mu;
            for (int i = 0; i < S::nw; ++i) {
                full[phi * n + index[i]] += pair.phi[i], full[index[i] * n + phi] += pair.phi[i];
                full[mu * n + index[i]] += pair.mu[i], full[index[i] * n + mu] += pair.mu[i];
            }
        }
        for (int j = layout_.penetration[k]; j < layout_.penetration[k + 1]; ++j) {
            const PenetrationBlock<Model>& block = assembly_.penetrations[j];
            const std::size_t phi = layout_.aux(layout_.soft_pairs[j]), mu = phi + 1, sigma = layout_.sigma + j;
            full[sigma * n + sigma] += block.weight + block.own;
            full[sigma * n + phi] += block.phi, full[phi * n + sigma] += block.phi;
            full[sigma * n + mu] -= block.weight, full[mu * n + sigma] -= block.weight;
            for (int i = 0; i < S::nw; ++i)
                full[sigma * n + index[i]] += block.w[i], full[index[i] * n + sigma] += block.w[i];
        }
    }
};

}  // namespace tightspot::stagewise
