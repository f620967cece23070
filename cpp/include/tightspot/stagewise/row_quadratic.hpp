// What the rows of one interval contribute to the Newton system: -J' b for row weights b, and J' D J - sum z c''.
#pragma once

#include <array>
#include <vector>

#include "tightspot/stagewise/chain.hpp"
#include "tightspot/stagewise/rows.hpp"

namespace tightspot::stagewise {

using Triple = std::array<double, 3>;
using Sextuple = std::array<double, 6>;  // xx, xy, yy, x theta, y theta, theta theta

// Forces -J' b of the rows on the sample poses, the covers and the lines.
struct RowForces {
    const double* b;
    Triple* poses;
    double* covers;
    double* lines;

    void body(const BodyRows& rows) {
        double b0 = 0, b1 = 0;
        for (int i = 0; i < rows.count; ++i) b0 += b[rows.row + i], b1 += b[rows.row + i] * rows.t(i);
        Triple& pose = poses[rows.sample];
        pose[0] -= rows.nx * b0, pose[1] -= rows.ny * b0, pose[2] += b1;
        covers[rows.part] += rows.weight * b0;
        if (rows.pair < 0) return;
        lines[2 * rows.pair] -= rows.across * b0 + b1;
        lines[2 * rows.pair + 1] += b0;
    }
    void obstacle(const ObstacleRows& rows) {
        double b0 = 0, b1 = 0;
        for (int j = 0; j < rows.count; ++j) b0 += b[rows.row + j], b1 += b[rows.row + j] * rows.t(j);
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
    double* W;
    PairBlock<Model>* pairs;
    double cover_cover = 0, phi_cover = 0, mu_cover = 0;
    double cover_row[S::nw] = {};  // mixed derivatives of the current part's cover with w, by way of the poses

    void body(const BodyRows& rows) {
        double s0 = 0, s1 = 0, s2 = 0, z0 = 0, z1 = 0, ze = 0;
        for (int i = 0; i < rows.count; ++i) {
            const double d = D[rows.row + i], zi = z[rows.row + i], t = rows.t(i);
            s0 += d, s1 += d * t, s2 += d * t * t;
            z0 += zi, z1 += zi * t, ze += zi * rows.e(i);
        }
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
        double s0 = 0, s1 = 0, s2 = 0, z0 = 0, ze = 0;
        for (int j = 0; j < rows.count; ++j) {
            const double d = D[rows.row + j], zj = z[rows.row + j], t = rows.t(j);
            s0 += d, s1 += d * t, s2 += d * t * t;
            z0 += zj, ze += zj * rows.e(j);
        }
        PairBlock<Model>& pair = pairs[rows.pair];
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
