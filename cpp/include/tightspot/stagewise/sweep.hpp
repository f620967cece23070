// Solves the Newton system: lines are eliminated pair by pair, the rest is one Riccati sweep over the stages.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tightspot/stagewise/assembly.hpp"

namespace tightspot::stagewise {

// A line's 2 x 2 block, made positive definite if need be, inverted.
template <class P>
struct LineInverse {
    P phi_phi, phi_mu, mu_mu;
};

// Inverse of [[a, b], [b, d]] with d > 0. If its Schur complement a - b^2/d is not clearly positive, a is raised so that
// the complement becomes its own absolute value: the line's own convexification, which leaves the vehicle's alone.
template <class P>
inline LineInverse<P> invert_line(P a, P b, P d) {
    // a is a sum as large as b^2/d; what is left of it must stand out from its rounding.
    const P ratio = b / d, floor = larger(1e-13 * magnitude(b * ratio), P(1e-10)), rest = a - b * ratio;
    const P inverse = 1.0 / choose(rest, floor, rest, larger(magnitude(rest), 10.0 * floor));
    return {inverse, -inverse * ratio, 1.0 / d + inverse * ratio * ratio};
}

template <class Model>
class Sweep {
    using S = Sizes<Model>;
    static constexpr int nx = S::nx, nu = S::nu, nz = S::nz, na = S::na, nw = S::nw;

    struct StageFactor {
        double ahead[nz * nz];   // P' = P_{k+1} plus the interval's own quadratic in (x_{k+1}, t_f)
        double mixed[nx * na];   // C: derivatives mixed between x_{k+1} and (x_k, u_k)
        double inputs[nu * nu];  // Cholesky factor of the inputs' block
        double cross[nu * nz];   // mixed derivatives of inputs and z
        double gain[nu * nz];
        double offset[nu], value[nz];  // of the vector sweep
    };

   public:
    Sweep(const Problem& problem, const Layout& layout, const Assembly<Model>& assembly)
        : problem_(problem), layout_(layout), factors_(problem.steps), pair_inverses_(assembly.pairs.size()),
          gradient_(problem.steps * nw), inverses_(3 * assembly.rows.intervals.size()), eliminated_(6 * problem.steps) {}

    // False if the reduced Hessian, with `regularisation` added to its diagonal, is not positive definite.
    bool factor(const Assembly<Model>& assembly, double regularisation, double goal_penalty) {
        double P[nz * nz] = {};
        for (int i = 0; i < nx; ++i)
            if (!std::isnan(problem_.goal[i])) P[i * (nz + 1)] = goal_penalty + regularisation;
            else P[i * (nz + 1)] = regularisation;
        eliminate_uncoupled(assembly);
        for (int k = problem_.steps - 1; k >= 0; --k) {
            const double* F = assembly.sensitivities.end.data() + k * nx * na;
            bool done;
            if (assembly.coupled(k)) {
                StageQuadratic<Model> stage = assembly.stages[k];
                eliminate_lines(assembly, k, stage);
                done = step_back<true>(stage, F, regularisation, P, factors_[k]);
            } else {
                add_pose_block(eliminated_.data() + 6 * k, P, nz);
                done = step_back<false>(assembly.stages[k], F, regularisation, P, factors_[k]);
            }
            if (!done) return false;
        }
        return factor_root(P);
    }

    // The step dv and the new multipliers lam (of the dynamics) and nu (of the goal), for the quadratic with the given
    // gradient, the defects d and the goal's residual. x_0's fixed components do not move.
    void solve(const Assembly<Model>& assembly, const Gradient& gradient, const double* defects,
               const double* goal_residual, const double* goal_multiplier, double goal_penalty, double* dv, double* lam,
               double* nu_new) {
        double p[nz] = {};
        for (int i = 0; i < nx; ++i)
            if (!std::isnan(problem_.goal[i])) p[i] = goal_penalty * goal_residual[i] + goal_multiplier[i];
        gradient_ = gradient.stages;
        reduce_uncoupled(assembly, gradient);
        for (int k = problem_.steps - 1; k >= 0; --k) {
            if (assembly.coupled(k)) reduce_gradient(assembly, gradient, k);
            vector_back(assembly, k, defects + k * nx, p);
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
            const P a = block.next(), b = block.next(), d = block.next();
            const LineInverse<P> inverse = invert_line<P>(a, b, d);
            Writer<P> kept{inverses_.data() + 3 * group.line};
            kept.put(inverse.phi_phi), kept.put(inverse.phi_mu), kept.put(inverse.mu_mu);
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

    void eliminate_lines(const Assembly<Model>& assembly, int k, StageQuadratic<Model>& stage) {
        const int parts = problem_.parts.size();
        for (int i = layout_.pair[k * parts]; i < layout_.pair[(k + 1) * parts]; ++i) {
            const PairBlock<Model>& pair = assembly.pairs[i];
            const LineInverse<double> inverse = pair_inverses_[i] =
                invert_line<double>(pair.phi_phi, pair.phi_mu, pair.mu_mu);
            double phi[nw], mu[nw];
            for (int c = 0; c < nw; ++c) {
                phi[c] = inverse.phi_phi * pair.phi[c] + inverse.phi_mu * pair.mu[c];
                mu[c] = inverse.phi_mu * pair.phi[c] + inverse.mu_mu * pair.mu[c];
            }
            stage.add_outer(-1.0, pair.phi, phi);
            stage.add_outer(-1.0, pair.mu, mu);
        }
    }

    // From P = P_{k+1} to P_k.
    template <bool coupled>
    static bool step_back(const StageQuadratic<Model>& stage, const double* F, double regularisation, double* P,
                          StageFactor& out) {
        for (int i = 0; i < nx; ++i) {
            for (int j = 0; j < nx; ++j) P[i * nz + j] += stage.ahead[i * nx + j];
            if (!coupled) continue;
            for (int c = 0; c < na; ++c) out.mixed[i * na + c] = c != nx ? stage.mixed[i * na + c] : 0;
            P[i * nz + nx] += stage.mixed[i * na + nx];
            P[nx * nz + i] += stage.mixed[i * na + nx];
        }
        for (int i = 0; i < nz * nz; ++i) out.ahead[i] = P[i];
        double M[nz * na], G[na * na];
        for (int i = 0; i < nz; ++i) {
            double row[na] = {};
            for (int j = 0; j < nx; ++j)
                for (int c = 0; c < na; ++c) row[c] += P[i * nz + j] * F[j * na + c];
            row[nx] += P[i * nz + nx];
            for (int c = 0; c < na; ++c) M[i * na + c] = row[c];
        }
        for (int r = 0; r < na; ++r) {
            double row[na];
            for (int c = 0; c < na; ++c) row[c] = stage.own[r * na + c];
            row[r] += regularisation;
            for (int j = 0; j < nx; ++j)
                for (int c = 0; c < na; ++c) row[c] += F[j * na + r] * M[j * na + c];
            if (r == nx)
                for (int c = 0; c < na; ++c) row[c] += M[nx * na + c];
            for (int c = 0; c < na; ++c) G[r * na + c] = row[c];
        }
        if (coupled)
            for (int r = 0; r < na; ++r)
                for (int j = 0; j < nx; ++j)
                    for (int c = 0; c < na; ++c)
                        G[r * na + c] += out.mixed[j * na + r] * F[j * na + c] + F[j * na + r] * out.mixed[j * na + c];
        for (int i = 0; i < nu; ++i) {
            for (int j = 0; j < nu; ++j) out.inputs[i * nu + j] = G[(nz + i) * na + nz + j];
            for (int c = 0; c < nz; ++c) out.cross[i * nz + c] = G[(nz + i) * na + c];
        }
        if (!cholesky<nu>(out.inputs, nu, 1e-12)) return false;
        // Y = L^{-1} cross; P_k = G_zz - Y' Y; gain = -L^{-T} Y.
        double Y[nu * nz];
        for (int i = 0; i < nu; ++i) {
            double row[nz];
            for (int c = 0; c < nz; ++c) row[c] = out.cross[i * nz + c];
            for (int j = 0; j < i; ++j)
                for (int c = 0; c < nz; ++c) row[c] -= out.inputs[i * nu + j] * Y[j * nz + c];
            const double inverse = 1 / out.inputs[i * nu + i];
            for (int c = 0; c < nz; ++c) Y[i * nz + c] = inverse * row[c];
        }
        for (int i = nu - 1; i >= 0; --i) {
            double row[nz];
            for (int c = 0; c < nz; ++c) row[c] = -Y[i * nz + c];
            for (int j = i + 1; j < nu; ++j)
                for (int c = 0; c < nz; ++c) row[c] -= out.inputs[j * nu + i] * out.gain[j * nz + c];
            const double inverse = 1 / out.inputs[i * nu + i];
            for (int c = 0; c < nz; ++c) out.gain[i * nz + c] = inverse * row[c];
        }
        for (int r = 0; r < nz; ++r) {
            double row[nz];
            for (int c = 0; c < nz; ++c) row[c] = G[r * na + c];
            for (int i = 0; i < nu; ++i)
                for (int c = 0; c < nz; ++c) row[c] -= Y[i * nz + r] * Y[i * nz + c];
            for (int c = 0; c < nz; ++c) P[r * nz + c] = row[c];
        }
        for (int r = 0; r < nz; ++r)
            for (int c = 0; c < r; ++c) P[c * nz + r] = P[r * nz + c];
        return true;
    }

    // The components of z_0 that are free: (x_0's free ones, t_f).
    bool factor_root(const double* P) {
        n_free_ = 0;
        for (int i = 0; i < nx; ++i)
            if (std::isnan(problem_.start[i])) free_[n_free_++] = i;
        if (problem_.free_time()) free_[n_free_++] = nx;
        for (int r = 0; r < n_free_; ++r)
            for (int c = 0; c < n_free_; ++c) root_[r * nz + c] = P[free_[r] * nz + free_[c]];
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

    // The step of lines, phi and mu, by their inverses for the given gradient.
    template <class P>
    struct LineStep {
        P phi, mu;

        LineStep(const double* inverses, const double* gradient, P more_phi = 0.0, P more_mu = 0.0) {
            Reader<P> inverse{inverses}, g{gradient};
            const P a = inverse.next(), b = inverse.next(), d = inverse.next();
            const P g_phi = g.next() + more_phi, g_mu = g.next() + more_mu;
            phi = -a * g_phi - b * g_mu, mu = -b * g_phi - d * g_mu;
        }
    };

    void reduce_gradient(const Assembly<Model>& assembly, const Gradient& gradient, int k) {
        const int parts = problem_.parts.size();
        double* g = gradient_.data() + k * nw;
        for (int i = layout_.pair[k * parts]; i < layout_.pair[(k + 1) * parts]; ++i) {
            const PairBlock<Model>& pair = assembly.pairs[i];
            const LineInverse<double>& inverse = pair_inverses_[i];
            const double a = assembly.line_force(gradient, i, 0), b = assembly.line_force(gradient, i, 1);
            const double phi = inverse.phi_phi * a + inverse.phi_mu * b, mu = inverse.phi_mu * a + inverse.mu_mu * b;
            for (int c = 0; c < nw; ++c) g[c] -= pair.phi[c] * phi + pair.mu[c] * mu;
        }
    }

    void vector_back(const Assembly<Model>& assembly, int k, const double* d, double* p) {
        StageFactor& stage = factors_[k];
        const double *g = gradient_.data() + k * nw, *F = assembly.sensitivities.end.data() + k * nx * na;
        for (int i = 0; i < nx; ++i) p[i] += g[na + i];
        for (int i = 0; i < nz; ++i) stage.value[i] = p[i];
        double q[nz], h[na];
        for (int i = 0; i < nz; ++i) {
            q[i] = p[i];
            for (int j = 0; j < nx; ++j) q[i] += stage.ahead[i * nz + j] * d[j];
        }
        for (int c = 0; c < na; ++c) {
            h[c] = g[c];
            for (int j = 0; j < nx; ++j) h[c] += F[j * na + c] * q[j];
            if (assembly.coupled(k))
                for (int j = 0; j < nx; ++j) h[c] += stage.mixed[j * na + c] * d[j];
        }
        h[nx] += q[nx];
        for (int i = 0; i < nu; ++i) stage.offset[i] = -h[nz + i];
        cholesky_solve<nu>(stage.inputs, nu, stage.offset);
        for (int c = 0; c < nz; ++c) {
            p[c] = h[c];
            for (int i = 0; i < nu; ++i) p[c] += stage.cross[i * nz + c] * stage.offset[i];
        }
    }

    void solve_root(const double* p, double* dv) {
        double step[nz];
        for (int i = 0; i < n_free_; ++i) step[i] = -p[free_[i]];
        cholesky_solve<nz>(root_, n_free_, step);
        for (int i = 0; i < nx; ++i) dv[i] = 0;
        dv[layout_.time] = 0;
        for (int i = 0; i < n_free_; ++i) dv[free_[i] < nx ? free_[i] : layout_.time] = step[i];
    }

    void step_forward(const Assembly<Model>& assembly, int k, const double* d, double* dv, double* lam) {
        const StageFactor& stage = factors_[k];
        const double *F = assembly.sensitivities.end.data() + k * nx * na, *x = dv + layout_.x(k);
        double a[na], *next = dv + layout_.x(k + 1);
        for (int i = 0; i < nx; ++i) a[i] = x[i];
        a[nx] = dv[layout_.time];
        for (int i = 0; i < nu; ++i) {
            double sum = stage.offset[i];
            for (int c = 0; c < nz; ++c) sum += stage.gain[i * nz + c] * a[c];
            a[nz + i] = dv[layout_.u(k) + i] = sum;
        }
        for (int i = 0; i < nx; ++i) {
            next[i] = d[i];
            for (int c = 0; c < na; ++c) next[i] += F[i * na + c] * a[c];
        }
        for (int i = 0; i < nx; ++i) {
            double sum = stage.value[i] + stage.ahead[i * nz + nx] * a[nx];
            for (int j = 0; j < nx; ++j) sum += stage.ahead[i * nz + j] * next[j];
            for (int c = 0; assembly.coupled(k) && c < na; ++c) sum += stage.mixed[i * na + c] * a[c];
            lam[i] = sum;
        }
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
        const int parts = problem_.parts.size();
        double w[nw];
        assembly.gather(dv, k, w);
        for (int i = layout_.pair[k * parts]; i < layout_.pair[(k + 1) * parts]; ++i) {
            const PairBlock<Model>& pair = assembly.pairs[i];
            double phi = assembly.line_force(gradient, i, 0), mu = assembly.line_force(gradient, i, 1);
            for (int c = 0; c < nw; ++c) phi += pair.phi[c] * w[c], mu += pair.mu[c] * w[c];
            const LineInverse<double>& inverse = pair_inverses_[i];
            dv[layout_.aux(i)] = -inverse.phi_phi * phi - inverse.phi_mu * mu;
            dv[layout_.aux(i) + 1] = -inverse.phi_mu * phi - inverse.mu_mu * mu;
        }
    }

    const Problem& problem_;
    const Layout& layout_;
    std::vector<StageFactor> factors_;
    std::vector<LineInverse<double>> pair_inverses_;  // of pairs in coupled intervals
    Vector gradient_;
    Vector inverses_;    // of groups of other lines, packs: phi phi, phi mu, mu mu
    Vector eliminated_;  // what these lines leave at the pose of x_{k+1}: xx, xy, yy, x theta, y theta, theta theta
    int free_[nz], n_free_ = 0;
    double root_[nz * nz];
};

}  // namespace tightspot::stagewise
