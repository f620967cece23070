// What the rows of a group contribute to the Newton system: -J' b for row weights b, and J' D J - sum z c''.
#pragma once

#include <vector>

#include "tightspot/stagewise/rows.hpp"

namespace tightspot::stagewise {

// Where it goes. A gradient with respect to poses, covers, lines and penetrations; lines hold packs (phi, mu) group by
// group.
struct Forces {
    Vector poses;   // 3 of each sample
    Vector covers;  // by (interval, part)
    Vector times;   // of t_f, by interval; empty where no obstacle moves
    Vector lines;
    Vector penetrations;

    void clear() {
        for (Vector* all : {&poses, &covers, &times}) std::fill(all->begin(), all->end(), 0.0);
    }
};

struct RowCurvature {
    Vector poses;         // of each sample: xx, xy, yy, x theta, y theta, theta theta
    Vector pose_covers;   // mixed derivatives of pose and cover, by (sample, part): 3
    Vector covers;        // by (interval, part)
    Vector ends;          // mixed derivatives of the pose of x_{k+1} and that of x_k, by interval: 3 x 3
    Vector blocks;        // of pairs, packs: phi phi, phi mu, mu mu, phi cover, mu cover, then of every sample phi and mu
                          // with x, y, theta; of a soft pair then: see SoftBlock

    void clear() {
        for (Vector* all : {&poses, &pose_covers, &covers, &ends}) std::fill(all->begin(), all->end(), 0.0);
    }
};

// Sums of b_i and of b_i t_i.
template <class P, class Side>
inline void sum(const Side& side, Reader<P>& b, P& b0, P& b1) {
    b0 = b1 = 0.0;
    over(side.count, [&](auto count) {
        for (int i = 0; i < count; ++i) {
            const P b_i = b.next();
            b0 += b_i, b1 += b_i * side.t(i);
        }
    });
}

// Sums of D_i, D_i t_i, D_i t_i^2, z_i, z_i t_i and z_i e_i.
template <class P>
struct Moments {
    P s0 = 0.0, s1 = 0.0, s2 = 0.0, z0 = 0.0, z1 = 0.0, ze = 0.0;

    template <class Side>
    Moments(const Side& side, Reader<P>& D, Reader<P>& z) {
        over(side.count, [&](auto count) {
            for (int i = 0; i < count; ++i) {
                const P t = side.t(i), D_i = D.next(), z_i = z.next(), Dt = D_i * t;
                s0 += D_i, s1 += Dt, s2 += Dt * t;
                z0 += z_i, z1 += z_i * t, ze += z_i * side.e(i);
            }
        });
    }
};

// Sets what pulls at the penetrations of a group.
template <class P, class Model>
void set_penetrations(const RowContext<Model>& context, const RowGroup& group, P force, Forces& out) {
    const int* places = context.penetrations(group);
    for (int l = 0; l < lane_count<P>; ++l) out.penetrations[places[l]] = lane(force, l);
}

// Adds the forces -J' b of a group; those of lines and penetrations are set.
template <class P, class Model>
void row_forces(const RowContext<Model>& context, const RowGroup& group, const Values<Model>& at, const double* b,
                Forces& out) {
    Reader<P> geometry{at.geometry.data() + group.geometry}, weights{b + group.row};
    const P nx = geometry.next(), ny = geometry.next();
    P b0, b1, phi = 0.0, mu = 0.0, body = 0.0, cover = 0.0;
    if (!group.wall()) {
        sum(ObstacleSide<P>{context.numbers(group) + 4 * lane_count<P>, group.corners, nx, ny}, weights, b0, b1);
        phi = b1, mu = -b0;
        if (group.covered) cover = context.template side_weight<P>(group) * b0;
    }
    for (int s = 0; s < group.samples; ++s) {
        const P cosine = geometry.next(), sine = geometry.next(), forward = geometry.next(), across = geometry.next();
        static_cast<void>(forward);
        sum(context.body(group, cosine, sine), weights, b0, b1);
        const P pose[3] = {-nx * b0, -ny * b0, b1};
        scatter_add(pose, out.poses.data(), context.samples(group, s), 3);
        phi -= across * b0 + b1, mu += b0, body += b0;
        if (group.covered) cover += context.template weight<P>(group, s) * b0;
    }
    if (group.soft) set_penetrations(context, group, P(-body - weights.next()), out);
    if (group.covered) {
        const P covers[1] = {cover};
        scatter_add(covers, out.covers.data() + group.part, context.intervals(group), context.problem.parts.size());
    }
    if (group.wall()) return;
    store(phi, out.lines.data() + 2 * group.line), store(mu, out.lines.data() + 2 * group.line + lane_count<P>);
}

// What a penetration adds to its pair's block. The body's rows have the derivatives 1 with respect to sigma and -1 with
// respect to mu, so sigma's mixed derivatives with the poses are the body's of mu with the other sign: the block's own.
template <class P>
struct SoftBlock {
    P phi = 0.0;       // mixed with phi
    P weight = 0.0;    // sum of the body's D: minus the mixed derivative with mu
    P own = 0.0;       // D of the row sigma >= 0
    P obstacle = 0.0;  // sum of the obstacle's D
    P cover = 0.0;     // mixed with the cover
};

// Adds a group's curvature, and its forces -J' z.
template <class P, class Model>
void row_curvature(const RowContext<Model>& context, const RowGroup& group, const Values<Model>& at, const double* D_,
                   const double* z_, Forces& forces, RowCurvature& out) {
    Reader<P> geometry{at.geometry.data() + group.geometry}, D{D_ + group.row}, z{z_ + group.row};
    const int parts = context.problem.parts.size();
    const P nx = geometry.next(), ny = geometry.next();
    P phi = 0.0, mu = 0.0, cover = 0.0, cover_cover = 0.0;
    P phi_phi = 0.0, phi_mu = 0.0, mu_mu = 0.0, phi_cover = 0.0, mu_cover = 0.0;
    SoftBlock<P> soft;
    P body = 0.0;
    if (!group.wall()) {
        const Moments<P> sums(ObstacleSide<P>{context.numbers(group) + 4 * lane_count<P>, group.corners, nx, ny}, D, z);
        const P kappa = context.template side_weight<P>(group);
        phi = sums.z1, mu = -sums.z0, cover = kappa * sums.z0, cover_cover = kappa * kappa * sums.s0;
        phi_phi = sums.s2 - sums.ze, phi_mu = -sums.s1, mu_mu = sums.s0;
        phi_cover = kappa * sums.s1, mu_cover = -kappa * sums.s0;
        soft.obstacle = sums.s0;
    }
    Writer<P> block{out.blocks.data() + group.block + 5 * lane_count<P>};
    for (int s = 0; s < group.samples; ++s) {
        const P cosine = geometry.next(), sine = geometry.next(), forward = geometry.next(), across = geometry.next();
        const auto [s0, s1, s2, z0, z1, ze] = Moments<P>(context.body(group, cosine, sine), D, z);
        const int* samples = context.samples(group, s);
        const P own[6] = {s0 * nx * nx, s0 * nx * ny, s0 * ny * ny, -s1 * nx, -s1 * ny, s2 + ze};
        const P force[3] = {-nx * z0, -ny * z0, z1};
        scatter_add(own, out.poses.data(), samples, 6), scatter_add(force, forces.poses.data(), samples, 3);
        const P kappa = context.template weight<P>(group, s);
        if (group.covered) {
            const P mixed[3] = {-kappa * s0 * nx, -kappa * s0 * ny, kappa * s1};
            scatter_add(mixed, out.pose_covers.data() + 3 * group.part, samples, 3 * parts);
            cover += kappa * z0, cover_cover += kappa * kappa * s0;
        }
        if (group.wall()) continue;
        const P sa = s0 * across + s1;
        phi -= across * z0 + z1, mu += z0;
        if (group.soft) body += z0, soft.phi += sa, soft.weight += s0, soft.cover -= kappa * s0;
        phi_phi += (s0 * across + 2.0 * s1) * across + s2 + z0 * forward + ze, phi_mu -= sa, mu_mu += s0;
        phi_cover -= kappa * sa, mu_cover += kappa * s0;
        block.put(nx * sa + z0 * ny), block.put(ny * sa - z0 * nx), block.put(-(s1 * across + s2) - ze);
        block.put(-s0 * nx), block.put(-s0 * ny), block.put(s1);
    }
    if (group.covered) {
        const P own[1] = {cover_cover}, force[1] = {cover};
        const int* intervals = context.intervals(group);
        scatter_add(own, out.covers.data() + group.part, intervals, parts);
        scatter_add(force, forces.covers.data() + group.part, intervals, parts);
    }
    if (group.wall()) return;
    store(phi, forces.lines.data() + 2 * group.line), store(mu, forces.lines.data() + 2 * group.line + lane_count<P>);
    if (group.soft) {
        soft.own = D.next();
        set_penetrations(context, group, P(-body - z.next()), forces);
        block.put(soft.phi), block.put(soft.weight), block.put(soft.own), block.put(soft.obstacle), block.put(soft.cover);
    }
    block = {out.blocks.data() + group.block};
    block.put(phi_phi), block.put(phi_mu), block.put(mu_mu), block.put(phi_cover), block.put(mu_cover);
}

}  // namespace tightspot::stagewise
