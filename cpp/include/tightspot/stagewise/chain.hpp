// From the poses, covers and lines that rows are written in to the stage's variables w = (x_k, t_f, u_k, x_{k+1}).
#pragma once

#include "tightspot/stagewise/motion.hpp"
#include "tightspot/stagewise/sizes.hpp"

namespace tightspot::stagewise {

// The transposed chain rule of one interval's sample poses: the first is x_k's, the last x_{k+1}'s, those between are
// driven from x_k by u_k during a part of t_f.
template <class Model>
struct Chain {
    using S = Sizes<Model>;
    const double* poses;  // 3 x inner of each sample
    int last;

    void add(int sample, const double* force, double* w) const {
        if (sample == 0 || sample == last) {
            double* end = w + (sample == 0 ? 0 : S::na);
            for (int i = 0; i < 3; ++i) end[i] += force[i];
            return;
        }
        const double* Q = poses + sample * 3 * S::inner;
        w[0] += force[0], w[1] += force[1];
        for (int c = 0; c < S::inner; ++c)
            w[2 + c] += force[0] * Q[c] + force[1] * Q[S::inner + c] + force[2] * Q[2 * S::inner + c];
    }

    // Step of a sample's pose from the step of w.
    void step(int sample, const double* w, double* pose) const {
        if (sample == 0 || sample == last) {
            const double* end = w + (sample == 0 ? 0 : S::na);
            for (int i = 0; i < 3; ++i) pose[i] = end[i];
            return;
        }
        const double* Q = poses + sample * 3 * S::inner;
        for (int i = 0; i < 3; ++i) {
            double sum = i < 2 ? w[i] : 0;
            for (int c = 0; c < S::inner; ++c) sum += Q[i * S::inner + c] * w[2 + c];
            pose[i] = sum;
        }
    }

    // Add a pose's Hessian (xx, xy, yy, xt, yt, tt) to W.
    void add_block(int sample, const double* h, double* W) const {
        const double full[3][3] = {{h[0], h[1], h[3]}, {h[1], h[2], h[4]}, {h[3], h[4], h[5]}};
        if (sample == 0 || sample == last) {
            double* corner = W + (sample == 0 ? 0 : S::na * (S::nw + 1));
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) corner[i * S::nw + j] += full[i][j];
            return;
        }
        const double* Q = poses + sample * 3 * S::inner;
        double half[3][S::na];
        for (int i = 0; i < 3; ++i) {
            half[i][0] = full[i][0], half[i][1] = full[i][1];
            for (int c = 0; c < S::inner; ++c)
                half[i][2 + c] =
                    full[i][0] * Q[c] + full[i][1] * Q[S::inner + c] + full[i][2] * Q[2 * S::inner + c];
        }
        for (int c = 0; c < S::na; ++c) W[c] += half[0][c], W[S::nw + c] += half[1][c];
        for (int r = 0; r < S::inner; ++r)
            for (int c = 0; c < S::na; ++c)
                W[(2 + r) * S::nw + c] += Q[r] * half[0][c] + Q[S::inner + r] * half[1][c] +
                                          Q[2 * S::inner + r] * half[2][c];
    }
};

// The cover is a function of ((x_k + x_{k+1}) / 2, h, u_k) with h = widths[k] t_f.
template <class Model>
void cover_gradient(const double* of_middle, double width, double* w) {
    using S = Sizes<Model>;
    for (int i = 0; i < S::nx; ++i) w[i] = w[S::na + i] = 0.5 * of_middle[i];
    w[S::nx] = width * of_middle[S::nx];
    for (int i = S::nz; i < S::na; ++i) w[i] = of_middle[i];
}

template <class Model>
void add_cover_hessian(double factor, const double* of_middle, double width, double* W) {
    using S = Sizes<Model>;
    const auto scale = [&](int i) { return i < S::nx ? 0.5 : i == S::nx ? width : 1.0; };
    for (int i = 0; i < S::na; ++i)
        for (int j = 0; j < S::na; ++j) {
            const double entry = factor * scale(i) * scale(j) * of_middle[i * S::na + j];
            W[i * S::nw + j] += entry;
            if (i < S::nx) W[(S::na + i) * S::nw + j] += entry;
            if (j < S::nx) W[i * S::nw + S::na + j] += entry;
            if (i < S::nx && j < S::nx) W[(S::na + i) * S::nw + S::na + j] += entry;
        }
}

}  // namespace tightspot::stagewise
