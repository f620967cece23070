// The Newton system's numbers before elimination: one quadratic in w = (x_k, t_f, u_k, x_{k+1}) an interval, one block a
// pair.
#pragma once

#include <algorithm>
#include <vector>

#include "tightspot/stagewise/chain.hpp"
#include "tightspot/stagewise/covers.hpp"
#include "tightspot/stagewise/end_lines.hpp"
#include "tightspot/stagewise/line_fit.hpp"
#include "tightspot/stagewise/views.hpp"

namespace tightspot::stagewise {

// A gradient with respect to all variables, kept by interval (nw each: x_k's part in interval k, x_N's in the last one)
// and by line (forces.lines).
struct Gradient {
    Vector stages;
    Forces forces;
};

template <class Model>
class Assembly {
    using S = Sizes<Model>;

   public:
    Assembly(const Problem& problem, const Layout& layout)
        : rows(RowGrouping(problem, layout).take()), stages(problem.steps), covers_(problem, layout),
          views_(rows, layout.sample.back(), problem.steps, problem.parts.size()), problem_(problem), layout_(layout),
          poses_(layout.sample.back() + rows.views.size()) {
        const std::size_t parts = problem.parts.size();
        curvature.poses.assign(6 * poses_, 0), curvature.pose_covers.assign(3 * poses_ * parts, 0);
        curvature.covers.assign(problem.steps * parts, 0), curvature.ends.assign(9 * problem.steps, 0);
        inverses_.assign(3 * rows.intervals.size(), 0), curvature.blocks.assign(rows.blocks, 0);
        steps_.poses.assign(3 * poses_, 0), steps_.covers.assign(problem.steps * parts, 0);
        if (!rows.single.empty()) pairs.resize(problem.pairs.size());
        penetrations.resize(layout.soft_pairs.size());
        sensitivities.allocate(problem, layout);
    }

    void allocate(Gradient& gradient) const {
        gradient.stages.assign(problem_.steps * S::nw, 0);
        gradient.forces.poses.assign(3 * poses_, 0);
        gradient.forces.times.assign(rows.views.empty() ? 0 : problem_.steps, 0);
        gradient.forces.covers.assign(problem_.steps * problem_.parts.size(), 0);
        gradient.forces.lines.assign(2 * rows.intervals.size(), 0);
        gradient.forces.penetrations.assign(layout_.soft_pairs.size(), 0);
    }
    void allocate(Values<Model>& values) const {
        values.allocate(problem_, layout_);
        values.poses.assign(values.pose * poses_, 0);
        values.geometry.assign(rows.geometry, 0);
    }

    // All values at a point.
    void evaluate(const double* v, Values<Model>& out) const {
        for (const Convoy& convoy : layout_.convoys) {
            integrate(problem_, layout_, v, convoy, out);
            if (has_cover(convoy)) covers_.evaluate(v, convoy, out.covers);
        }
        views_.evaluate(v[layout_.time], out.poses);
        over_rows([&](auto P, const RowGroup& group) { row_values<decltype(P)>(context(), group, v, out); });
        out.objective = objective(v);
    }

    // The rows of one group of pairs, when its lines have changed and the poses have not.
    void evaluate_lines(const RowGroup& group, const double* v, Values<Model>& out) const {
        if (group.width == lanes)
            row_values<Pack>(context(), group, v, out);
        else
            row_values<double>(context(), group, v, out);
    }

    // The points that the line in lane l of a group of pairs separates at the poses of `at`, relative to its origin.
    void read_points(const RowGroup& group, int l, const Values<Model>& at, LineFit& out) const {
        const double* numbers = rows.numbers.data() + group.number + l;
        const auto number = [&](int i) { return numbers[i * group.width]; };
        const int parts = problem_.parts.size();
        const double cover = group.covered ? at.covers[rows.intervals[group.line + l] * parts + group.part] : 0.0;
        out.clear();
        for (int j = 0; j < group.corners; ++j)
            out.add_obstacle(number(4 + 2 * j), number(5 + 2 * j), number(2) + number(3) * cover);
        for (int s = 0; s < group.samples; ++s) {
            const double* pose = at.poses.data() + at.pose * rows.samples[group.sample + s * group.width + l];
            const double x = pose[0] - number(0), y = pose[1] - number(1), cosine = pose[2], sine = pose[3];
            const int constant = 4 + 2 * (group.corners + s);
            const double demand = number(constant) + number(constant + 1) * cover;
            for (int i = problem_.parts.first[group.part]; i < problem_.parts.first[group.part + 1]; ++i) {
                const double right = problem_.parts.x[i], left = problem_.parts.y[i];
                out.add_body(x + cosine * right - sine * left, y + sine * right + cosine * left, demand);
            }
        }
    }

    // First derivatives of motion and covers.
    void differentiate_all(const double* v, const Values<Model>& at) {
        for (std::size_t i = 0; i < layout_.convoys.size(); ++i) {
            differentiate(problem_, layout_, v, layout_.convoys[i], at, sensitivities);
            if (has_cover(layout_.convoys[i])) covers_.differentiate(v, static_cast<int>(i));
        }
        views_.differentiate(v[layout_.time], at.poses);
    }

    // The Hessian of the Lagrangian plus J' D J; `lam` of the dynamics, `diagonal` of the bounds. On the way, the gradient
    // of objective - z . rows, plus `bounds`. The lines of end_lines.hpp are eliminated unless `whole` is asked for.
    void set_hessian(const double* v, const Values<Model>& at, const double* D, const double* z, const double* lam,
                     const double* diagonal, const double* bounds, bool whole, Gradient& out) {
        out.forces.clear(), curvature.clear();
        over_rows([&](auto P, const RowGroup& group) {
            row_curvature<decltype(P)>(context(), group, at, D, z, out.forces, curvature);
            if (group.ends && !whole)
                eliminate_ends<decltype(P)>(rows, group, parts(), inverses_.data(), curvature);
        });
        views_.pull(out.forces), views_.pull(out.forces, curvature);
        constexpr int n = S::inner;
        Pack H[n * n];
        for (std::size_t i = 0; i < layout_.convoys.size(); ++i) {
            const Convoy& convoy = layout_.convoys[i];
            stagewise::curvature(problem_, layout_, v, convoy, at, sensitivities, lam, out.forces.poses.data(), H);
            for (int l = 0; l < convoy.count; ++l) {
                StageQuadratic<Model>& stage = stages[convoy.first + l];
                begin(convoy.first + l, stage);
                for (int r = 0; r < n; ++r)
                    for (int c = 0; c < n; ++c) stage.own[(2 + r) * S::na + 2 + c] += H[r * n + c][l];
                complete(v, static_cast<int>(i), l, out.forces, diagonal);
            }
        }
        for (int k = 0; k < problem_.steps; ++k) collect_gradient(v, k, bounds, out);
        chain_pairs();
    }

    // The objective's gradient - J' b + bounds, after the lines of end_lines.hpp by the last Hessian.
    void set_gradient(const double* v, const Values<Model>& at, const double* b, const double* bounds,
                      Gradient& out) const {
        out.forces.clear();
        over_rows([&](auto P, const RowGroup& group) {
            row_forces<decltype(P)>(context(), group, at, b, out.forces);
            if (group.ends) reduce_ends<decltype(P)>(rows, group, parts(), inverses_.data(), curvature, out.forces);
        });
        views_.pull(out.forces);
        for (int k = 0; k < problem_.steps; ++k) collect_gradient(v, k, bounds, out);
    }

    // Steps of the rows from the step dv of the variables; in dv sets that of the lines of end_lines.hpp, for the gradient
    // that it was found for.
    void row_steps(const Values<Model>& at, const Gradient& gradient, double* dv, double* out) {
        double w[S::nw];
        for (int k = 0; k < problem_.steps; ++k) {
            double* poses = steps_.poses.data() + 3 * layout_.sample[k];
            const int last = layout_.sample[k + 1] - layout_.sample[k] - 1;
            for (int i = 0; i < 3; ++i) poses[3 * last + i] = dv[layout_.x(k + 1) + i];
            if (!coupled(k)) continue;
            gather(dv, k, w);
            for (int p = 0; p < last; ++p) chain(k).step(p, w, poses + 3 * p);
            for (int part = 0; has_cover(k) && part < parts(); ++part) {
                const double* of_cover = covers_.gradients.data() + (k * parts() + part) * S::nw;
                double sum = 0;
                for (int i = covers_.pose; i < S::nw; ++i) sum += of_cover[i] * w[i];
                steps_.covers[k * parts() + part] = sum;
            }
        }
        views_.push(dv[layout_.time], steps_.poses);
        over_rows([&](auto P, const RowGroup& group) {
            if (group.ends)
                step_ends<decltype(P)>(rows, group, parts(), inverses_.data(), curvature, gradient.forces.lines, steps_,
                                       dv + layout_.line);
            stagewise::row_steps<decltype(P)>(context(), group, at, steps_.poses.data(), steps_.covers.data(),
                                              dv + layout_.line, dv + layout_.sigma, out);
        });
    }

    // The clearance demanded in each row.
    void row_demands(const Values<Model>& at, double* out) const {
        over_rows([&](auto P, const RowGroup& group) {
            stagewise::row_demands<decltype(P)>(context(), group, at, out);
        });
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
        double penalties = 0;
        for (std::size_t j = 0; j < layout_.soft_pairs.size(); ++j) penalties += penalty(j).at(time) * v[layout_.sigma + j];
        return problem_.time_weight * time + (problem_.time_scaled ? time : 1.0) * energy + penalties;
    }

    // What a metre of penetration j costs.
    const Penalty& penalty(std::size_t j) const { return problem_.pairs[layout_.soft_pairs[j]].penalty; }

    // True if rows of interval k depend on more than x_{k+1}.
    bool coupled(int k) const { return rows.coupled[k] != 0; }
    bool has_cover(int k) const { return rows.covered[k] != 0; }

    // For tests: a pair's block, wherever it is kept; for uncoupled intervals, too.
    PairBlock<Model> pair_block(int pair) const {
        const RowGroup& group = rows.pairs[rows.group[pair]];
        if (group.ends) return chained(group, rows.lane[pair]);
        if (group.coupled) return pairs[pair];
        PairBlock<Model> block{};
        const double* at = curvature.blocks.data() + group.block + rows.lane[pair];
        block.phi_phi = at[0], block.phi_mu = at[group.width], block.mu_mu = at[2 * group.width];
        for (int i = 0; i < 3; ++i) {
            block.phi[S::na + i] = at[(5 + i) * group.width];
            block.mu[S::na + i] = at[(8 + i) * group.width];
        }
        return block;
    }
    // A gradient's part along the line of a pair: phi (0) or mu (1).
    double line_force(const Gradient& gradient, int pair, int which) const {
        const RowGroup& group = rows.pairs[rows.group[pair]];
        return gradient.forces.lines[2 * group.line + which * group.width + rows.lane[pair]];
    }

    const RowGroups rows;
    std::vector<StageQuadratic<Model>> stages;
    RowCurvature curvature;
    std::vector<PairBlock<Model>> pairs;  // of those in rows.single
    std::vector<PenetrationBlock<Model>> penetrations;
    Sensitivities<Model> sensitivities;

   private:
    RowContext<Model> context() const { return {problem_, layout_, rows}; }

    int parts() const { return problem_.parts.size(); }

    template <class Body>
    void over_rows(Body&& body) const {
        over_groups(rows.walls, body), over_groups(rows.pairs, body);
    }

    bool has_cover(const Convoy& convoy) const {
        for (int l = 0; l < convoy.count; ++l)
            if (has_cover(convoy.first + l)) return true;
        return false;
    }

    Chain<Model> chain(int k) const {
        return {sensitivities.poses.data() + layout_.sample[k] * 3 * S::inner,
                layout_.sample[k + 1] - layout_.sample[k] - 1};
    }

    // Sets an interval's quadratic to what is of first order in covers: whole rows, which come before single numbers, as a
    // processor waits when it reads at once what was written apart.
    void begin(int k, StageQuadratic<Model>& stage) const {
        clear(stage.own), clear(stage.ahead);
        if (!coupled(k)) return;
        clear(stage.mixed);
        for (int part = 0; has_cover(k) && part < parts(); ++part) {
            double row[S::nw] = {};
            for (int p = layout_.sample[k]; p < layout_.sample[k + 1]; ++p)
                chain(k).add(p - layout_.sample[k], curvature.pose_covers.data() + 3 * (p * parts() + part), row);
            if (views_.any(k)) row[S::nx] += views_.curvature.cover_times[k * parts() + part];
            covers_.add_outer(k, part, curvature.covers[k * parts() + part], row, stage);
        }
    }

    // Adds to lane l of a convoy all else that is not the lines'.
    void complete(const double* v, int index, int l, const Forces& forces, const double* diagonal) {
        const int k = layout_.convoys[index].first + l;
        const int first = layout_.sample[k], last = layout_.sample[k + 1] - 1;
        StageQuadratic<Model>& stage = stages[k];
        add_pose_block(curvature.poses.data() + 6 * last, stage.ahead, S::na);
        add_objective(v, k, stage.own);
        add_diagonal(k, diagonal, stage);
        if (!coupled(k)) return;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) stage.mixed[i * S::na + j] += curvature.ends[9 * k + 3 * i + j];
        add_pose_block(curvature.poses.data() + 6 * first, stage.own, S::na);
        for (int p = first + 1; p < last; ++p)
            chain(k).add_block(p - first, curvature.poses.data() + 6 * p, stage.own);
        if (views_.any(k)) add_time_curvature(k, stage);
        if (has_cover(k)) covers_.add_curvature(index, l, forces.covers.data() + k * parts(), stage);
    }

    // What moving obstacles add along t_f, to the quadratic of interval k.
    void add_time_curvature(int k, StageQuadratic<Model>& stage) const {
        double row[S::nw] = {};
        for (int p = layout_.sample[k]; p < layout_.sample[k + 1]; ++p)
            chain(k).add(p - layout_.sample[k], views_.curvature.pose_times.data() + 3 * p, row);
        for (int i = 0; i < S::na; ++i) stage.own[i * S::na + S::nx] += row[i], stage.own[S::nx * S::na + i] += row[i];
        for (int i = 0; i < S::nx; ++i) stage.mixed[i * S::na + S::nx] += row[S::na + i];
        stage.own[S::nx * (S::na + 1)] += views_.curvature.times[k];
    }

    // Adds to a line's row of w its mixed derivatives with the pose at a place of interval k (see RowGroups::samples).
    void chain_line(int k, int place, const double* mixed, double* row) const {
        const View* view = views_.view(place);
        if (!view) return chain(k).add(place - layout_.sample[k], mixed, row);
        double pose[3] = {};
        row[S::nx] += views_.derivatives(place).pull(mixed, pose);
        chain(k).add(view->sample - layout_.sample[k], pose, row);
    }

    // Blocks of pairs in coupled intervals, from poses and covers to w.
    void chain_pairs() {
        for (const RowGroup& group : rows.pairs) {
            if (!group.coupled || group.ends) continue;
            for (int l = 0; l < group.width; ++l) {
                pairs[rows.line_pairs[group.line + l]] = chained(group, l);
                if (group.soft) chain_penetration(group, l);
            }
        }
    }

    // The block of the pair in lane l of a group.
    PairBlock<Model> chained(const RowGroup& group, int l) const {
        const double* at = curvature.blocks.data() + group.block + l;
        const auto entry = [&](int i) { return at[i * group.width]; };
        const int k = rows.intervals[group.line + l];
        const double* cover = covers_.gradients.data() + (k * parts() + group.part) * S::nw;
        PairBlock<Model> pair;
        pair.phi_phi = entry(0), pair.phi_mu = entry(1), pair.mu_mu = entry(2);
        const double phi_cover = entry(3), mu_cover = entry(4);
        for (int i = 0; i < S::nw; ++i) pair.phi[i] = phi_cover * cover[i], pair.mu[i] = mu_cover * cover[i];
        for (int s = 0; s < group.samples; ++s) {
            const int place = rows.samples[group.sample + s * group.width + l], i = 5 + 6 * s;
            const double phi[3] = {entry(i), entry(i + 1), entry(i + 2)};
            const double mu[3] = {entry(i + 3), entry(i + 4), entry(i + 5)};
            chain_line(k, place, phi, pair.phi), chain_line(k, place, mu, pair.mu);
        }
        return pair;
    }

    void chain_penetration(const RowGroup& group, int l) {
        const double* at = curvature.blocks.data() + group.block + l;
        const auto entry = [&](int i) { return at[i * group.width]; };
        const int j = rows.penetrations[group.line + l], k = rows.intervals[group.line + l], own = 5 + 6 * group.samples;
        const double* cover = covers_.gradients.data() + (k * parts() + group.part) * S::nw;
        PenetrationBlock<Model>& block = penetrations[j];
        block.phi = entry(own), block.weight = entry(own + 1), block.own = entry(own + 2), block.obstacle = entry(own + 3);
        const double of_cover = entry(own + 4);
        for (int i = 0; i < S::nw; ++i) block.w[i] = of_cover * cover[i];
        for (int s = 0; s < group.samples; ++s) {
            const int i = 8 + 6 * s;
            const double pose[3] = {-entry(i), -entry(i + 1), -entry(i + 2)};
            chain_line(k, rows.samples[group.sample + s * group.width + l], pose, block.w);
        }
        block.w[S::nx] += penalty(j).timed;
    }

    // From forces on poses and covers to the gradient with respect to w.
    void collect_gradient(const double* v, int k, const double* bounds, Gradient& out) const {
        double* g = out.stages.data() + k * S::nw;
        const int parts = problem_.parts.size(), first = layout_.sample[k], last = layout_.sample[k + 1] - 1;
        for (int i = 0; i < S::nx; ++i) g[i] = bounds[layout_.x(k) + i], g[S::na + i] = 0;
        for (int i = 0; i < 3; ++i) g[S::na + i] = out.forces.poses[3 * last + i];
        g[S::nx] = k == 0 ? bounds[layout_.time] : 0;
        for (int i = 0; i < S::nu; ++i) g[S::nz + i] = bounds[layout_.u(k) + i];
        if (k + 1 == problem_.steps)
            for (int i = 0; i < S::nx; ++i) g[S::na + i] += bounds[layout_.x(k + 1) + i];
        add_objective_gradient(v, k, g);
        for (int j = layout_.penetration[k]; j < layout_.penetration[k + 1]; ++j) {
            g[S::nx] += penalty(j).timed * v[layout_.sigma + j];
            out.forces.penetrations[j] += penalty(j).at(v[layout_.time]);
        }
        if (!coupled(k)) return;
        for (int p = first; p < last; ++p) chain(k).add(p - first, out.forces.poses.data() + 3 * p, g);
        if (views_.any(k)) g[S::nx] += out.forces.times[k];
        for (int part = 0; has_cover(k) && part < parts; ++part) {
            const double* gradient = covers_.gradients.data() + (k * parts + part) * S::nw;
            for (int i = covers_.pose; i < S::nw; ++i) g[i] += out.forces.covers[k * parts + part] * gradient[i];
        }
    }

    void add_objective(const double* v, int k, double* own) const {
        const double scale = problem_.time_scaled ? v[layout_.time] : 1.0;
        for (int i = 0; i < S::nu; ++i) {
            const double weight = 2 * problem_.widths[k] * problem_.input_weights[i];
            const int at = S::nz + i;
            own[at * (S::na + 1)] += scale * weight;
            if (!problem_.time_scaled) continue;
            const double mixed = weight * v[layout_.u(k) + i];
            own[at * S::na + S::nx] += mixed, own[S::nx * S::na + at] += mixed;
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

    void add_diagonal(int k, const double* diagonal, StageQuadratic<Model>& stage) const {
        for (int i = 0; i < S::nx; ++i) stage.own[i * (S::na + 1)] += diagonal[layout_.x(k) + i];
        for (int i = 0; i < S::nu; ++i) stage.own[(S::nz + i) * (S::na + 1)] += diagonal[layout_.u(k) + i];
        if (k == 0) stage.own[S::nx * (S::na + 1)] += diagonal[layout_.time];
        if (k + 1 == problem_.steps)
            for (int i = 0; i < S::nx; ++i) stage.ahead[i * (S::na + 1)] += diagonal[layout_.x(k + 1) + i];
    }

    Covers<Model> covers_;
    Views views_;
    const Problem& problem_;
    const Layout& layout_;
    const std::size_t poses_;  // samples and views
    Forces steps_;     // of poses and covers
    Vector inverses_;  // of the groups of lines eliminated here, packs: phi phi, phi mu, mu mu
};

}  // namespace tightspot::stagewise
