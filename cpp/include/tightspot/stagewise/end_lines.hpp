// Lines of pairs with rows at both knots of an interval and nowhere else (RowGroup::ends), eliminated in the seven
// coordinates that their rows are written in: the poses of x_k and x_{k+1}, three numbers each, and the interval's cover.
// What they leave goes where the rows' own curvature and forces go, so that one interval's pairs are mapped to its
// variables together, and the cover's gradient is multiplied out once for all of them.
#pragma once

#include "tightspot/stagewise/line_inverse.hpp"
#include "tightspot/stagewise/row_quadratic.hpp"

namespace tightspot::stagewise {

// The mixed derivatives of a group's lines with these coordinates.
template <class P>
struct EndMixed {
    static constexpr int poses = 6, cover = 6, size = 7;
    P phi[size], mu[size];

    EndMixed(const RowGroup& group, const Vector& blocks) {
        Reader<P> block{blocks.data() + group.block + 3 * lane_count<P>};
        phi[cover] = block.next(), mu[cover] = block.next();
        for (int end = 0; end < poses; end += 3) {
            for (int i = 0; i < 3; ++i) phi[end + i] = block.next();
            for (int i = 0; i < 3; ++i) mu[end + i] = block.next();
        }
    }
};

// Inverts a group's blocks and adds what the lines leave of the curvature.
template <class P>
void eliminate_ends(const RowGroups& table, const RowGroup& group, int parts, double* inverses, RowCurvature& out) {
    Reader<P> block{out.blocks.data() + group.block};
    const LineInverse<P> inverse = invert_lines(block, inverses + 3 * group.line);
    const EndMixed<P> mixed(group, out.blocks);
    P r[mixed.size], s[mixed.size];
    for (int i = 0; i < mixed.size; ++i) {
        r[i] = inverse.phi_phi * mixed.phi[i] + inverse.phi_mu * mixed.mu[i];
        s[i] = inverse.phi_mu * mixed.phi[i] + inverse.mu_mu * mixed.mu[i];
    }
    const auto entry = [&](int i, int j) { return -(mixed.phi[i] * r[j] + mixed.mu[i] * s[j]); };
    const int* intervals = table.intervals.data() + group.line;
    for (int end = 0; end < 2; ++end) {
        const int x = 3 * end, y = x + 1, theta = x + 2;
        const int* samples = table.samples.data() + group.sample + end * group.width;
        const P own[6] = {entry(x, x),     entry(x, y),     entry(y, y),
                          entry(x, theta), entry(y, theta), entry(theta, theta)};
        scatter_add(own, out.poses.data(), samples, 6);
        if (!group.covered) continue;
        const P of_cover[3] = {entry(mixed.cover, x), entry(mixed.cover, y), entry(mixed.cover, theta)};
        scatter_add(of_cover, out.pose_covers.data() + 3 * group.part, samples, 3 * parts);
    }
    const P between[9] = {entry(3, 0), entry(3, 1), entry(3, 2), entry(4, 0), entry(4, 1),
                          entry(4, 2), entry(5, 0), entry(5, 1), entry(5, 2)};
    scatter_add(between, out.ends.data(), intervals, 9);
    if (!group.covered) return;
    const P cover_cover[1] = {entry(mixed.cover, mixed.cover)};
    scatter_add(cover_cover, out.covers.data() + group.part, intervals, parts);
}

// Adds what the lines leave of the forces.
template <class P>
void reduce_ends(const RowGroups& table, const RowGroup& group, int parts, const double* inverses,
                 const RowCurvature& curvature, Forces& out) {
    const EndMixed<P> mixed(group, curvature.blocks);
    const LineStep<P> line(inverses + 3 * group.line, out.lines.data() + 2 * group.line);
    const auto entry = [&](int i) { return mixed.phi[i] * line.phi + mixed.mu[i] * line.mu; };
    const int* samples = table.samples.data() + group.sample;
    const P first[3] = {entry(0), entry(1), entry(2)}, last[3] = {entry(3), entry(4), entry(5)};
    scatter_add(first, out.poses.data(), samples, 3), scatter_add(last, out.poses.data(), samples + group.width, 3);
    if (!group.covered) return;
    const P cover[1] = {entry(mixed.cover)};
    scatter_add(cover, out.covers.data() + group.part, table.intervals.data() + group.line, parts);
}

// The lines' steps, (phi, mu) of each pair, from those of the sample poses (3 each) and covers and the lines' forces.
template <class P>
void step_ends(const RowGroups& table, const RowGroup& group, int parts, const double* inverses,
               const RowCurvature& curvature, const Vector& forces, const Forces& steps, double* lines) {
    const EndMixed<P> mixed(group, curvature.blocks);
    P more_phi = 0.0, more_mu = 0.0;
    const auto add = [&](int i, P step) { more_phi += mixed.phi[i] * step, more_mu += mixed.mu[i] * step; };
    for (int i = 0; i < mixed.poses; ++i) {
        const int* samples = table.samples.data() + group.sample + i / 3 * group.width;
        add(i, gather<P>(steps.poses.data() + i % 3, samples, 3));
    }
    if (group.covered)
        add(mixed.cover, gather<P>(steps.covers.data() + group.part, table.intervals.data() + group.line, parts));
    const LineStep<P> line(inverses + 3 * group.line, forces.data() + 2 * group.line, more_phi, more_mu);
    for (int l = 0; l < lane_count<P>; ++l) {
        double* to = lines + 2 * table.line_pairs[group.line + l];
        to[0] = lane(line.phi, l), to[1] = lane(line.mu, l);
    }
}

}  // namespace tightspot::stagewise
