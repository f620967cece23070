// One interval's quadratic in w = (a, x_{k+1}), a = (x_k, t_f, u_k), in three blocks.
#pragma once

#include <type_traits>

#include "tightspot/stagewise/row_vector.hpp"
#include "tightspot/stagewise/sizes.hpp"

namespace tightspot::stagewise {

template <class Model>
struct StageQuadratic {
    using S = Sizes<Model>;
    double own[S::na * S::na];    // of a
    double mixed[S::nx * S::na];  // between x_{k+1} and a; 0 unless the interval is coupled
    double ahead[S::nx * S::na];  // of x_{k+1}, rows as long as the others', which end in zeros

    // -= p q' + r s', a symmetric matrix of length nw.
    void subtract_outer(const double* p, const double* q, const double* r, const double* s) {
        using Own = RowVector<S::na>;
        using Ahead = RowVector<S::nx>;
        const Own q_own = Own::read(q), s_own = Own::read(s);
        const Ahead q_ahead = Ahead::read(q + S::na), s_ahead = Ahead::read(s + S::na);
        const auto subtract = [&](int i, const auto& qs, const auto& ss, double* to) {
            auto row = std::decay_t<decltype(qs)>::read(to);
            row.add(-p[i], qs), row.add(-r[i], ss);
            row.write(to);
        };
        for (int i = 0; i < S::na; ++i) subtract(i, q_own, s_own, own + i * S::na);
        for (int i = 0; i < S::nx; ++i) {
            subtract(S::na + i, q_own, s_own, mixed + i * S::na);
            subtract(S::na + i, q_ahead, s_ahead, ahead + i * S::na);
        }
    }

    // -= factor p p'.
    void subtract_square(double factor, const double* p) {
        for (int i = 0; i < S::na; ++i)
            for (int j = 0; j < S::na; ++j) own[i * S::na + j] -= factor * p[i] * p[j];
        for (int i = 0; i < S::nx; ++i) {
            const double row = factor * p[S::na + i];
            for (int j = 0; j < S::na; ++j) mixed[i * S::na + j] -= row * p[j];
            for (int j = 0; j < S::nx; ++j) ahead[i * S::na + j] -= row * p[S::na + j];
        }
    }
};

// Of a soft pair: mixed derivatives of the penetration with phi and w. `weight` is the sum of D over the body's rows and
// minus the mixed derivative with mu, `obstacle` that over the obstacle's; `own` is D of the row sigma >= 0.
template <class Model>
struct PenetrationBlock {
    double phi, weight, own, obstacle;
    double w[Sizes<Model>::nw];
};

// A line's block of the Hessian: of (phi, mu) itself, and its rows of mixed derivatives with w.
template <class Model>
struct PairBlock {
    double phi_phi, phi_mu, mu_mu;
    double phi[Sizes<Model>::nw], mu[Sizes<Model>::nw];
};

}  // namespace tightspot::stagewise
