// The motion on one interval: states after every Runge-Kutta step, their sensitivities, second derivatives by adjoints.
#pragma once

#include <array>
#include <cmath>

#include "tightspot/stagewise/problem.hpp"
#include "tightspot/stagewise/sine_cosine.hpp"
#include "tightspot/stagewise/sizes.hpp"

namespace tightspot::stagewise {

// One sample's pose with its sine and cosine.
struct SamplePose {
    double x, y, theta, cos, sin;
};

inline SamplePose pose_of(const double* state) {
    SamplePose pose{state[0], state[1], state[2], 1, 0};
    sine_cosine(pose.theta, pose.sin, pose.cos);
    return pose;
}

// What the value of the problem's functions at one point consists of.
template <class Model>
struct Values {
    Vector states;  // before each Runge-Kutta step, nx each
    Vector shared;  // sines and cosines of each step
    std::vector<SamplePose> poses;
    Vector normals;  // (cos phi, sin phi) of each pair's line
    Vector covers;   // by (interval, part)
    Vector defects;  // F_k - x_{k+1}
    Vector rows;
    double objective = 0;

    void allocate(const Problem& problem, const Layout& layout) {
        states.assign(layout.substep.back() * Model::states, 0);
        shared.assign(layout.substep.back() * Model::shared, 0);
        poses.assign(layout.sample.back(), {0, 0, 0, 1, 0});
        normals.assign(2 * problem.pairs.size(), 0);
        covers.assign(problem.steps * problem.parts.size(), 0);
        defects.assign(problem.steps * Model::states, 0);
        rows.assign(layout.rows, 0);
    }
};

// Integrate interval k of point v into the values: states, shared, poses, defect.
template <class Model>
void integrate(const Problem& problem, const Layout& layout, const double* v, int k, Values<Model>& out) {
    constexpr int nx = Model::states;
    const double h = v[layout.time] * problem.widths[k] / (problem.pieces[k] * problem.substeps[k]);
    const double *x = v + layout.x(k), *u = v + layout.u(k), *next = v + layout.x(k + 1);
    SamplePose* pose = out.poses.data() + layout.sample[k];
    double* state = out.states.data() + layout.substep[k] * nx;
    double* shared = out.shared.data() + layout.substep[k] * Model::shared;
    double* defect = out.defects.data() + k * nx;
    *pose++ = pose_of(x);
    for (int i = 0; i < nx; ++i) state[i] = x[i];
    const int count = problem.pieces[k] * problem.substeps[k];
    for (int step = 1; step <= count; ++step, state += nx, shared += Model::shared) {
        double* after = step < count ? state + nx : defect;
        Model::step(state, h, u, problem.parameters.data(), after, shared);
        if (step < count && step % problem.substeps[k] == 0) *pose++ = pose_of(after);
    }
    for (int i = 0; i < nx; ++i) defect[i] -= next[i];
    *pose = pose_of(next);
}

// First derivatives of the motion.
template <class Model>
struct Sensitivities {
    using S = Sizes<Model>;
    Vector jacobians;  // of each Runge-Kutta step with respect to (x[2], ..., h, u): nx x inner
    Vector before;     // of the state before each step with respect to (x_k[2], ..., t_f, u_k): nx x inner
    Vector end;        // of F_k with respect to a: nx x na
    Vector poses;      // of each sample pose with respect to inner: 3 x inner, the unit columns of x, y left out

    void allocate(const Problem& problem, const Layout& layout) {
        jacobians.assign(layout.substep.back() * S::nx * S::inner, 0);
        before.assign(layout.substep.back() * S::nx * S::inner, 0);
        end.assign(problem.steps * S::nx * S::na, 0);
        poses.assign(layout.sample.back() * 3 * S::inner, 0);
    }
};

template <class Model>
void differentiate(const Problem& problem, const Layout& layout, const double* v, int k, const Values<Model>& at,
                   Sensitivities<Model>& out) {
    using S = Sizes<Model>;
    constexpr int nx = S::nx, n = S::inner, own = nx - 2;  // own: columns of x[2], ...
    const int count = problem.pieces[k] * problem.substeps[k];
    const double rate = problem.widths[k] / count, h = v[layout.time] * rate;
    const double* u = v + layout.u(k);
    double now[nx * n] = {};
    for (int i = 0; i < own; ++i) now[(2 + i) * n + i] = 1;
    for (int step = 0; step < count; ++step) {
        const int at_step = layout.substep[k] + step;
        double* before = out.before.data() + at_step * nx * n;
        double* J = out.jacobians.data() + at_step * nx * n;
        for (int i = 0; i < nx * n; ++i) before[i] = now[i];
        Model::step_jacobian(at.states.data() + at_step * nx, h, u, problem.parameters.data(),
                             at.shared.data() + at_step * Model::shared, J);
        for (int i = 0; i < nx; ++i) {
            double* row = now + i * n;
            for (int c = 0; c < n; ++c) row[c] = i < 2 ? before[i * n + c] : 0;
            for (int j = 0; j < own; ++j)
                for (int c = 0; c < n; ++c) row[c] += J[i * n + j] * before[(2 + j) * n + c];
            row[own] += J[i * n + own] * rate;
            for (int c = own + 1; c < n; ++c) row[c] += J[i * n + c];
        }
        if ((step + 1) % problem.substeps[k] == 0) {
            double* Q = out.poses.data() + (layout.sample[k] + (step + 1) / problem.substeps[k]) * 3 * n;
            for (int i = 0; i < 3 * n; ++i) Q[i] = now[i];
        }
    }
    double* F = out.end.data() + k * nx * S::na;
    for (int i = 0; i < nx; ++i) {
        for (int c = 0; c < 2; ++c) F[i * S::na + c] = i == c;
        for (int c = 0; c < n; ++c) F[i * S::na + 2 + c] = now[i * n + c];
    }
}

// Add the second derivatives of lam . F_k + sum over inner samples of forces[sample] . pose, with respect to a, to the
// leading na x na block of W (rows of length nw).
template <class Model>
void add_curvature(const Problem& problem, const Layout& layout, const double* v, int k, const Values<Model>& at,
                   const Sensitivities<Model>& by, const double* lam, const std::array<double, 3>* forces, double* W) {
    using S = Sizes<Model>;
    constexpr int nx = S::nx, n = S::inner, own = nx - 2;
    const int count = problem.pieces[k] * problem.substeps[k];
    const double rate = problem.widths[k] / count, h = v[layout.time] * rate;
    const double* u = v + layout.u(k);
    double adjoint[nx], earlier[nx], H[n * n], half[n * n];
    for (int i = 0; i < nx; ++i) adjoint[i] = lam[i];
    for (int step = count - 1; step >= 0; --step) {
        const int at_step = layout.substep[k] + step;
        const double *S0 = by.before.data() + at_step * nx * n, *J = by.jacobians.data() + at_step * nx * n;
        Model::step_hessian(at.states.data() + at_step * nx, h, u, problem.parameters.data(),
                            at.shared.data() + at_step * Model::shared, adjoint, H);
        for (int i = 0; i < n; ++i) H[i * n + own] *= rate;
        for (int c = 0; c < n; ++c) H[own * n + c] *= rate;
        // half = H [S; I] with S the sensitivities of x[2], ...; then [S; I]' half
        for (int i = 0; i < n; ++i) {
            for (int c = 0; c < n; ++c) half[i * n + c] = c < own ? 0 : H[i * n + c];
            for (int j = 0; j < own; ++j)
                for (int c = 0; c < n; ++c) half[i * n + c] += H[i * n + j] * S0[(2 + j) * n + c];
        }
        for (int r = 0; r < n; ++r) {
            double* row = W + (2 + r) * S::nw + 2;
            if (r >= own)
                for (int c = 0; c < n; ++c) row[c] += half[r * n + c];
            for (int j = 0; j < own; ++j)
                for (int c = 0; c < n; ++c) row[c] += S0[(2 + j) * n + r] * half[j * n + c];
        }
        for (int j = 0; j < nx; ++j) earlier[j] = j < 2 ? adjoint[j] : 0;
        for (int i = 0; i < nx; ++i)
            for (int j = 0; j < own; ++j) earlier[2 + j] += J[i * n + j] * adjoint[i];
        for (int j = 0; j < nx; ++j) adjoint[j] = earlier[j];
        if (step > 0 && step % problem.substeps[k] == 0)
            for (int i = 0; i < 3; ++i) adjoint[i] += forces[step / problem.substeps[k]][i];
    }
}

}  // namespace tightspot::stagewise
