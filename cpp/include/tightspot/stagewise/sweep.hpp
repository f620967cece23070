// Solves the Newton system: what lines the assembly has left are eliminated, the rest is one Riccati sweep over the
// stages.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tightspot/stagewise/assembly.hpp"
#include "tightspot/stagewise/riccati.hpp"

namespace tightspot::stagewise {

template <class Model>
class Sweep {
    using S = Sizes<Model>;
    static constexpr double usual_steps = 20;
    static constexpr int nx = S::nx, nu = S::nu, nz = S::nz, na = S::na, nw = S::nw;

   public:
    Sweep(const Problem& problem, const Layout& layout, const Assembly<Model>& assembly)
        : problem_(problem), layout_(layout), factors_(problem.steps), pair_inverses_(assembly.pairs.size()),
          softened_(assembly.penetrations.size()), penetration_inverses_(assembly.penetrations.size()),
          gradient_(problem.steps * nw), inverses_(3 * assembly.rows.intervals.size()), eliminated_(6 * problem.steps) {}

    // False if the reduced Hessian, with `regularisation` added to its diagonal, is not positive definite. Shorter intervals
    // get less of it, as they have less of the objective.
    bool factor(const Assembly<Model>& assembly, double regularisation, double goal_penalty) {
        double P[nz * na] = {};
        for (int i = 0; i < nx; ++i)
            P[i * (na + 1)] = share(problem_.steps - 1) * regularisation + (std::isnan(problem_.goal[i]) ? 0 : goal_penalty);
        eliminate_uncoupled(assembly);
        for (int k = problem_.steps - 1; k >= 0; --k) {
            const double* F = assembly.sensitivities.end.data() + k * nx * na;
            const double own = share(k) * regularisation;
            bool done;
            if (assembly.coupled(k)) {
                done = factors_[k].template back<true>(without_lines(assembly, k), nullptr, F, own, P);
            } else {
                const double* pose = eliminated_.data() + 6 * k;
                done = factors_[k].template back<false>(assembly.stages[k], pose, F, own, P);
            }
            if (!done) return false;
        }
        return factor_root(P);
    }

    // The step dv, but that of lines that the assembly eliminates, and the new multipliers lam (of the dynamics) and nu (of the goal), for the quadratic with the given
    // gradient, the defects d and the goal's residual. x_0's fixed components do not move.
    void solve(const Assembly<Model>& assembly, const Gradient& gradient, const double* defects,
               const double* goal_residual, const double* goal_multiplier, double goal_penalty, double* dv, double* lam,
               double* nu_new) {
        double p[na] = {};
        for (int i = 0; i < nx; ++i)
            if (!std::isnan(problem_.goal[i])) p[i] = goal_penalty * goal_residual[i] + goal_multiplier[i];
        gradient_ = gradient.stages;
        reduce_uncoupled(assembly, gradient);
        for (int k = problem_.steps - 1; k >= 0; --k) {
            const double* F = assembly.sensitivities.end.data() + k * nx * na;
            double* g = gradient_.data() + k * nw;
            if (assembly.coupled(k)) {
                reduce_gradient(assembly, gradient, k);
                factors_[k].template vector_back<true>(g, F, defects + k * nx, p);
            } else {
                factors_[k].template vector_back<false>(g, F, defects + k * nx, p);
            }
        }
        solve_root(p, dv);
        for (int k = 0; k < problem_.steps; ++k) step_forward(assembly, k, defects + k * nx, dv, lam + k * nx);
        const double* end = dv + layout_.x(problem_.steps);
        for (int i = 0; i < nx; ++i)
            nu_new[i] = std::isnan(problem_.goal[i])
                            ? 0
                            : goal_multiplier[i] + goal_penalty * (end[i] + goal_residual[i]);
        step_uncoupled(assembly, gradient, dv);
        for (int k = 0; k < problem_.steps; ++k)
            if (assembly.coupled(k)) step_lines(assembly, gradient, k, dv);
    }

   private:
    double share(int k) const { return usual_steps * problem_.widths[k]; }

    // Groups of lines that only x_{k+1} matters to, with their packs.
    template <class Body>
    static void over_uncoupled(const Assembly<Model>& assembly, Body&& body) {
        over_groups(assembly.rows.pairs, [&](auto P, const RowGroup& group) {
            if (!group.coupled) body(P, group, assembly.curvature.blocks.data() + group.block);
        });
    }

    void eliminate_uncoupled(const Assembly<Model>& assembly) {
        std::fill(eliminated_.begin(), eliminated_.end(), 0.0);
        over_uncoupled(assembly, [&](auto zero, const RowGroup& group, const double* at) {
            using P = decltype(zero);
            Reader<P> block{at};
            const LineInverse<P> inverse = invert_lines(block, inverses_.data() + 3 * group.line);
            block.at += 2 * lane_count<P>;
            P phi[3], mu[3], r[3], s[3];
            for (P& entry : phi) entry = block.next();
            for (P& entry : mu) entry = block.next();
            for (int i = 0; i < 3; ++i) {
                r[i] = inverse.phi_phi * phi[i] + inverse.phi_mu * mu[i];
                s[i] = inverse.phi_mu * phi[i] + inverse.mu_mu * mu[i];
            }
            const auto entry = [&](int i, int j) { return -(phi[i] * r[j] + mu[i] * s[j]); };
            const P all[6] = {entry(0, 0), entry(0, 1), entry(1, 1), entry(0, 2), entry(1, 2), entry(2, 2)};
            scatter_add(all, eliminated_.data(), assembly.rows.intervals.data() + group.line, 6);
        });
    }

    // Pairs of a coupled interval that are eliminated one by one.
    template <class Body>
    static void over_single(const Assembly<Model>& assembly, int k, Body&& body) {
        const RowGroups& rows = assembly.rows;
        for (int place = rows.first_single[k]; place < rows.first_single[k + 1]; ++place) body(rows.single[place]);
    }

    // A coupled interval's quadratic without lines; `stage_` holds it if there were any.
    const StageQuadratic<Model>& without_lines(const Assembly<Model>& assembly, int k) {
        if (assembly.rows.first_single[k] == assembly.rows.first_single[k + 1]) return assembly.stages[k];
        stage_ = assembly.stages[k];
        over_single(assembly, k, [&](int i) {
            if (layout_.soft[i] >= 0) eliminate_penetration(assembly, i, stage_);
            const PairBlock<Model>& pair = block(assembly, i);
            const LineInverse<double> inverse = pair_inverses_[i] =
                invert_line<double>(pair.phi_phi, pair.phi_mu, pair.mu_mu);
            double phi[nw], mu[nw];
            for (int c = 0; c < nw; ++c) {
                phi[c] = inverse.phi_phi * pair.phi[c] + inverse.phi_mu * pair.mu[c];
                mu[c] = inverse.phi_mu * pair.phi[c] + inverse.mu_mu * pair.mu[c];
            }
            stage_.subtract_outer(pair.phi, phi, pair.mu, mu);
        });
        return stage_;
    }

    // A pair's block, without the penetration if it is soft.
    const PairBlock<Model>& block(const Assembly<Model>& assembly, int pair) const {
        const int j = layout_.soft[pair];
        return j < 0 ? assembly.pairs[pair] : softened_[j];
    }

    // The penetration's pivot is a sum of barrier weights. What it leaves of mu's curvature is that of the obstacle's rows
    // and, like two springs in series, that of the body's rows and of sigma >= 0: no difference is taken.
    void eliminate_penetration(const Assembly<Model>& assembly, int i, StageQuadratic<Model>& stage) {
        const int j = layout_.soft[i];
        const PairBlock<Model>& pair = assembly.pairs[i];
        const PenetrationBlock<Model>& of = assembly.penetrations[j];
        PairBlock<Model>& left = softened_[j];
        const double inverse = penetration_inverses_[j] = 1 / (of.weight + of.own);
        const double phi = of.phi * inverse, mu = of.weight * inverse;
        left.phi_phi = pair.phi_phi - of.phi * phi;
        left.phi_mu = pair.phi_mu + of.weight * phi;
        left.mu_mu = of.obstacle + of.own * mu;
        for (int c = 0; c < nw; ++c) left.phi[c] = pair.phi[c] - phi * of.w[c], left.mu[c] = pair.mu[c] + mu * of.w[c];
        stage.subtract_square(inverse, of.w);
    }

    // The gradient with respect to a pair's phi and mu; without the penetration if it is soft.
    struct LineGradient {
        double phi, mu;
    };
    LineGradient line_gradient(const Assembly<Model>& assembly, const Gradient& gradient, int i) const {
        const LineGradient line{assembly.line_force(gradient, i, 0), assembly.line_force(gradient, i, 1)};
        const int j = layout_.soft[i];
        if (j < 0) return line;
        const PenetrationBlock<Model>& of = assembly.penetrations[j];
        const double move = gradient.forces.penetrations[j] * penetration_inverses_[j];
        return {line.phi - of.phi * move, line.mu + of.weight * move};
    }

    // The components of z_0 that are free: (x_0's free ones, t_f).
    bool factor_root(const double* P) {
        n_free_ = 0;
        for (int i = 0; i < nx; ++i)
            if (std::isnan(problem_.start[i])) free_[n_free_++] = i;
        if (problem_.free_time()) free_[n_free_++] = nx;
        for (int r = 0; r < n_free_; ++r)
            for (int c = 0; c < n_free_; ++c) root_[r * nz + c] = P[free_[std::min(r, c)] * na + free_[std::max(r, c)]];
        return cholesky<nz>(root_, n_free_, 1e-12);
    }

    void reduce_uncoupled(const Assembly<Model>& assembly, const Gradient& gradient) {
        over_uncoupled(assembly, [&](auto zero, const RowGroup& group, const double* block) {
            using P = decltype(zero);
            const LineStep<P> line(inverses_.data() + 3 * group.line, gradient.forces.lines.data() + 2 * group.line);
            Reader<P> phi{block + 5 * lane_count<P>}, mu{block + 8 * lane_count<P>};
            P all[3];
            for (P& entry : all) entry = phi.next() * line.phi + mu.next() * line.mu;
            scatter_add(all, gradient_.data() + na, assembly.rows.intervals.data() + group.line, nw);
        });
    }

    void reduce_gradient(const Assembly<Model>& assembly, const Gradient& gradient, int k) {
        double* g = gradient_.data() + k * nw;
        over_single(assembly, k, [&](int i) {
            const PairBlock<Model>& pair = block(assembly, i);
            const LineInverse<double>& inverse = pair_inverses_[i];
            const auto [a, b] = line_gradient(assembly, gradient, i);
            const double phi = inverse.phi_phi * a + inverse.phi_mu * b, mu = inverse.phi_mu * a + inverse.mu_mu * b;
            for (int c = 0; c < nw; ++c) g[c] -= pair.phi[c] * phi + pair.mu[c] * mu;
            const int j = layout_.soft[i];
            if (j < 0) return;
            const double move = gradient.forces.penetrations[j] * penetration_inverses_[j];
            for (int c = 0; c < nw; ++c) g[c] -= assembly.penetrations[j].w[c] * move;
        });
    }

    void solve_root(const double* p, double* dv) {
        double step[nz];
        for (int i = 0; i < n_free_; ++i) step[i] = -p[free_[i]];
        cholesky_solve<nz>(root_, n_free_, step);
        for (int i = 0; i < nx; ++i) dv[i] = 0;
        dv[layout_.time] = 0;
        for (int i = 0; i < n_free_; ++i) dv[free_[i] < nx ? free_[i] : layout_.time] = step[i];
    }

    void step_forward(const Assembly<Model>& assembly, int k, const double* d, double* dv, double* lam) const {
        const double *F = assembly.sensitivities.end.data() + k * nx * na, *x = dv + layout_.x(k);
        double a[na] = {}, *next = dv + layout_.x(k + 1);
        for (int i = 0; i < nx; ++i) a[i] = x[i];
        a[nx] = dv[layout_.time];
        if (assembly.coupled(k))
            factors_[k].template forward<true>(F, d, a, next, lam);
        else
            factors_[k].template forward<false>(F, d, a, next, lam);
        for (int i = 0; i < nu; ++i) dv[layout_.u(k) + i] = a[nz + i];
    }

    void step_uncoupled(const Assembly<Model>& assembly, const Gradient& gradient, double* dv) const {
        over_uncoupled(assembly, [&](auto zero, const RowGroup& group, const double* block) {
            using P = decltype(zero);
            Reader<P> phi{block + 5 * lane_count<P>}, mu{block + 8 * lane_count<P>};
            P more_phi = 0.0, more_mu = 0.0;
            const int* intervals = assembly.rows.intervals.data() + group.line;
            for (int i = 0; i < 3; ++i) {
                const P pose = gather<P>(dv + layout_.x(1) + i, intervals, nx);
                more_phi += phi.next() * pose, more_mu += mu.next() * pose;
            }
            const LineStep<P> line(inverses_.data() + 3 * group.line, gradient.forces.lines.data() + 2 * group.line,
                                   more_phi, more_mu);
            for (int l = 0; l < lane_count<P>; ++l) {
                double* to = dv + layout_.aux(assembly.rows.line_pairs[group.line + l]);
                to[0] = lane(line.phi, l), to[1] = lane(line.mu, l);
            }
        });
    }

    void step_lines(const Assembly<Model>& assembly, const Gradient& gradient, int k, double* dv) const {
        if (assembly.rows.first_single[k] == assembly.rows.first_single[k + 1]) return;
        double w[nw];
        assembly.gather(dv, k, w);
        over_single(assembly, k, [&](int i) {
            const PairBlock<Model>& pair = block(assembly, i);
            auto [phi, mu] = line_gradient(assembly, gradient, i);
            for (int c = 0; c < nw; ++c) phi += pair.phi[c] * w[c], mu += pair.mu[c] * w[c];
            const LineInverse<double>& inverse = pair_inverses_[i];
            dv[layout_.aux(i)] = -inverse.phi_phi * phi - inverse.phi_mu * mu;
            dv[layout_.aux(i) + 1] = -inverse.phi_mu * phi - inverse.mu_mu * mu;
            if (layout_.soft[i] >= 0) step_penetration(assembly, gradient, i, w, dv);
        });
    }

    void step_penetration(const Assembly<Model>& assembly, const Gradient& gradient, int i, const double* w,
                          double* dv) const {
        const int j = layout_.soft[i];
        const PenetrationBlock<Model>& of = assembly.penetrations[j];
        const double* line = dv + layout_.aux(i);
        double sum = gradient.forces.penetrations[j] + of.phi * line[0] - of.weight * line[1];
        for (int c = 0; c < nw; ++c) sum += of.w[c] * w[c];
        dv[layout_.sigma + j] = -sum * penetration_inverses_[j];
    }

    const Problem& problem_;
    const Layout& layout_;
    std::vector<RiccatiStage<Model>> factors_;
    std::vector<LineInverse<double>> pair_inverses_;  // of pairs in coupled intervals
    StageQuadratic<Model> stage_;                     // see `without_lines`
    std::vector<PairBlock<Model>> softened_;          // of soft pairs, see `block`
    Vector penetration_inverses_;
    Vector gradient_;
    Vector inverses_;    // of groups of other lines, packs: phi phi, phi mu, mu mu
    Vector eliminated_;  // what these lines leave at the pose of x_{k+1}: xx, xy, yy, x theta, y theta, theta theta
    int free_[nz], n_free_ = 0;
    double root_[nz * nz];
};

}  // namespace tightspot::stagewise
