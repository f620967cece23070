// The inequality rows, group by group: every row is a vertex against a line.
//
// A body's vertex r_i at a sample pose (T, R) against n . q = offset (a pair's mu, or a wall's with inward normal):
// along + e_i - demand >= 0 with along = n . T - offset, e_i = n . R r_i, t_i = -de_i/dtheta. An obstacle's vertex O_j
// against its pair's line: mu - e_j - demand >= 0 with e_j = n . O_j, t_j = de_j/dphi. Points of a pair are relative to
// its origin. A soft pair's penetration sigma is added to its body's rows, and sigma >= 0 is its last row.
#pragma once

#include <type_traits>

#include "tightspot/stagewise/motion.hpp"
#include "tightspot/stagewise/row_groups.hpp"

namespace tightspot::stagewise {

// Calls loop(count), with a count of 4, by far the most frequent, as a constant that the compiler can unroll.
template <class Loop>
inline void over(int count, Loop&& loop) {
    if (count == 4)
        loop(std::integral_constant<int, 4>{});
    else
        loop(count);
}

// The vertices of a body part seen in the direction n, R' n = (cos, sin).
template <class P>
struct BodySide {
    const double *x, *y;
    int count;
    P cos, sin;

    P e(int i) const { return cos * x[i] + sin * y[i]; }
    P t(int i) const { return cos * y[i] - sin * x[i]; }
};

// Those of the obstacle parts; `at` holds packs x_0, y_0, x_1, ...
template <class P>
struct ObstacleSide {
    const double* at;
    int count;
    P nx, ny;

    P x(int j) const { return load<P>(at + 2 * j * lane_count<P>); }
    P y(int j) const { return load<P>(at + (2 * j + 1) * lane_count<P>); }
    P e(int j) const { return nx * x(j) + ny * y(j); }
    P t(int j) const { return nx * y(j) - ny * x(j); }
};

// What values and derivatives of one group need, and where it is: the numbers that do not change, and the geometry that
// `row_values` leaves, packs of the normal (x, y) and of (cos, sin, n . T, its derivative with respect to phi) of every
// sample.
template <class Model>
struct RowContext {
    const Problem& problem;
    const Layout& layout;
    const RowGroups& table;

    template <class P>
    BodySide<P> body(const RowGroup& group, P cos, P sin) const {
        const int first = problem.parts.first[group.part];
        return {problem.parts.x.data() + first, problem.parts.y.data() + first, problem.parts.count(group.part), cos, sin};
    }
    const double* numbers(const RowGroup& group) const { return table.numbers.data() + group.number; }
    const int* intervals(const RowGroup& group) const { return table.intervals.data() + group.line; }
    const int* pairs(const RowGroup& group) const { return table.line_pairs.data() + group.line; }
    const int* penetrations(const RowGroup& group) const { return table.penetrations.data() + group.line; }
    // The groups' penetrations or steps of penetrations, 0 if none are allowed.
    template <class P>
    P penetration(const RowGroup& group, const double* sigmas) const {
        return group.soft ? gather<P>(sigmas, penetrations(group), 1) : P(0.0);
    }
    const int* samples(const RowGroup& group, int s) const {
        return table.samples.data() + group.sample + s * group.width;
    }
    // The demands' weights of the covers: of the obstacle's side and of a sample.
    template <class P>
    P side_weight(const RowGroup& group) const {
        return load<P>(numbers(group) + 3 * lane_count<P>);
    }
    template <class P>
    P weight(const RowGroup& group, int s) const {
        const int before = group.wall() ? 3 : 4 + 2 * group.corners;
        return load<P>(numbers(group) + (before + 2 * s + 1) * lane_count<P>);
    }
    // The groups' covers or steps of covers, from numbers by (interval, part).
    template <class P>
    P cover(const RowGroup& group, const double* covers) const {
        return group.covered ? gather<P>(covers + group.part, intervals(group), problem.parts.size()) : P(0.0);
    }
};

// Values of a group's rows, and their geometry.
template <class P, class Model>
void row_values(const RowContext<Model>& context, const RowGroup& group, const double* v, Values<Model>& out) {
    Reader<P> numbers{context.numbers(group)};
    Writer<P> geometry{out.geometry.data() + group.geometry}, rows{out.rows.data() + group.row};
    const P cover = context.template cover<P>(group, out.covers.data());
    const P first = numbers.next(), second = numbers.next(), third = numbers.next();
    P nx = first, ny = second, offset = third, ox = 0.0, oy = 0.0;
    const P sigma = context.template penetration<P>(group, v + context.layout.sigma);
    if (!group.wall()) {
        const int* pairs = context.pairs(group);
        const double* line = v + context.layout.line;
        sine_cosine(gather<P>(line, pairs, 2), ny, nx);
        ox = first, oy = second, offset = gather<P>(line + 1, pairs, 2);
        const P along = offset - third - numbers.next() * cover;
        const ObstacleSide<P> side{numbers.at, group.corners, nx, ny};
        over(side.count, [&](auto count) {
            for (int j = 0; j < count; ++j) rows.put(along - side.e(j));
        });
        numbers.at += 2 * group.corners * lane_count<P>;
        offset -= sigma;
    }
    geometry.put(nx), geometry.put(ny);
    for (int s = 0; s < group.samples; ++s) {
        const int* samples = context.samples(group, s);
        const double* poses = out.poses.data();
        constexpr int stride = Values<Model>::pose;
        const P x = gather<P>(poses, samples, stride) - ox, y = gather<P>(poses + 1, samples, stride) - oy;
        const P cosine = gather<P>(poses + 2, samples, stride), sine = gather<P>(poses + 3, samples, stride);
        const P forward = nx * x + ny * y, constant = numbers.next(), weight = numbers.next();
        const BodySide<P> side = context.body(group, P(nx * cosine + ny * sine), P(ny * cosine - nx * sine));
        geometry.put(side.cos), geometry.put(side.sin), geometry.put(forward), geometry.put(nx * y - ny * x);
        const P along = forward - offset - constant - weight * cover;
        over(side.count, [&](auto count) {
            for (int i = 0; i < count; ++i) rows.put(along + side.e(i));
        });
    }
    if (group.soft) rows.put(sigma);
}

// The clearance demanded in each row.
template <class P, class Model>
void row_demands(const RowContext<Model>& context, const RowGroup& group, const Values<Model>& at, double* out) {
    Reader<P> numbers{context.numbers(group) + 2 * lane_count<P>};
    Writer<P> rows{out + group.row};
    const P cover = context.template cover<P>(group, at.covers.data()), third = numbers.next();
    if (!group.wall()) {
        const P demand = third + numbers.next() * cover;
        for (int j = 0; j < group.corners; ++j) rows.put(demand);
        numbers.at += 2 * group.corners * lane_count<P>;
    }
    for (int s = 0; s < group.samples; ++s) {
        const P constant = numbers.next(), demand = constant + numbers.next() * cover;
        for (int i = 0; i < context.problem.parts.count(group.part); ++i) rows.put(demand);
    }
    if (group.soft) rows.put(0.0);
}

// Steps of the rows, J dv, from the steps of the sample poses (3 each), covers, lines (phi, mu of each pair) and
// penetrations.
template <class P, class Model>
void row_steps(const RowContext<Model>& context, const RowGroup& group, const Values<Model>& at, const double* poses,
               const double* covers, const double* lines, const double* sigmas, double* out) {
    Reader<P> geometry{at.geometry.data() + group.geometry};
    Writer<P> rows{out + group.row};
    const P cover = context.template cover<P>(group, covers), nx = geometry.next(), ny = geometry.next();
    P dphi = 0.0, dmu = 0.0;
    if (!group.wall()) {
        const int* pairs = context.pairs(group);
        dphi = gather<P>(lines, pairs, 2), dmu = gather<P>(lines + 1, pairs, 2);
        const P along = dmu - context.template side_weight<P>(group) * cover;
        const ObstacleSide<P> side{context.numbers(group) + 4 * lane_count<P>, group.corners, nx, ny};
        over(side.count, [&](auto count) {
            for (int j = 0; j < count; ++j) rows.put(along - dphi * side.t(j));
        });
    }
    const P dsigma = context.template penetration<P>(group, sigmas);
    dmu -= dsigma;
    for (int s = 0; s < group.samples; ++s) {
        const int* samples = context.samples(group, s);
        const P cosine = geometry.next(), sine = geometry.next(), forward = geometry.next(), across = geometry.next();
        static_cast<void>(forward);
        const BodySide<P> side = context.body(group, cosine, sine);
        const P along = nx * gather<P>(poses, samples, 3) + ny * gather<P>(poses + 1, samples, 3) + across * dphi - dmu -
                        context.template weight<P>(group, s) * cover;
        const P turn = dphi - gather<P>(poses + 2, samples, 3);
        over(side.count, [&](auto count) {
            for (int i = 0; i < count; ++i) rows.put(along + turn * side.t(i));
        });
    }
    if (group.soft) rows.put(dsigma);
}

}  // namespace tightspot::stagewise
