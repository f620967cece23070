// One interval's quadratic in w = (a, x_{k+1}), a = (x_k, t_f, u_k), in three blocks.
#pragma once

#include <vector>

#include "tightspot/stagewise/problem.hpp"
#include "tightspot/stagewise/sizes.hpp"

namespace tightspot::stagewise {

template <class Model>
struct StageQuadratic {
    using S = Sizes<Model>;
    double own[S::na * S::na];    // of a
    double mixed[S::nx * S::na];  // between x_{k+1} and a; 0 unless the interval is coupled
    double ahead[S::nx * S::nx];  // of x_{k+1}

    // += p q' with a symmetric sum in view: own and ahead full, mixed from p's part ahead and q's own.
    void add_outer(double factor, const double* p, const double* q) {
        for (int r = 0; r < S::na; ++r)
            for (int c = 0; c < S::na; ++c) own[r * S::na + c] += factor * p[r] * q[c];
        for (int r = 0; r < S::nx; ++r) {
            for (int c = 0; c < S::na; ++c) mixed[r * S::na + c] += factor * p[S::na + r] * q[c];
            for (int c = 0; c < S::nx; ++c) ahead[r * S::nx + c] += factor * p[S::na + r] * q[S::na + c];
        }
    }
};

// A line's block of the Hessian: of (phi, mu) itself, and its rows of mixed derivatives with w.
template <class Model>
struct PairBlock {
    double phi_phi, phi_mu, mu_mu;
    double phi[Sizes<Model>::nw], mu[Sizes<Model>::nw];
};

}  // namespace tightspot::stagewise
