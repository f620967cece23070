// What the rows of one interval contribute to the Newton system: -J' b for row weights b, and J' D J - sum z c''.
#pragma once

#include <array>
#include <vector>

#include "tightspot/stagewise/chain.hpp"
#include "tightspot/stagewise/rows.hpp"

namespace tightspot::stagewise {

using Triple = std::array<double, 3>;
using Sextuple = std::array<double, 6>;  // xx, xy, yy, x theta, y theta, theta theta

// Sums of b_i and of b_i t_i.
template <class Rows>
inline void sum(const Rows& rows, const double* b, double& b0, double& b1) {
    over(rows.count, [&](auto count) {
        for (int i = 0; i < count; ++i) b0 += b[i], b1 += b[i] * rows.t(i);
    });
}

// Sums of D_i, D_i t_i, D_i t_i^2, z_i, z_i t_i and z_i e_i.
struct Moments {
    double s0 = 0, s1 = 0, s2 = 0, z0 = 0, z1 = 0, ze = 0;

    template <class Rows>
    Moments(const Rows& rows, const double* D, const double* z) {
        over(rows.count, [&](auto count) {
            for (int i = 0; i < count; ++i) {
                const double t = rows.t(i), dt = D[i] * t;
                s0 += D[i], s1 += dt, s2 += dt * t;
                z0 += z[i], z1 += z[i] * t, ze += z[i] * rows.e(i);
            }
        });
    }
};

// Forces -J' b of the rows on the sample poses, the covers and the lines.
struct RowForces {
    const double* b;
    Triple* poses;
    double* covers;
    double* lines;

    void body(const BodyRows& rows) {
        double b0 = 0, b1 = 0;
        sum(rows, b + rows.row, b0, b1);
        Triple& pose = poses[rows.sample];
        pose[0] -= rows.nx * b0, pose[1] -= rows.ny * b0, pose[2] += b1;
        covers[rows.part] += rows.weight * b0;
        if (rows.pair < 0) return;
        lines[2 * rows.pair] -= rows.across * b0 + b1;
        lines[2 * rows.pair + 1] += b0;
    }
    void obstacle(const ObstacleRows& rows) {
        double b0 = 0, b1 = 0;
        sum(rows, b + rows.row, b0, b1);
        covers[rows.part] += rows.weight * b0;
        lines[2 * rows.pair] = b1;
        lines[2 * rows.pair + 1] = -b0;
    }
    void end_pair(int, int) {}
    void end_part(int) {}
};

// A pair's block of the Hessian: of (phi, mu) itself, and its rows of mixed derivatives with w.
template <class Model>
struct PairBlock {
    double phi_phi, phi_mu, mu_mu;
    double phi[Sizes<Model>::nw], mu[Sizes<Model>::nw];
};

template <class Model>
struct RowHessian {
    using S = Sizes<Model>;
    const double *D, *z;
    Chain<Model> chain;
    const double* cover_gradients;  // of the interval's parts, nw each
    Sextuple* blocks;               // of the sample poses
    Triple* forces;                 // -J' z on the sample poses
    double* cover_forces;           // -J' z on the covers
    double* lines;                  // -J' z on the lines
    double* W;
    PairBlock<Model>* pairs;
    double cover_cover = 0, phi_cover = 0, mu_cover = 0;
    double cover_row[S::nw] = {};  // mixed derivatives of the current part's cover with w, by way of the poses

    void body(const BodyRows& rows) {
        const auto [s0, s1, s2, z0, z1, ze] = Moments(rows, D + rows.row, z + rows.row);
        const double nx = rows.nx, ny = rows.ny, kappa = rows.weight;
        Sextuple& h = blocks[rows.sample];
        h[0] += s0 * nx * nx, h[1] += s0 * nx * ny, h[2] += s0 * ny * ny;
        h[3] -= s1 * nx, h[4] -= s1 * ny, h[5] += s2 + ze;
        Triple& force = forces[rows.sample];
        force[0] -= nx * z0, force[1] -= ny * z0, force[2] += z1;
        if (kappa != 0) {
            const double mixed[3] = {-kappa * s0 * nx, -kappa * s0 * ny, kappa * s1};
            chain.add(rows.sample, mixed, cover_row);
            cover_cover += kappa * kappa * s0;
            cover_forces[rows.part] += kappa * z0;
        }
        if (rows.pair < 0) return;
        PairBlock<Model>& pair = pairs[rows.pair];
        lines[2 * rows.pair] -= rows.across * z0 + z1;
        lines[2 * rows.pair + 1] += z0;
        const double a = rows.across, sa = s0 * a + s1;
        pair.phi_phi += s0 * a * a + 2 * a * s1 + s2 + z0 * rows.forward + ze;
        pair.phi_mu -= sa;
        pair.mu_mu += s0;
        const double phi[3] = {nx * sa + z0 * ny, ny * sa - z0 * nx, -(s1 * a + s2) - ze};
        const double mu[3] = {-s0 * nx, -s0 * ny, s1};
        chain.add(rows.sample, phi, pair.phi);
        chain.add(rows.sample, mu, pair.mu);
        phi_cover -= kappa * sa;
        mu_cover += kappa * s0;
    }

    void obstacle(const ObstacleRows& rows) {
        const Moments sums(rows, D + rows.row, z + rows.row);
        const double s0 = sums.s0, s1 = sums.s1, s2 = sums.s2, z0 = sums.z0, ze = sums.ze;
        PairBlock<Model>& pair = pairs[rows.pair];
        lines[2 * rows.pair] = sums.z1, lines[2 * rows.pair + 1] = -z0;
        pair.phi_phi = s2 - ze, pair.phi_mu = -s1, pair.mu_mu = s0;
        for (int i = 0; i < S::nw; ++i) pair.phi[i] = pair.mu[i] = 0;
        const double kappa = rows.weight;
        phi_cover = kappa * s1, mu_cover = -kappa * s0;
        cover_cover += kappa * kappa * s0;
        cover_forces[rows.part] += kappa * z0;
    }

    void end_pair(int part, int index) {
        if (phi_cover == 0 && mu_cover == 0) return;
        const double* gradient = cover_gradients + part * S::nw;
        PairBlock<Model>& pair = pairs[index];
        for (int i = 0; i < S::nw; ++i) pair.phi[i] += phi_cover * gradient[i], pair.mu[i] += mu_cover * gradient[i];
    }

    void end_part(int part) {
        if (cover_cover == 0) return;
        const double* gradient = cover_gradients + part * S::nw;
        for (int i = 0; i < S::nw; ++i) {
            const double own = cover_cover * gradient[i] + cover_row[i];
            for (int j = 0; j < S::nw; ++j) W[i * S::nw + j] += own * gradient[j] + gradient[i] * cover_row[j];
        }
        for (double& entry : cover_row) entry = 0;
        cover_cover = 0;
    }
};

}  // namespace tightspot::stagewise
