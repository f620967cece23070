// The Newton system's numbers before elimination: one quadratic in w = (x_k, t_f, u_k, x_{k+1}) an interval, one block a
// pair.
#pragma once

#include <vector>

#include "tightspot/stagewise/row_quadratic.hpp"

namespace tightspot::stagewise {

// A gradient with respect to all variables, kept by interval (nw each: x_k's part in interval k, x_N's in the last one)
// and by line.
struct Gradient {
    Vector stages, lines;
};

template <class Model>
class Assembly {
    using S = Sizes<Model>;

   public:
    Assembly(const Problem& problem, const Layout& layout) : problem_(problem), layout_(layout) {
        int most = 2;
        for (int pieces : problem.pieces) most = pieces + 1 > most ? pieces + 1 : most;
        forces_.resize(most), blocks_.resize(most);
        cover_forces_.assign(problem.parts.size(), 0);
        stages.assign(problem.steps * S::nw * S::nw, 0);
        cover_gradients.assign(problem.steps * problem.parts.size() * S::nw, 0);
        pairs.resize(problem.pairs.size());
        sensitivities.allocate(problem, layout);
        find_structure();
    }

    void allocate(Gradient& gradient) const {
        gradient.stages.assign(problem_.steps * S::nw, 0);
        gradient.lines.assign(2 * problem_.pairs.size(), 0);
    }

    // All values at a point.
    void evaluate(const double* v, Values<Model>& out) const {
        for (std::size_t i = 0; i < problem_.pairs.size(); ++i) {
            sine_cosine(v[layout_.aux(static_cast<int>(i))], out.normals[2 * i + 1], out.normals[2 * i]);
        }
        const int parts = problem_.parts.size();
        for (int k = 0; k < problem_.steps; ++k) {
            integrate(problem_, layout_, v, k, out);
            double* covers = out.covers.data() + k * parts;
            if (has_cover(k)) evaluate_covers(v, k, covers);
            RowValues visitor{covers, out.rows.data()};
            visit_rows(problem_, layout_, v, out, k, visitor);
        }
        out.objective = objective(v);
    }

    // First derivatives of motion and covers.
    void differentiate_all(const double* v, const Values<Model>& at) {
        const int parts = problem_.parts.size();
        double of_middle[S::na], hessian[S::na * S::na], middle[S::nx];
        for (int k = 0; k < problem_.steps; ++k) {
            differentiate(problem_, layout_, v, k, at, sensitivities);
            if (!has_cover(k)) continue;
            mid_state(v, k, middle);
            for (int part = 0; part < parts; ++part) {
                Model::cover_derivatives(middle, v[layout_.time] * problem_.widths[k], v + layout_.u(k),
                                         problem_.parameters.data(), problem_.radii[part], problem_.pieces[k],
                                         of_middle, hessian);
                cover_gradient<Model>(of_middle, problem_.widths[k],
                                      cover_gradients.data() + (k * parts + part) * S::nw);
            }
        }
    }

    // The Hessian of the Lagrangian plus J' D J; `lam` of the dynamics, `diagonal` of the bounds. On the way, the gradient
    // of objective - z . rows, plus `bounds`: the same as set_gradient(v, at, z, bounds, out).
    void set_hessian(const double* v, const Values<Model>& at, const double* D, const double* z, const double* lam,
                     const double* diagonal, const double* bounds, Gradient& out) {
        const int parts = problem_.parts.size();
        for (int k = 0; k < problem_.steps; ++k) {
            double* W = stages.data() + k * S::nw * S::nw;
            for (int i = 0; i < S::nw * S::nw; ++i) W[i] = 0;
            clear_scratch(k);
            RowHessian<Model> rows{D, z, chain(k), cover_gradients.data() + k * parts * S::nw, blocks_.data(),
                                   forces_.data(), cover_forces_.data(), out.lines.data(), W, pairs.data()};
            visit_rows(problem_, layout_, v, at, k, rows);
            const int samples = layout_.sample[k + 1] - layout_.sample[k];
            for (int p = 0; p < samples; ++p) chain(k).add_block(p, blocks_[p].data(), W);
            add_curvature(problem_, layout_, v, k, at, sensitivities, lam + k * S::nx, forces_.data(), W);
            if (has_cover(k)) add_cover_curvature(v, k, W);
            add_objective(v, k, W);
            add_diagonal(k, diagonal, W);
            collect_gradient(v, k, bounds, out.stages.data() + k * S::nw);
        }
    }

    // The objective's gradient - J' b + bounds.
    void set_gradient(const double* v, const Values<Model>& at, const double* b, const double* bounds, Gradient& out) {
        for (int k = 0; k < problem_.steps; ++k) {
            clear_scratch(k);
            RowForces rows{b, forces_.data(), cover_forces_.data(), out.lines.data()};
            visit_rows(problem_, layout_, v, at, k, rows);
            collect_gradient(v, k, bounds, out.stages.data() + k * S::nw);
        }
    }

    // Steps of the rows from the step of the variables.
    void row_steps(const double* v, const Values<Model>& at, const double* dv, double* out) {
        const int parts = problem_.parts.size();
        double w[S::nw];
        for (int k = 0; k < problem_.steps; ++k) {
            gather(dv, k, w);
            const int samples = layout_.sample[k + 1] - layout_.sample[k];
            for (int p = 0; p < samples; ++p) chain(k).step(p, w, forces_[p].data());
            for (int part = 0; part < parts; ++part) {
                const double* gradient = cover_gradients.data() + (k * parts + part) * S::nw;
                double sum = 0;
                for (int i = 0; i < S::nw; ++i) sum += gradient[i] * w[i];
                cover_forces_[part] = sum;
            }
            RowSteps rows{forces_.data(), cover_forces_.data(), dv + layout_.line, out};
            visit_rows(problem_, layout_, v, at, k, rows);
        }
    }

    // The part of v that belongs to w of interval k.
    void gather(const double* v, int k, double* w) const {
        for (int i = 0; i < S::nx; ++i) w[i] = v[layout_.x(k) + i], w[S::na + i] = v[layout_.x(k + 1) + i];
        w[S::nx] = v[layout_.time];
        for (int i = 0; i < S::nu; ++i) w[S::nz + i] = v[layout_.u(k) + i];
    }

    double objective(const double* v) const {
        double energy = 0;
        for (int k = 0; k < problem_.steps; ++k)
            for (int i = 0; i < S::nu; ++i) {
                const double u = v[layout_.u(k) + i];
                energy += problem_.widths[k] * problem_.input_weights[i] * u * u;
            }
        const double time = v[layout_.time];
        return problem_.time_weight * time + (problem_.time_scaled ? time : 1.0) * energy;
    }

    // True if rows of interval k depend on more than x_{k+1}.
    bool coupled(int k) const { return coupled_[k] != 0; }
    bool has_cover(int k) const { return covered_[k] != 0; }

    Vector stages;  // W of each interval, nw x nw
    std::vector<PairBlock<Model>> pairs;
    Vector cover_gradients;  // of each (interval, part), nw
    Sensitivities<Model> sensitivities;

   private:
    void find_structure() {
        coupled_.assign(problem_.steps, 0), covered_.assign(problem_.steps, 0);
        for (int k = 0; k < problem_.steps; ++k)
            for (int p = layout_.sample[k]; p < layout_.sample[k + 1]; ++p) {
                const Demand &pair = problem_.pair_demands[p], &wall = problem_.wall_demands[p];
                const bool last = p + 1 == layout_.sample[k + 1];
                if (!last && (pair.used || wall.used)) coupled_[k] = 1;
                if ((pair.used && pair.weight != 0) || (wall.used && wall.weight != 0)) covered_[k] = coupled_[k] = 1;
            }
        for (const Pair& pair : problem_.pairs)
            if (pair.obstacle_weight != 0) covered_[pair.interval] = coupled_[pair.interval] = 1;
    }

    Chain<Model> chain(int k) const {
        return {sensitivities.poses.data() + layout_.sample[k] * 3 * S::inner,
                layout_.sample[k + 1] - layout_.sample[k] - 1};
    }

    // From forces on poses and covers to the gradient with respect to w.
    void collect_gradient(const double* v, int k, const double* bounds, double* g) const {
        const int parts = problem_.parts.size(), samples = layout_.sample[k + 1] - layout_.sample[k];
        for (int i = 0; i < S::nw; ++i) g[i] = 0;
        for (int p = 0; p < samples; ++p) chain(k).add(p, forces_[p].data(), g);
        if (has_cover(k))
            for (int part = 0; part < parts; ++part) {
                const double* gradient = cover_gradients.data() + (k * parts + part) * S::nw;
                for (int i = 0; i < S::nw; ++i) g[i] += cover_forces_[part] * gradient[i];
            }
        add_objective_gradient(v, k, g);
        for (int i = 0; i < S::nx; ++i) g[i] += bounds[layout_.x(k) + i];
        for (int i = 0; i < S::nu; ++i) g[S::nz + i] += bounds[layout_.u(k) + i];
        if (k == 0) g[S::nx] += bounds[layout_.time];
        if (k + 1 == problem_.steps)
            for (int i = 0; i < S::nx; ++i) g[S::na + i] += bounds[layout_.x(k + 1) + i];
    }

    void clear_scratch(int k) {
        for (int p = 0; p < layout_.sample[k + 1] - layout_.sample[k]; ++p) forces_[p] = {}, blocks_[p] = {};
        for (double& force : cover_forces_) force = 0;
    }

    void mid_state(const double* v, int k, double* middle) const {
        for (int i = 0; i < S::nx; ++i) middle[i] = 0.5 * (v[layout_.x(k) + i] + v[layout_.x(k + 1) + i]);
    }

    void evaluate_covers(const double* v, int k, double* covers) const {
        double middle[S::nx];
        mid_state(v, k, middle);
        for (int part = 0; part < problem_.parts.size(); ++part)
            Model::cover(middle, v[layout_.time] * problem_.widths[k], v + layout_.u(k), problem_.parameters.data(),
                         problem_.radii[part], problem_.pieces[k], covers + part);
    }

    void add_cover_curvature(const double* v, int k, double* W) const {
        double of_middle[S::na], hessian[S::na * S::na], middle[S::nx];
        mid_state(v, k, middle);
        for (int part = 0; part < problem_.parts.size(); ++part) {
            if (cover_forces_[part] == 0) continue;
            Model::cover_derivatives(middle, v[layout_.time] * problem_.widths[k], v + layout_.u(k),
                                     problem_.parameters.data(), problem_.radii[part], problem_.pieces[k], of_middle,
                                     hessian);
            add_cover_hessian<Model>(cover_forces_[part], hessian, problem_.widths[k], W);
        }
    }

    void add_objective(const double* v, int k, double* W) const {
        const double scale = problem_.time_scaled ? v[layout_.time] : 1.0;
        for (int i = 0; i < S::nu; ++i) {
            const double weight = 2 * problem_.widths[k] * problem_.input_weights[i];
            const int at = S::nz + i;
            W[at * (S::nw + 1)] += scale * weight;
            if (!problem_.time_scaled) continue;
            const double mixed = weight * v[layout_.u(k) + i];
            W[at * S::nw + S::nx] += mixed, W[S::nx * S::nw + at] += mixed;
        }
    }

    void add_objective_gradient(const double* v, int k, double* g) const {
        const double time = problem_.time_scaled ? v[layout_.time] : 1.0;
        if (k == 0) g[S::nx] += problem_.time_weight;
        for (int i = 0; i < S::nu; ++i) {
            const double u = v[layout_.u(k) + i], weight = problem_.widths[k] * problem_.input_weights[i];
            g[S::nz + i] += 2 * time * weight * u;
            if (problem_.time_scaled) g[S::nx] += weight * u * u;
        }
    }

    void add_diagonal(int k, const double* diagonal, double* W) const {
        for (int i = 0; i < S::nx; ++i) W[i * (S::nw + 1)] += diagonal[layout_.x(k) + i];
        for (int i = 0; i < S::nu; ++i) W[(S::nz + i) * (S::nw + 1)] += diagonal[layout_.u(k) + i];
        if (k == 0) W[S::nx * (S::nw + 1)] += diagonal[layout_.time];
        if (k + 1 == problem_.steps)
            for (int i = 0; i < S::nx; ++i) W[(S::na + i) * (S::nw + 1)] += diagonal[layout_.x(k + 1) + i];
    }

    const Problem& problem_;
    const Layout& layout_;
    std::vector<Triple> forces_;
    std::vector<Sextuple> blocks_;
    Vector cover_forces_;
    std::vector<char> coupled_, covered_;
};

}  // namespace tightspot::stagewise
