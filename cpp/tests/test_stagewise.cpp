#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "check.hpp"
#include "tightspot/stagewise/generated/single_track.hpp"
#include "tightspot/stagewise/interior_point.hpp"
#include "tightspot/stagewise/start_lines.hpp"
#include "tightspot/stagewise/validate.hpp"

// The sanitizer's allocator tells of every allocation, so that a test can say that solving makes none.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*)(const volatile void*, std::size_t),
                                                         void (*)(const volatile void*));
static thread_local long allocations = 0;
static void count_allocation(const volatile void*, std::size_t) { ++allocations; }
static void ignore_release(const volatile void*) {}

using namespace tightspot::stagewise;

namespace {

constexpr double pi = 3.14159265358979323846;
const double nan_ = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
using Solver = InteriorPoint<SingleTrack>;

Polygons boxes(const std::vector<std::vector<double>>& all) {  // {x low, x high, y low, y high}
    Polygons polygons;
    for (const std::vector<double>& box : all) {
        for (double x : {box[0], box[1], box[1], box[0]}) polygons.x.push_back(x);
        for (double y : {box[2], box[2], box[3], box[3]}) polygons.y.push_back(y);
        polygons.first.push_back(static_cast<int>(polygons.x.size()));
    }
    return polygons;
}

// A car that drives 8 m ahead and 2 m to the left, past boxes.
Problem problem(int steps, const std::vector<std::vector<double>>& obstacles, int pieces = 1) {
    Problem p;
    p.steps = steps;
    p.widths.assign(steps, 1.0 / steps);
    p.pieces.assign(steps, pieces), p.substeps.assign(steps, 2);
    p.parameters = {2.7, 0.6, std::tan(0.6)};
    p.time_weight = 1, p.input_weights = {1, 2};
    p.state_low = {-infinity, -infinity, -infinity, -1.5, -0.6}, p.state_high = {infinity, infinity, infinity, 1.5, 0.6};
    p.input_low = {-1, -0.3}, p.input_high = {1, 0.3};
    p.time_low = 0.1, p.time_high = 100;
    p.start = {0, 0, 0, 0, 0}, p.goal = {8, 2, 0, 0, 0};
    p.parts = boxes({{-1, 3.5, -1, 1}}), p.radii = {3.7};
    p.obstacles = boxes(obstacles);
    for (int k = 0; k < steps; ++k) {
        const double along = 8.0 * (k + 1) / steps;
        for (int i = 0; i < p.obstacles.size(); ++i) p.pairs.push_back({k, 0, i, {along, 3}, 0.05, pieces > 1 ? 0.5 : 0});
        p.walls.push_back({k, 0, {0, 1}, 6}), p.walls.push_back({k, 0, {1, 0}, 14});
        for (int s = 0; s <= pieces; ++s) {
            const int used = pieces > 1 || s == pieces;
            const bool given = (k == 0 && s == 0) || (k + 1 == steps && s == pieces);
            p.pair_demands.push_back({0.05, pieces > 1 && !given ? 0.5 : 0, used}), p.wall_demands.push_back({0, 0, used});
        }
    }
    return p;
}

// Straight to the goal, with every obstacle to the left.
void start(Solver& solver) {
    const Layout& layout = solver.layout();
    Vector& v = solver.point.v;
    std::fill(v.begin(), v.end(), 0.0);
    for (int k = 0; k <= layout.steps; ++k) {
        const double share = static_cast<double>(k) / layout.steps;
        v[layout.x(k)] = 8 * share, v[layout.x(k) + 1] = 2 * share * share * (3 - 2 * share), v[layout.x(k) + 3] = 0.8;
        v[layout.x(k) + 2] = 1.5 * share * (1 - share);
    }
    v[layout.time] = 10;
    for (std::size_t i = 0; i < solver.problem().pairs.size(); ++i) v[layout.aux(static_cast<int>(i))] = -pi / 2;
}

// The same where every pair, or every second one, may penetrate.
Problem soft(Problem p, double constant, double timed = 0, int every = 1) {
    for (std::size_t i = 0; i < p.pairs.size(); i += every) p.pairs[i].penalty = {constant, timed, 1};
    return p;
}

Outcome solve(Problem p, Options options = {}) {
    Solver solver(std::move(p));
    start(solver);
    return solver.solve(options);
}

// Gives obstacle 0 the motion o(t) = from + t * rate for every knot's time t = share * t_f; poses are those at t_f = 10.
void move(Problem& p, const std::vector<double>& from, const std::vector<double>& rate) {
    Motion motion;
    motion.time = 10;
    for (int k = 0; k < p.steps; ++k)
        for (int s = 0; s <= p.pieces[k]; ++s)
            for (int i = 0; i < 3; ++i) {
                const double share = (k + static_cast<double>(s) / p.pieces[k]) / p.steps;
                motion.poses.push_back(from[i] + 10 * share * rate[i]), motion.slopes.push_back(share * rate[i]);
            }
    p.motions.push_back(motion);
}

}  // namespace

TEST(stagewise_step_derivatives_are_those_of_the_step) {
    const double x[5] = {1, 2, 0.4, 0.8, -0.3}, u[2] = {0.4, 0.2}, p[3] = {2.7, 0.6, std::tan(0.6)}, h = 0.7;
    double after[5], shared[SingleTrack::shared], J[30], H[36], moved[5], other[SingleTrack::shared];
    const double lam[5] = {0.3, -0.7, 1.1, 0.2, 0.5};
    SingleTrack::step(x, h, u, p, after, shared);
    SingleTrack::step_jacobian(x, h, u, p, shared, J);
    SingleTrack::step_hessian(x, h, u, p, shared, lam, H);
    for (int c = 0; c < 6; ++c) {
        const double step = 1e-6;
        double y[5], w[2] = {u[0], u[1]}, g = h, shifted[30];
        std::copy(x, x + 5, y);
        (c < 3 ? y[2 + c] : c == 3 ? g : w[c - 4]) += step;
        SingleTrack::step(y, g, w, p, moved, other);
        SingleTrack::step_jacobian(y, g, w, p, other, shifted);
        for (int i = 0; i < 5; ++i) CHECK_CLOSE((moved[i] - after[i]) / step, J[i * 6 + c], 1e-5);
        for (int r = 0; r < 6; ++r) {
            double change = 0;
            for (int i = 0; i < 5; ++i) change += lam[i] * (shifted[i * 6 + r] - J[i * 6 + r]) / step;
            CHECK_CLOSE(change, H[r * 6 + c], 1e-5);
        }
    }
}

TEST(stagewise_packs_compute_what_numbers_do) {
    Pack angles = 0.0, sines, cosines;
    for (int sample = -400; sample < 400; ++sample) {
        for (int l = 0; l < lanes; ++l) angles.set(l, 0.0371 * sample * (l + 1));
        sine_cosine(angles, sines, cosines);
        for (int l = 0; l < lanes; ++l) {
            CHECK_CLOSE(sines[l], std::sin(angles[l]), 4e-16);
            CHECK_CLOSE(cosines[l], std::cos(angles[l]), 4e-16);
        }
    }
    angles.set(0, 1e9);
    sine_cosine(angles, sines, cosines);
    CHECK_CLOSE(sines[0], std::sin(1e9), 1e-16);
    angles.set(0, nan_);
    sine_cosine(angles, sines, cosines);
    CHECK(std::isnan(sines[0]) && std::isnan(cosines[0]));
}

TEST(stagewise_reductions_are_those_of_plain_loops) {
    for (std::size_t n : {0, 1, 3, 7, 8, 29, 130}) {
        Vector values(n);
        double sum = 0, most = 0, logs = 0;
        Logarithms logarithms;
        for (std::size_t i = 0; i < n; ++i) {
            values[i] = std::exp(40 * std::sin(3.7 * static_cast<double>(i)));
            sum += values[i], most = std::max(most, values[i]), logs += std::log(values[i]);
        }
        over_packs(n, [&](auto zero, std::size_t i) { logarithms.add(load<decltype(zero)>(&values[i])); });
        CHECK(logarithms.usable());
        CHECK_CLOSE(logarithms.value(), logs, 1e-11);
        CHECK_CLOSE(sum_of_magnitudes(values.data(), n) / std::max(sum, 1.0), sum / std::max(sum, 1.0), 1e-14);
        CHECK(largest_magnitude(values.data(), n) == most);
        for (double bad : {nan_, infinity, 0.0, -1.0}) {
            if (n < 3) continue;
            values[2] = bad;
            Logarithms spoilt;
            over_packs(n, [&](auto zero, std::size_t i) { spoilt.add(load<decltype(zero)>(&values[i])); });
            CHECK(!spoilt.usable());
            CHECK(std::isfinite(largest_magnitude(values.data(), n)) == std::isfinite(bad));
        }
    }
}

TEST(stagewise_rows_come_back_in_the_problems_order) {
    // Bodies and obstacles of different sizes, so that there are full groups and single lines.
    Problem mixed = problem(5, {{4, 7, 3.2, 5}, {1, 2, 4, 5}}, 2);
    mixed.obstacles.x.push_back(7), mixed.obstacles.y.push_back(5.5), mixed.obstacles.first.back() += 1;
    Solver solver(mixed);
    start(solver);
    solver.lagrangian();
    const Vector rows = solver.in_order(solver.values().rows), demands = solver.demands();
    const Layout& layout = solver.layout();
    const double* v = solver.point.v.data();
    CHECK(rows.size() == static_cast<std::size_t>(layout.row.back()));
    for (int k = 0; k < 5; ++k) {
        int row = layout.row[k] + 2 * 3 * 4;  // two walls, three samples
        for (int i = layout.pair[k]; i < layout.pair[k + 1]; ++i) {
            const Pair& pair = mixed.pairs[i];
            const double nx = std::cos(v[layout.aux(i)]), ny = std::sin(v[layout.aux(i)]);
            const double mu = v[layout.aux(i) + 1] + nx * pair.origin[0] + ny * pair.origin[1];
            for (int j = mixed.obstacles.first[pair.obstacle]; j < mixed.obstacles.first[pair.obstacle + 1]; ++j, ++row)
                CHECK_CLOSE(rows[row], mu - nx * mixed.obstacles.x[j] - ny * mixed.obstacles.y[j] - demands[row], 1e-12);
            const double* x = v + layout.x(k);
            for (int c = 0; c < 4; ++c) {
                const double cx = mixed.parts.x[c], cy = mixed.parts.y[c];
                const double X = x[0] + std::cos(x[2]) * cx - std::sin(x[2]) * cy;
                const double Y = x[1] + std::sin(x[2]) * cx + std::cos(x[2]) * cy;
                CHECK_CLOSE(rows[row + c], nx * X + ny * Y - mu - demands[row + c], 1e-12);
            }
            row += 3 * 4;
        }
        CHECK(row == layout.row[k + 1]);
    }
    Vector back(rows.size());
    solver.put_in_place(rows, back);
    CHECK(back == solver.values().rows);
}

TEST(stagewise_starts_from_the_lines_that_separate_best) {
    const Vector states = {0, 0, 0, 0, 2, 0, pi / 2, 0};  // two knots, four numbers each
    const Indices pieces = {2};
    const std::vector<char> whole = {1}, at_end = {0};
    StartLines lines(boxes({{-1, 1, -1, 1}}), boxes({{-9, 9, 3, 4}, {5, 7, -20, 20}}));
    const StartLine above = lines.of({states.data(), 4, pieces, at_end}, 0, 0, 0);
    CHECK_CLOSE(above.phi, -pi / 2, 1e-12);
    CHECK_CLOSE(above.offset, -2, 1e-12);
    CHECK_CLOSE(above.x, 2, 1e-12);
    CHECK_CLOSE(above.y, 2, 1e-12);
    // At 45 degrees, half way, the body reaches furthest to the right at the end all the same: 2 + 1.
    const StartLine right = lines.of({states.data(), 4, pieces, whole}, 0, 0, 1);
    CHECK_CLOSE(std::abs(right.phi), pi, 1e-12);
    CHECK_CLOSE(right.offset, -4, 1e-12);
    CHECK_CLOSE(right.x, 4, 1e-12);
}

TEST(stagewise_starts_lines_from_where_the_obstacle_is) {
    const Vector states = {0, 0, 0, 0, 2, 0, 0, 0}, frames = {0, 0, 0, 2, -9, pi / 2};
    const Indices pieces = {1};
    const std::vector<char> at_end = {0};
    StartLines lines(boxes({{-1, 1, -1, 1}}), boxes({{-1, 1, -1, 1}}));
    const StartLine below = lines.of({states.data(), 4, pieces, at_end}, 0, 0, 0, frames.data());
    CHECK_CLOSE(below.phi, 0, 1e-12);  // above the obstacle is ahead in its frame
    CHECK_CLOSE(below.offset, (8 + 1) / 2.0, 1e-12);
    CHECK_CLOSE(below.x, 4.5, 1e-12);
    CHECK_CLOSE(below.y, 0, 1e-12);
}

TEST(stagewise_sees_a_frame_that_stands_like_the_world) {
    for (int pieces : {1, 2}) {
        Problem turned = problem(9, {{-0.9, 0.9, -1.5, 1.5}}, pieces);
        move(turned, {5.5, 4.1, pi / 2}, {0, 0, 0});
        for (Pair& pair : turned.pairs) pair.origin[0] = pair.origin[1] = 0;
        Solver solver(turned);
        start(solver);
        for (int i = 0; i < 9; ++i) solver.point.v[solver.layout().aux(i)] = pi;  // behind it, in its frame
        const Outcome outcome = solver.solve(Options{});
        CHECK(outcome.status == Status::solved);
        CHECK_CLOSE(outcome.objective, solve(problem(9, {{4, 7, 3.2, 5}}, pieces)).objective, 1e-6);
    }
}

TEST(stagewise_derivatives_along_the_final_time_of_a_turning_obstacle) {
    Problem moving = problem(4, {{-0.9, 0.9, -1.5, 1.5}, {4, 7, 3.2, 5}}, 2);
    move(moving, {5.5, 4.1, 0.4}, {0.3, -0.2, 0.25});
    Solver solver(moving);
    start(solver);
    Vector& v = solver.point.v;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += 0.1 * std::sin(3.7 * static_cast<double>(i));
    for (std::size_t i = 0; i < solver.point.lam.size(); ++i) solver.point.lam[i] = std::cos(static_cast<double>(i));
    const int time = solver.layout().time;
    const std::size_t n = v.size(), row = static_cast<std::size_t>(time) * n;
    const auto here = solver.lagrangian();
    const double step = 1e-6;
    v[time] += step;
    const auto ahead = solver.lagrangian();
    v[time] -= 2 * step;
    const auto behind = solver.lagrangian();
    for (std::size_t i = 0; i < n; ++i)
        CHECK_CLOSE((ahead.gradient[i] - behind.gradient[i]) / (2 * step), here.hessian[row + i], 1e-4);
}

TEST(stagewise_solves_a_free_drive_and_one_past_a_box) {
    const Outcome free = solve(problem(9, {}));
    CHECK(free.status == Status::solved);
    const Outcome past = solve(problem(9, {{4, 7, 3.2, 5}}));
    CHECK(past.status == Status::solved);
    CHECK(past.objective > free.objective + 1e-3);
    const Outcome swept = solve(problem(9, {{4, 7, 3.2, 5}}, 2));
    CHECK(swept.status == Status::solved);
    CHECK(swept.objective > past.objective);
}

TEST(stagewise_soft_pairs_have_the_derivatives_of_their_definition) {
    for (int pieces : {1, 2}) {
        Solver solver(soft(problem(3, {{4, 7, 1, 5}, {5, 6, -4, -2}}, pieces), 3, 2, 2));
        start(solver);
        const Layout& layout = solver.layout();
        CHECK(layout.soft_pairs.size() == 3);
        CHECK(layout.variables == layout.sigma + 3);
        Vector& v = solver.point.v;
        for (std::size_t i = 0; i < v.size(); ++i) v[i] += 0.1 * std::sin(7.0 * static_cast<double>(i));
        for (std::size_t i = 0; i < solver.point.z.size(); ++i) solver.point.z[i] = 1 + std::cos(3.0 * static_cast<double>(i));
        for (std::size_t i = 0; i < solver.point.lam.size(); ++i) solver.point.lam[i] = std::sin(5.0 * static_cast<double>(i));
        const auto at = solver.lagrangian();
        const auto lagrangian = [&] {
            double sum = solver.values().objective;
            for (std::size_t i = 0; i < solver.point.z.size(); ++i) sum -= solver.point.z[i] * solver.values().rows[i];
            for (std::size_t i = 0; i < solver.point.lam.size(); ++i)
                sum += solver.point.lam[i] * solver.values().defects[i];
            return sum;
        };
        const double before = lagrangian(), step = 1e-6;
        for (std::size_t i = 0; i < v.size(); ++i) {
            v[i] += step;
            const auto moved = solver.lagrangian();
            CHECK_CLOSE((lagrangian() - before) / step, at.gradient[i], 1e-4);
            for (std::size_t j = 0; j < v.size(); ++j)
                CHECK_CLOSE((moved.gradient[j] - at.gradient[j]) / step, at.hessian[i * v.size() + j], 1e-2);
            v[i] -= step;
        }
    }
}

TEST(stagewise_soft_pairs_are_as_good_as_hard_ones_where_there_is_a_way) {
    for (int pieces : {1, 2}) {
        const Problem hard = problem(9, {{4, 7, 3.2, 5}}, pieces);
        const Outcome wanted = solve(hard);
        for (int every : {1, 2}) {
            Solver solver(soft(hard, 50, 10, every));
            start(solver);
            const Outcome outcome = solver.solve(Options{});
            CHECK(outcome.status == Status::solved);
            CHECK(outcome.objective < 1.2 * wanted.objective);  // it may be another local optimum
            const Layout& layout = solver.layout();
            for (int i = layout.sigma; i < layout.variables; ++i) CHECK_CLOSE(solver.point.v[i], 0.0, 1e-6);
        }
    }
}

TEST(stagewise_soft_pairs_tell_how_deep_it_must_be) {
    // A wall across the way, thicker than the body is long: nobody gets through without all of the way out of it.
    Problem closed = soft(problem(8, {{4, 5, -30, 30}}), 100);
    closed.time_high = 12;
    Solver solver(std::move(closed));
    start(solver);
    CHECK(solver.solve(Options{}).status == Status::solved);
    const Layout& layout = solver.layout();
    double deepest = 0;
    for (int i = layout.sigma; i < layout.variables; ++i) deepest = std::max(deepest, solver.point.v[i]);
    CHECK(deepest > 0.5);
    CHECK(deepest < 5.6);
    Problem inside = soft(problem(8, {{7, 12, 0, 4}}), 100);  // the goal is in the box, and will not move
    CHECK(solve(std::move(inside)).status == Status::solved);
}

TEST(stagewise_takes_full_steps_at_the_end) {
    Solver solver(problem(12, {{4, 7, 3.2, 5}}));
    start(solver);
    const Outcome outcome = solver.solve(Options{});
    CHECK(outcome.status == Status::solved);
    const std::size_t n = solver.log.size();
    CHECK(n == static_cast<std::size_t>(outcome.iterations) + 1);
    CHECK(solver.log[n - 2].primal_step > 0.9);
    CHECK(solver.log[n - 1].violation < 1e-8);
}

TEST(stagewise_is_deterministic_and_safe_in_threads) {
    const auto run = [](Vector& v) {
        Solver solver(problem(10, {{4, 7, 3.2, 5}}, 2));
        start(solver);
        solver.solve(Options{});
        v = solver.point.v;
    };
    std::vector<Vector> results(4);
    std::vector<std::thread> threads;
    for (Vector& result : results) threads.emplace_back(run, std::ref(result));
    for (std::thread& thread : threads) thread.join();
    for (const Vector& result : results) CHECK(result == results[0]);
}

TEST(stagewise_allocates_nothing_while_it_solves) {
    Solver solver(problem(9, {{4, 7, 3.2, 5}}, 2));
    start(solver);
    solver.log.reserve(10001);
    CHECK(__sanitizer_install_malloc_and_free_hooks(count_allocation, ignore_release) > 0);
    const long before = allocations;
    delete new int;
    CHECK(allocations == before + 1);
    const Outcome outcome = solver.solve(Options{});
    CHECK(outcome.status == Status::solved);
    CHECK(allocations == before + 1);
    Problem with_motion = problem(9, {{-1.5, 1.5, -0.9, 0.9}}, 2);
    move(with_motion, {5.5, 4.1, 0.1}, {0.1, 0.05, 0.02});
    Solver other(with_motion);
    start(other);
    other.log.reserve(10001);
    const long after = allocations;
    other.solve(Options{});
    CHECK(allocations == after);
    Solver paying(soft(problem(9, {{4, 7, 3.2, 5}}, 2), 50));
    start(paying);
    paying.log.reserve(10001);
    const long before_paying = allocations;
    CHECK(paying.solve(Options{}).status == Status::solved);
    CHECK(allocations == before_paying);
}

TEST(stagewise_limits_and_stops) {
    Options options;
    options.max_iterations = 3;
    CHECK(solve(problem(10, {}), options).status == Status::iteration_limit);
    options.max_iterations = 0;
    CHECK(solve(problem(10, {}), options).status == Status::iteration_limit);
    options.max_iterations = 500, options.time_limit = 0;
    CHECK(solve(problem(10, {}), options).status == Status::time_limit);
    Solver solver(problem(10, {}));
    start(solver);
    const Outcome outcome = solver.solve(Options{}, [](const Record& record) { return record.iteration < 2; });
    CHECK(outcome.status == Status::stopped);
    CHECK(outcome.iterations == 2);
    CHECK(solver.log.size() == 3);
}

TEST(stagewise_never_calls_the_impossible_solved) {
    Problem inside = problem(8, {{7, 12, 0, 4}});  // the goal is in the box
    CHECK(solve(std::move(inside)).status != Status::solved);
    Problem soon = problem(8, {});  // 8 m in 1 s at 1.5 m/s
    soon.time_high = 1;
    CHECK(solve(std::move(soon)).status != Status::solved);
    Problem closed = problem(8, {{4, 5, -30, 30}});  // across the way, and thicker than a step is long
    closed.time_high = 12;
    CHECK(solve(std::move(closed)).status != Status::solved);
    for (double bad : {nan_, infinity, 1e200}) {
        Solver solver(problem(8, {{4, 7, 3.2, 5}}));
        start(solver);
        solver.point.v[7] = bad;
        CHECK(solver.solve(Options{}).status != Status::solved);
    }
}

TEST(stagewise_survives_degenerate_problems) {
    CHECK(solve(problem(1, {})).status != Status::solved);  // one interval cannot do it
    Problem same = problem(8, {{4, 7, 3.2, 5}, {4, 7, 3.2, 5}, {4, 7, 3.2, 5}});  // coincident obstacles
    CHECK(solve(std::move(same)).status == Status::solved);
    Problem point = problem(8, {});
    point.obstacles.x = {7}, point.obstacles.y = {3.2}, point.obstacles.first = {0, 1};
    for (int k = 0; k < 8; ++k) point.pairs.push_back({k, 0, 0, {0, 0}, 0.05, 0});
    CHECK(solve(std::move(point)).status == Status::solved);
    Problem still = problem(4, {});  // nowhere to go
    still.goal = still.start;
    const Outcome outcome = solve(std::move(still));
    CHECK(outcome.status == Status::solved);
    CHECK_CLOSE(outcome.objective, 0.1, 1e-4);
    Problem fixed = problem(10, {});
    fixed.time_low = fixed.time_high = 12;
    CHECK(solve(std::move(fixed)).status == Status::solved);
    Problem loose = problem(10, {});
    loose.start = {0, 0, nan_, nan_, nan_}, loose.goal = {8, nan_, nan_, nan_, nan_};
    CHECK(solve(std::move(loose)).status == Status::solved);
}

TEST(stagewise_names_what_cannot_be_used) {
    const auto wrong = [](void (*spoil)(Problem&)) {
        Problem p = problem(4, {{4, 7, 3.2, 5}});
        spoil(p);
        return flaw(p, 5, 2, 3);
    };
    CHECK(flaw(problem(4, {{4, 7, 3.2, 5}}), 5, 2, 3).empty());
    CHECK(wrong([](Problem& p) { p.steps = 0; }) == "widths");
    CHECK(wrong([](Problem& p) { p.widths[1] = nan_; }) == "widths");
    CHECK(wrong([](Problem& p) { p.pieces[0] = 0; }) == "pieces");
    CHECK(wrong([](Problem& p) { p.substeps.pop_back(); }) == "substeps");
    CHECK(wrong([](Problem& p) { p.state_low[3] = p.state_high[3]; }) == "state bounds");
    CHECK(wrong([](Problem& p) { p.time_high = nan_; }) == "final time bounds");
    CHECK(wrong([](Problem& p) { p.goal.pop_back(); }) == "goal");
    CHECK(wrong([](Problem& p) { p.pairs[2].obstacle = 1; }) == "pairs");
    CHECK(wrong([](Problem& p) { p.pairs[2].interval = 9; }) == "pairs");
    CHECK(wrong([](Problem& p) { std::swap(p.walls.front(), p.walls.back()); }) == "walls");
    CHECK(wrong([](Problem& p) { p.obstacles.x[1] = infinity; }) == "obstacle_vertices");
    CHECK(wrong([](Problem& p) { p.pair_demands.pop_back(); }) == "pair_demands");
    CHECK(wrong([](Problem& p) { p.pairs[1].extra = nan_; }) == "pair_extras");
    CHECK(wrong([](Problem& p) { move(p, {0, 0, 0}, {0, 0, 0}), p.motions[0].obstacle = 1; }) == "motion_obstacles");
    CHECK(wrong([](Problem& p) { move(p, {0, 0, 0}, {0, 0, 0}), p.motions.push_back(p.motions[0]); }) ==
          "motion_obstacles");
    CHECK(wrong([](Problem& p) { move(p, {0, 0, 0}, {0, 0, 0}), p.motions[0].time = nan_; }) == "motion_times");
    CHECK(wrong([](Problem& p) { move(p, {0, nan_, 0}, {0, 0, 0}); }) == "motion_poses");
    CHECK(wrong([](Problem& p) { move(p, {0, 0, 0}, {0, 0, 0}), p.motions[0].slopes.pop_back(); }) ==
          "motion_slopes");
    CHECK(wrong([](Problem& p) { p.wall_demands[1].constant = nan_; }) == "wall_demands");
    CHECK(wrong([](Problem& p) { p.pairs[1].penalty = {0, 0, 1}; }) == "pair_penalties");
    CHECK(wrong([](Problem& p) { p.pairs[1].penalty = {1, -1, 1}; }) == "pair_penalties");
    CHECK(wrong([](Problem& p) { p.pairs[1].penalty = {1, nan_, 1}; }) == "pair_penalties");
    CHECK(wrong([](Problem& p) { p.pairs[1].penalty = {infinity, 0, 1}; }) == "pair_penalties");
    CHECK(wrong([](Problem& p) { p.pairs[1].penalty = {0, 1, 1}; }).empty());
}

namespace {

// Numbers that are the same with every library: the distributions' are not.
struct Dice {
    std::mt19937 engine;

    double between(double low, double high) { return low + (high - low) * (static_cast<double>(engine()) / 4294967296.0); }
    bool one_in(unsigned n) { return engine() % n == 0; }
    double hostile() {
        const double all[] = {nan_, infinity, -infinity, 1e300, -1e300, 1e-300, 0, 1e12};
        return all[engine() % 8];
    }
};

// A drive with boxes anywhere, some on the start, some twice, some points; sometimes with fields that are out of order.
Problem hostile(Dice& dice) {
    std::vector<std::vector<double>> obstacles;
    for (unsigned i = dice.engine() % 4; i > 0; --i) {
        const double x = dice.between(-4, 12), y = dice.between(-4, 5);
        const double size = dice.one_in(5) ? 0 : dice.between(0.05, 5);
        obstacles.push_back({x, x + size, y, y + dice.between(0, 4)});
        if (dice.one_in(4)) obstacles.push_back(obstacles.back());
        if (dice.one_in(5)) obstacles.push_back({-1, 1, -1, 1});
    }
    Problem p = problem(1 + static_cast<int>(dice.engine() % 8), obstacles, 1 + static_cast<int>(dice.engine() % 3));
    if (dice.one_in(5)) p.goal = p.start;
    if (dice.one_in(5)) p.input_weights = {0, 0};
    if (dice.one_in(5)) p.time_weight = 0;
    if (dice.one_in(5)) p.time_high = p.time_low = dice.between(0.1, 20);
    if (dice.one_in(6)) p.goal[dice.engine() % 5] = dice.hostile();
    if (dice.one_in(8)) p.widths[0] = dice.hostile();
    if (dice.one_in(8) && !p.obstacles.x.empty()) p.obstacles.x[0] = dice.hostile();
    if (dice.one_in(8)) p.state_high[3] = dice.hostile();
    if (p.obstacles.size() > 0 && dice.one_in(3)) {
        const double much = dice.one_in(4) ? 1e6 : 1;
        const auto any = [&] { return dice.one_in(40) ? dice.hostile() : much * dice.between(-2, 2); };
        move(p, {any(), any(), any()}, {any(), any(), any()});
    }
    if (dice.one_in(3)) p = soft(std::move(p), dice.between(0, 50), dice.between(0, 50), 1 + dice.engine() % 2);
    if (dice.one_in(8) && !p.pairs.empty()) p.pairs[0].penalty = {dice.hostile(), 1, 1};
    return p;
}

}  // namespace

TEST(stagewise_ends_in_a_status_whatever_it_is_given) {
    Dice dice{std::mt19937(7)};
    int solved = 0, refused = 0;
    for (int round = 0; round < 150; ++round) {
        Problem p = hostile(dice);
        if (!flaw(p, 5, 2, 3).empty()) {
            ++refused;
            continue;
        }
        Solver solver(std::move(p));
        start(solver);
        Vector& v = solver.point.v;
        if (dice.one_in(6)) v[dice.engine() % v.size()] = dice.hostile();
        Options options;
        options.max_iterations = 80;
        const Outcome outcome = solver.solve(options);
        CHECK(outcome.status != Status::invalid);
        CHECK(outcome.iterations <= 80);
        if (outcome.status != Status::solved) continue;
        ++solved;
        Vector samples(Audit<SingleTrack>::scratch_size(solver.problem()), 0);
        CHECK(Audit<SingleTrack>(solver.problem(), solver.layout(), v, samples).violation() <= 1e-7);
    }
    CHECK(solved > 10);
    CHECK(refused > 5);
}
