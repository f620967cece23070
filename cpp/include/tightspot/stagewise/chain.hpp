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

    // Add a driven sample's Hessian (xx, xy, yy, xt, yt, tt), 0 < sample < last, to the na x na quadratic of a.
    void add_block(int sample, const double* h, double* own) const {
        const double full[3][3] = {{h[0], h[1], h[3]}, {h[1], h[2], h[4]}, {h[3], h[4], h[5]}};
        const double* Q = poses + sample * 3 * S::inner;
        double half[3][S::na];
        for (int i = 0; i < 3; ++i) {
            half[i][0] = full[i][0], half[i][1] = full[i][1];
            for (int c = 0; c < S::inner; ++c)
                half[i][2 + c] =
                    full[i][0] * Q[c] + full[i][1] * Q[S::inner + c] + full[i][2] * Q[2 * S::inner + c];
        }
        for (int c = 0; c < S::na; ++c) own[c] += half[0][c], own[S::na + c] += half[1][c];
        for (int r = 0; r < S::inner; ++r)
            for (int c = 0; c < S::na; ++c)
                own[(2 + r) * S::na + c] += Q[r] * half[0][c] + Q[S::inner + r] * half[1][c] +
                                            Q[2 * S::inner + r] * half[2][c];
    }
};

// Add a pose's Hessian to the leading corner of a matrix with rows of the given length.
inline void add_pose_block(const double* h, double* to, int row) {
    to[0] += h[0], to[1] += h[1], to[2] += h[3];
    to[row] += h[1], to[row + 1] += h[2], to[row + 2] += h[4];
    to[2 * row] += h[3], to[2 * row + 1] += h[4], to[2 * row + 2] += h[5];
}

}  // namespace tightspot::stagewise
