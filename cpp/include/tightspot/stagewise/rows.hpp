// The inequality rows of an interval, visited block by block in their order: every row is a vertex against a line.
#pragma once

#include <array>
#include <type_traits>

#include "tightspot/stagewise/motion.hpp"
#include "tightspot/stagewise/problem.hpp"

namespace tightspot::stagewise {

// Calls loop(count), with a count of 4, by far the most frequent, as a constant that the compiler can unroll.
template <class Loop>
inline void over(int count, Loop&& loop) {
    if (count == 4)
        loop(std::integral_constant<int, 4>{});
    else
        loop(count);
}

// The vertices r_i of a body part at one sample pose T, R against a line n . q = offset (a pair's, or a wall's with
// inward normal). Row i: along + e_i - weight * cover >= 0 with e_i = n . R r_i.
struct BodyRows {
    int part, sample, pair, row, count;  // sample: within the interval; pair: -1 for a wall
    const double *x, *y;
    double nx, ny;    // n
    double cos, sin;  // R' n, so that e_i = cos x_i + sin y_i, and -de_i/dtheta = t_i = cos y_i - sin x_i
    double along;     // n . (T - origin) - offset - constant demand
    double forward;   // n . (T - origin)
    double across;    // its derivative with respect to phi
    double weight;
    double demand;    // constant demand

    double e(int i) const { return cos * x[i] + sin * y[i]; }
    double t(int i) const { return cos * y[i] - sin * x[i]; }
};

// The vertices O_j of an obstacle part against its pair's line. Row j: mu - side - e_j - weight * cover >= 0.
struct ObstacleRows {
    int part, pair, row, count;
    const double *x, *y;
    double nx, ny, ox, oy;
    double along;  // mu - side
    double weight;
    double demand;  // side

    double e(int j) const { return nx * (x[j] - ox) + ny * (y[j] - oy); }
    double t(int j) const { return nx * (y[j] - oy) - ny * (x[j] - ox); }
};

inline BodyRows body_rows(const SamplePose& pose, double nx, double ny, double ox, double oy) {
    BodyRows rows{};
    const double x = pose.x - ox, y = pose.y - oy;
    rows.nx = nx, rows.ny = ny;
    rows.cos = nx * pose.cos + ny * pose.sin;
    rows.sin = ny * pose.cos - nx * pose.sin;
    rows.along = rows.forward = nx * x + ny * y;
    rows.across = nx * y - ny * x;
    return rows;
}

// Calls visitor.body(BodyRows), visitor.obstacle(ObstacleRows), visitor.end_pair(part, pair), visitor.end_part(part).
template <class Model, class Visitor>
void visit_rows(const Problem& problem, const Layout& layout, const double* v, const Values<Model>& at, int k,
                Visitor& visitor) {
    const int parts = problem.parts.size(), first = layout.sample[k], samples = layout.sample[k + 1] - first;
    int row = layout.row[k];
    const SamplePose* poses = at.poses.data() + first;
    for (int part = 0; part < parts; ++part) {
        const int count = problem.parts.count(part), at_part = k * parts + part;
        const auto finish = [&](BodyRows& rows, int sample, int pair, const Demand& demand, double offset) {
            rows.part = part, rows.sample = sample, rows.pair = pair, rows.row = row, rows.count = count;
            rows.x = problem.parts.x.data() + problem.parts.first[part];
            rows.y = problem.parts.y.data() + problem.parts.first[part];
            rows.along -= offset + demand.constant;
            rows.weight = demand.weight, rows.demand = demand.constant;
            visitor.body(rows);
            row += count;
        };
        if (layout.wall[at_part] < layout.wall[at_part + 1])
            for (int p = 0; p < samples; ++p) {
                const Demand& demand = problem.wall_demands[first + p];
                if (!demand.used) continue;
                for (int i = layout.wall[at_part]; i < layout.wall[at_part + 1]; ++i) {
                    const Wall& wall = problem.walls[i];
                    BodyRows rows = body_rows(poses[p], -wall.normal[0], -wall.normal[1], 0, 0);
                    finish(rows, p, -1, demand, -wall.offset);
                }
            }
        for (int i = layout.pair[at_part]; i < layout.pair[at_part + 1]; ++i) {
            const Pair& pair = problem.pairs[i];
            const double nx = at.normals[2 * i], ny = at.normals[2 * i + 1], mu = v[layout.aux(i) + 1];
            const int corners = problem.obstacles.count(pair.obstacle);
            const int at_obstacle = problem.obstacles.first[pair.obstacle];
            visitor.obstacle(ObstacleRows{part, i, row, corners, problem.obstacles.x.data() + at_obstacle,
                                          problem.obstacles.y.data() + at_obstacle, nx, ny, pair.origin[0],
                                          pair.origin[1], mu - pair.obstacle_side, pair.obstacle_weight,
                                          pair.obstacle_side});
            row += corners;
            for (int p = 0; p < samples; ++p) {
                const Demand& demand = problem.pair_demands[first + p];
                if (!demand.used) continue;
                BodyRows rows = body_rows(poses[p], nx, ny, pair.origin[0], pair.origin[1]);
                finish(rows, p, i, demand, mu);
            }
            visitor.end_pair(part, i);
        }
        visitor.end_part(part);
    }
}

// Values of the rows.
struct RowValues {
    const double* covers;  // of the interval's parts
    double* out;

    void body(const BodyRows& rows) {
        const double along = rows.along - rows.weight * covers[rows.part];
        double* to = out + rows.row;
        over(rows.count, [&](auto count) {
            for (int i = 0; i < count; ++i) to[i] = along + rows.e(i);
        });
    }
    void obstacle(const ObstacleRows& rows) {
        const double along = rows.along - rows.weight * covers[rows.part];
        double* to = out + rows.row;
        over(rows.count, [&](auto count) {
            for (int j = 0; j < count; ++j) to[j] = along - rows.e(j);
        });
    }
    void end_pair(int, int) {}
    void end_part(int) {}
};

// The clearance demanded in each row.
struct RowDemands {
    const double* covers;
    double* out;

    void body(const BodyRows& rows) {
        for (int i = 0; i < rows.count; ++i) out[rows.row + i] = rows.demand + rows.weight * covers[rows.part];
    }
    void obstacle(const ObstacleRows& rows) {
        for (int j = 0; j < rows.count; ++j) out[rows.row + j] = rows.demand + rows.weight * covers[rows.part];
    }
    void end_pair(int, int) {}
    void end_part(int) {}
};

// Steps of the rows, J dv, from the steps of the sample poses, covers and lines.
struct RowSteps {
    const std::array<double, 3>* poses;
    const double* covers;
    const double* lines;  // (dphi, dmu) of each pair
    double* out;

    void body(const BodyRows& rows) {
        const std::array<double, 3>& pose = poses[rows.sample];
        double along = rows.nx * pose[0] + rows.ny * pose[1] - rows.weight * covers[rows.part], turn = -pose[2];
        if (rows.pair >= 0) {
            const double* line = lines + 2 * rows.pair;
            along += rows.across * line[0] - line[1];
            turn += line[0];
        }
        double* to = out + rows.row;
        over(rows.count, [&](auto count) {
            for (int i = 0; i < count; ++i) to[i] = along + turn * rows.t(i);
        });
    }
    void obstacle(const ObstacleRows& rows) {
        const double* line = lines + 2 * rows.pair;
        const double along = line[1] - rows.weight * covers[rows.part];
        double* to = out + rows.row;
        const double turn = line[0];
        over(rows.count, [&](auto count) {
            for (int j = 0; j < count; ++j) to[j] = along - turn * rows.t(j);
        });
    }
    void end_pair(int, int) {}
    void end_part(int) {}
};

}  // namespace tightspot::stagewise
