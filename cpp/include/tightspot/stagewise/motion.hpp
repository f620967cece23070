// The motion on the intervals: states after every Runge-Kutta step, their sensitivities, second derivatives by adjoints.
// Intervals of a convoy are computed at once, one in each lane.
#pragma once

#include <vector>

#include "tightspot/stagewise/problem.hpp"
#include "tightspot/stagewise/sine_cosine.hpp"
#include "tightspot/stagewise/sizes.hpp"

namespace tightspot::stagewise {

using Packs = std::vector<Pack>;

// What the value of the problem's functions at one point consists of.
template <class Model>
struct Values {
    static constexpr int pose = 4;  // x, y, cos theta, sin theta

    Packs states;     // before each Runge-Kutta step of each convoy, nx each
    Packs shared;     // sines and cosines of each step
    Vector poses;     // of each sample
    Vector geometry;  // of rows, see rows.hpp
    Vector covers;    // by (interval, part)
    Vector defects;   // F_k - x_{k+1}
    Vector rows;
    double objective = 0;

    void allocate(const Problem& problem, const Layout& layout) {
        states.assign(layout.convoy_steps * Model::states, 0);
        shared.assign(layout.convoy_steps * Model::shared, 0);
        poses.assign(pose * layout.sample.back(), 0);
        covers.assign(problem.steps * problem.parts.size(), 0);
        defects.assign(problem.steps * Model::states, 0);
        rows.assign(layout.rows, 0);
    }
};

// What the intervals of a convoy are driven with; lanes without an interval repeat the last one.
template <class Model>
struct Drive {
    static constexpr int nx = Model::states, nu = Model::inputs;
    Pack u[nu], rate, h;  // rate: duration of a Runge-Kutta step for each second of t_f

    Drive(const Problem& problem, const Layout& layout, const double* v, const Convoy& convoy) {
        read<nu>(v + layout.u(convoy.first), convoy, u);
        read<1>(problem.widths.data() + convoy.first, convoy, &rate);
        rate = rate / static_cast<double>(convoy.steps());
        h = v[layout.time] * rate;
    }

    // n numbers of each interval, one interval after another.
    template <int n>
    static void read(const double* from, const Convoy& convoy, Pack* to) {
        for (int l = 0; l < lanes; ++l) {
            const double* of_lane = from + n * (l < convoy.count ? l : convoy.count - 1);
            for (int i = 0; i < n; ++i) {
                if (l == 0) to[i] = of_lane[i];
                to[i].set(l, of_lane[i]);
            }
        }
    }
};

// Sets the poses of one sample of every interval.
template <class Model>
void set_poses(const Layout& layout, const Convoy& convoy, int sample, const Pack* state, Values<Model>& out) {
    Pack sine, cosine;
    sine_cosine(state[2], sine, cosine);
    for (int l = 0; l < convoy.count; ++l) {
        double* pose = out.poses.data() + out.pose * (layout.sample[convoy.first + l] + sample);
        pose[0] = state[0][l], pose[1] = state[1][l], pose[2] = cosine[l], pose[3] = sine[l];
    }
}

// Integrate a convoy's intervals from point v into the values: states, shared, poses, defects.
template <class Model>
void integrate(const Problem& problem, const Layout& layout, const double* v, const Convoy& convoy, Values<Model>& out) {
    constexpr int nx = Model::states;
    const Drive<Model> drive(problem, layout, v, convoy);
    Pack* state = out.states.data() + convoy.step * nx;
    Pack* shared = out.shared.data() + convoy.step * Model::shared;
    Pack next[nx], end[nx];
    drive.template read<nx>(v + layout.x(convoy.first), convoy, state);
    set_poses(layout, convoy, 0, state, out);
    const int count = convoy.steps();
    for (int step = 1; step <= count; ++step, state += nx, shared += Model::shared) {
        Pack* after = step < count ? state + nx : end;
        Model::step(state, drive.h, drive.u, problem.parameters.data(), after, shared);
        if (step < count && step % convoy.substeps == 0)
            set_poses(layout, convoy, step / convoy.substeps, after, out);
    }
    drive.template read<nx>(v + layout.x(convoy.first + 1), convoy, next);
    set_poses(layout, convoy, convoy.pieces, next, out);
    for (int l = 0; l < convoy.count; ++l)
        for (int i = 0; i < nx; ++i) out.defects[(convoy.first + l) * nx + i] = end[i][l] - next[i][l];
}

// First derivatives of the motion.
template <class Model>
struct Sensitivities {
    using S = Sizes<Model>;
    Packs jacobians;  // of each Runge-Kutta step with respect to (x[2], ..., h, u): nx x inner
    Packs before;     // of the state before each step with respect to (x_k[2], ..., t_f, u_k): nx x inner
    Vector end;       // of F_k with respect to a: nx x na
    Vector poses;     // of each sample pose with respect to inner: 3 x inner, the unit columns of x, y left out

    void allocate(const Problem& problem, const Layout& layout) {
        jacobians.assign(layout.convoy_steps * S::nx * S::inner, 0);
        before.assign(layout.convoy_steps * S::nx * S::inner, 0);
        end.assign(problem.steps * S::nx * S::na, 0);
        poses.assign(layout.sample.back() * 3 * S::inner, 0);
        for (int k = 0; k < problem.steps; ++k)
            for (int i = 0; i < 2; ++i) end[k * S::nx * S::na + i * (S::na + 1)] = 1;
    }
};

template <class Model>
void differentiate(const Problem& problem, const Layout& layout, const double* v, const Convoy& convoy,
                   const Values<Model>& at, Sensitivities<Model>& out) {
    using S = Sizes<Model>;
    constexpr int nx = S::nx, n = S::inner, own = nx - 2;  // own: columns of x[2], ...
    const Drive<Model> drive(problem, layout, v, convoy);
    Pack now[nx * n];
    for (int step = 0; step < convoy.steps(); ++step) {
        const int at_step = convoy.step + step;
        Pack *J = out.jacobians.data() + at_step * nx * n, *before = out.before.data() + at_step * nx * n;
        Model::step_jacobian(at.states.data() + at_step * nx, drive.h, drive.u, problem.parameters.data(),
                             at.shared.data() + at_step * Model::shared, J);
        if (step == 0) {
            for (int i = 0; i < nx * n; ++i) now[i] = J[i];
            for (int i = 0; i < nx; ++i) now[i * n + own] *= drive.rate;
        } else {
            for (int i = 0; i < nx * n; ++i) before[i] = now[i];
            for (int i = 0; i < nx; ++i)
                for (int c = 0; c < n; ++c) {
                    Pack sum = i < 2 ? before[i * n + c] : Pack(0);
                    for (int j = 0; j < own; ++j) sum += J[i * n + j] * before[(2 + j) * n + c];
                    if (c == own) sum += J[i * n + c] * drive.rate;
                    if (c > own) sum += J[i * n + c];
                    now[i * n + c] = sum;
                }
        }
        if ((step + 1) % convoy.substeps != 0 || step + 1 == convoy.steps()) continue;
        for (int l = 0; l < convoy.count; ++l) {
            const int sample = layout.sample[convoy.first + l] + (step + 1) / convoy.substeps;
            for (int i = 0; i < 3 * n; ++i) out.poses[sample * 3 * n + i] = now[i][l];
        }
    }
    for (int l = 0; l < convoy.count; ++l) {
        double* F = out.end.data() + (convoy.first + l) * nx * S::na + 2;
        for (int i = 0; i < nx; ++i)
            for (int c = 0; c < n; ++c) F[i * S::na + c] = now[i * n + c][l];
    }
}

// H = [S; E]' H [S; E] with S the sensitivities of x[2], ... (rows of length n) and E the unit rows of t_f and u.
template <int own, int n>
void pull_back(const Pack* S, Pack* H) {
    Pack half[n * n];
    for (int i = 0; i < n; ++i)
        for (int c = 0; c < n; ++c) {
            Pack sum = c < own ? Pack(0) : H[i * n + c];
            for (int j = 0; j < own; ++j) sum += H[i * n + j] * S[j * n + c];
            half[i * n + c] = sum;
        }
    for (int r = 0; r < n; ++r)
        for (int c = r; c < n; ++c) {
            Pack sum = r < own ? Pack(0) : half[r * n + c];
            for (int j = 0; j < own; ++j) sum += S[j * n + r] * half[j * n + c];
            H[r * n + c] = H[c * n + r] = sum;
        }
}

// Second derivatives of lam . F_k + sum over inner samples of forces . pose with respect to inner, of every interval of
// the convoy: `out`, inner x inner. `lam` holds nx multipliers an interval, `forces` 3 a sample.
template <class Model>
void curvature(const Problem& problem, const Layout& layout, const double* v, const Convoy& convoy,
               const Values<Model>& at, const Sensitivities<Model>& by, const double* lam, const double* forces,
               Pack* out) {
    using S = Sizes<Model>;
    constexpr int nx = S::nx, n = S::inner, own = nx - 2;
    const Drive<Model> drive(problem, layout, v, convoy);
    Pack adjoint[nx], earlier[nx], H[n * n];
    drive.template read<nx>(lam + convoy.first * nx, convoy, adjoint);
    for (int i = 0; i < n * n; ++i) out[i] = 0;
    for (int step = convoy.steps() - 1; step >= 0; --step) {
        const int at_step = convoy.step + step;
        const Pack* J = by.jacobians.data() + at_step * nx * n;
        Model::step_hessian(at.states.data() + at_step * nx, drive.h, drive.u, problem.parameters.data(),
                            at.shared.data() + at_step * Model::shared, adjoint, H);
        for (int i = 0; i < n; ++i) H[i * n + own] *= drive.rate;
        for (int c = 0; c < n; ++c) H[own * n + c] *= drive.rate;
        if (step > 0) pull_back<own, n>(by.before.data() + (at_step * nx + 2) * n, H);
        for (int i = 0; i < n * n; ++i) out[i] += H[i];
        if (step == 0) break;
        for (int j = 0; j < nx; ++j) earlier[j] = j < 2 ? adjoint[j] : Pack(0);
        for (int i = 0; i < nx; ++i)
            for (int j = 0; j < own; ++j) earlier[2 + j] += J[i * n + j] * adjoint[i];
        for (int j = 0; j < nx; ++j) adjoint[j] = earlier[j];
        if (step % convoy.substeps != 0) continue;
        for (int l = 0; l < convoy.count; ++l) {
            const double* force = forces + 3 * (layout.sample[convoy.first + l] + step / convoy.substeps);
            for (int i = 0; i < 3; ++i) adjoint[i].set(l, adjoint[i][l] + force[i]);
        }
    }
}

}  // namespace tightspot::stagewise
