#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "check.hpp"
#include "shapes.hpp"
#include "tightspot/judge/cover.hpp"
#include "tightspot/judge/sampled.hpp"
#include "tightspot/judge/single_track.hpp"

using namespace shapes;
using namespace tightspot::judge;

namespace {

constexpr double wheelbase = 2.8, everywhere = std::numeric_limits<double>::infinity();
using Car = judge::SingleTrack;
using Drive = judge::Motion<Car>;

Drive drive(std::vector<double> t, const Drive::State& start, std::vector<double> inputs) {
    return Drive(Car(&wheelbase), std::move(t), start, std::move(inputs));
}

Accuracy accuracy() {
    Accuracy fine;
    fine.rounding = 1e-15;
    return fine;
}

Outline box(double left, double right, double bottom, double top) {
    return Outline({{left, bottom}, {right, bottom}, {right, top}, {left, top}});
}

std::vector<Part> car_parts(double pad = 1e-7) {
    return {{box(-0.929, 3.699, -1.0485, 1.0485), 0, std::hypot(3.699, 1.0485), pad}};
}

/// A wriggle of five seconds: forwards, backwards, both ways of steering.
Drive wriggle() {
    return drive({0, 1, 2.5, 3, 5}, {0, 0, 0.3, 0.5, 0.1}, {1, 0.2, -0.8, -0.3, 0.4, 0, -0.5, 0.25});
}

double gap(const Drive& motion, const Outline& local, const Outline& barrier, double time) {
    const Drive::State state = motion.at(time);
    Outline placed;
    place(local, Placement::of({state[0], state[1], state[2]}), placed);
    return best_line(placed, barrier).clearance;
}

}  // namespace

TEST(a_circle_is_driven_as_a_circle) {
    const double steering = 0.3, curvature = std::tan(steering) / wheelbase;
    Drive motion = drive({0, 4, 20}, {1, 2, 0.5, 1.5, steering}, {0, 0, 0, 0});
    CHECK(motion.integrate(accuracy()));
    CHECK(motion.position_error < 2e-7 && motion.heading_error < 2e-7);
    for (const double time : {0.0, 1.234, 4.0, 4.0001, 17.9, 20.0}) {
        const Pose wanted = advance({1, 2, 0.5}, {1.5 * time, curvature});
        const Drive::State state = motion.at(time);
        CHECK_CLOSE(state[0], wanted.x, motion.position_error);
        CHECK_CLOSE(state[1], wanted.y, motion.position_error);
        CHECK_CLOSE(state[2], wanted.theta, motion.heading_error);
    }
    CHECK_CLOSE(motion.knot(1)[0], motion.at(4)[0], 0);
}

TEST(what_cannot_be_integrated_is_refused) {
    CHECK(!drive({0, 1e6}, {0, 0, 0, 1, 0}, {0, 0}).integrate(accuracy()));
    CHECK(!drive({0, 1e5}, {0, 0, 0, 1e9, 0}, {1e9, 0}).integrate(accuracy()));
    CHECK(!drive({0, 1}, {0, 0, 0, std::nan(""), 0}, {0, 0}).integrate(accuracy()));
    CHECK(!drive({0, 1}, {0, 0, 0, 1, 0}, {everywhere, 0}).integrate(accuracy()));
    CHECK(drive({0, 1e-9}, {0, 0, 0, 1, 0}, {0, 0}).integrate(accuracy()));
}

TEST(bounds_hold_for_finite_differences) {
    Drive motion = wriggle();
    CHECK(motion.integrate(accuracy()));
    const double h = 1e-3;
    for (int k = 0; k < motion.intervals(); ++k) {
        const Bounds bounds =
            motion.model.bounds(motion.knot(k).data(), motion.knot(k + 1).data(), motion.input(k), 0);
        for (double t = motion.t[k] + h; t < motion.t[k + 1] - h; t += 0.01) {
            const Drive::State a = motion.at(t - h), b = motion.at(t), c = motion.at(t + h);
            CHECK(std::abs(c[2] - a[2]) / (2 * h) <= bounds.yaw_rate + 1e-4);
            CHECK(std::abs(c[2] - 2 * b[2] + a[2]) / (h * h) <= bounds.yaw_acceleration + 1e-3);
            const double x = c[0] - 2 * b[0] + a[0], y = c[1] - 2 * b[1] + a[1];
            CHECK(std::hypot(x, y) / (h * h) <= bounds.acceleration + 1e-3);
        }
    }
    const double steep[5] = {0, 0, 0, 1, 1.6}, none[2] = {0, 0};
    CHECK(std::isinf(motion.model.bounds(steep, steep, none, 0).yaw_rate));
}

TEST(best_line_agrees_with_the_search_s_distance) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 2000; ++i) {
        std::vector<Point> points[2];
        for (int which = 0; which < 2; ++which) {
            const double x = 6 * unit(random), y = 6 * unit(random), turn = 2 * pi * unit(random);
            const int corners = 3 + static_cast<int>(4 * unit(random));
            for (int k = 0; k < corners; ++k)
                points[which].push_back({x + 2 * std::cos(turn + 2 * pi * k / corners),
                                         y + 1.1 * std::sin(turn + 2 * pi * k / corners)});
        }
        const Outline body(points[0]), barrier(points[1]);
        const Line line = best_line(body, barrier);
        CHECK_CLOSE(line.clearance, signed_distance(Polygon(points[0]), Polygon(points[1])), 1e-9);
        CHECK_CLOSE(std::hypot(line.normal.x, line.normal.y), 1.0, 1e-12);
        CHECK_CLOSE(lowest(line.normal, body.vertices) - line.support, line.clearance, 1e-12);
        const double boxes = judge::Box::of(points[0]).distance(judge::Box::of(points[1]));
        if (boxes > 0) CHECK(boxes <= line.clearance + 1e-12);
    }
}

TEST(an_edge_without_length_is_no_direction) {
    const Outline square = box(0, 1, 0, 1), padded({{3, 0}, {4, 0}, {4, 1}, {3, 0}, {3, 0}});
    CHECK_CLOSE(best_line(square, padded).clearance, 2.0, 1e-15);
    CHECK_CLOSE(best_line(square, square).clearance, -1.0, 1e-15);  // coincident
    CHECK_CLOSE(best_line(square, box(1, 2, 1, 2)).clearance, 0.0, 1e-15);
}

TEST(a_cover_proves_what_dense_samples_see) {
    Drive motion = wriggle();
    CHECK(motion.integrate(accuracy()));
    const Body<Car> body(motion, car_parts(), 1e-9);
    const Obstacles obstacles({box(4.3, 5, -4, -1.2), box(-9, -1.6, -3, 3), box(60, 61, 0, 1)});
    Task task;
    task.demand = 0.01;
    const Cover cover = Search<Car, Obstacles>(body, obstacles, task).run();
    CHECK(cover.pairs.size() == 3);
    std::size_t row = 0;
    for (int pair = 0; pair < 3; ++pair) {
        const Outline& barrier = obstacles.outlines[pair];
        double worst = everywhere;
        for (double time = 0; time <= 5; time += 1e-3)
            worst = std::min(worst, gap(motion, body.parts[0].outline, barrier, time));
        CHECK(cover.pairs[pair].holds == (worst > 0.01));
        CHECK_CLOSE(cover.pieces[row].start, 0.0, 0);
        double end = 0, proved = everywhere;
        for (; row < cover.pieces.size() && cover.pieces[row].pair == pair; ++row) {
            const Piece& piece = cover.pieces[row];
            CHECK_CLOSE(piece.start, end, 0);
            CHECK(piece.end > piece.start);
            end = piece.end, proved = std::min(proved, piece.proved);
            if (!cover.pairs[pair].holds) continue;
            for (int i = 0; i <= 20; ++i) {
                const Drive::State state = motion.at(piece.start + i * (piece.end - piece.start) / 20);
                Outline placed;
                place(body.parts[0].outline, Placement::of({state[0], state[1], state[2]}), placed);
                CHECK(lowest(piece.normal, placed.vertices) - piece.support >= piece.proved);
            }
        }
        CHECK_CLOSE(end, 5.0, 0);
        CHECK(proved <= worst);
    }
}

TEST(the_worst_moment_is_found) {
    Drive motion = wriggle();
    CHECK(motion.integrate(accuracy()));
    const Body<Car> body(motion, car_parts(), 1e-9);
    const Obstacles obstacles({box(3.9, 5, -3, 3)});
    const Cover cover = Search<Car, Obstacles>(body, obstacles, {}).run();
    CHECK(!cover.pairs[0].holds);
    const Sight worst = worst_moment(body, obstacles, 0, cover.pairs[0]);
    double sampled = everywhere;
    for (double time = 0; time <= 5; time += 1e-3)
        sampled = std::min(sampled, gap(motion, body.parts[0].outline, obstacles.outlines[0], time));
    CHECK(worst.clearance < -0.1);
    CHECK_CLOSE(worst.clearance, sampled, 1e-4);
    CHECK_CLOSE(gap(motion, body.parts[0].outline, obstacles.outlines[0], worst.time), worst.clearance, 1e-12);
}

TEST(walls_hold_the_body_in) {
    Drive motion = drive({0, 2}, {0, 0, 0, 1, 0}, {0, 0});
    CHECK(motion.integrate(accuracy()));
    const Body<Car> body(motion, car_parts(), 1e-9);
    const Walls walls{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}, {-1, -5.6, -2, -2}};
    Task task;
    task.demand = -1e-6;
    const Cover cover = Search<Car, Walls>(body, walls, task).run();
    CHECK(cover.pairs[0].holds && !cover.pairs[1].holds && cover.pairs[2].holds && cover.pairs[3].holds);
    CHECK_CLOSE(cover.pairs[1].clearance, 5.6 - 3.699 - 2, 1e-6);
}

TEST(nothing_to_keep_clear_of) {
    Drive motion = wriggle();
    CHECK(motion.integrate(accuracy()));
    const Body<Car> body(motion, car_parts(), 1e-9);
    const Obstacles none({});
    const Cover cover = Search<Car, Obstacles>(body, none, {}).run();
    CHECK(cover.pieces.empty() && cover.pairs.empty());
}

TEST(an_unbounded_motion_is_given_up) {
    Drive motion = drive({0, 2}, {0, 0, 0, 0, 1.5}, {0, 0.2});  // the wheels turn beyond 90 degrees, at a standstill
    CHECK(motion.integrate(accuracy()));
    const Body<Car> body(motion, car_parts(), 1e-9);
    const Obstacles obstacles({box(5, 6, -1, 1)});
    const Cover cover = Search<Car, Obstacles>(body, obstacles, {}).run();
    CHECK(!cover.pairs[0].holds);
    CHECK(!cover.pieces.empty());
}

TEST(many_far_obstacles_change_nothing_for_the_near_one) {
    Drive motion = wriggle();
    CHECK(motion.integrate(accuracy()));
    const Body<Car> body(motion, car_parts(), 1e-9);
    std::vector<Outline> all{box(4.3, 5, -4, -1.2)};
    const Cover alone = Search<Car, Obstacles>(body, Obstacles(all), {}).run();
    for (int i = 0; i < 500; ++i) all.push_back(box(20 + i % 20, 20.5 + i % 20, i / 20, i / 20 + 0.5));
    const Obstacles crowd(all);
    const Cover cover = Search<Car, Obstacles>(body, crowd, {}).run();
    std::size_t row = 0;
    for (; row < alone.pieces.size(); ++row) {
        CHECK(cover.pieces[row].pair == 0);
        CHECK_CLOSE(cover.pieces[row].proved, alone.pieces[row].proved, 0);
    }
    for (const Sight& sight : cover.pairs) CHECK(sight.holds);
    for (; row < cover.pieces.size(); ++row) CHECK(cover.pieces[row].proved > 1);
}

TEST(samples_are_exact_near_and_no_larger_far_away) {
    const Obstacles obstacles({box(4, 5, -1, 1), box(0, 1, 30, 31)});
    const Outline part = box(-1, 1, -0.5, 0.5);
    const std::vector<Pose> poses{{0, 0, 0}, {0, 0, pi / 4}, {4.5, 0, 0}};
    const std::vector<double> near = sampled_clearances(part, poses, obstacles, 8);
    const std::vector<double> all = sampled_clearances(part, poses, obstacles, 1e9);
    CHECK(near.size() == 6 && all.size() == 6);
    CHECK_CLOSE(near[0], 3.0, 1e-12);
    CHECK_CLOSE(near[2], 4 - 1.5 / std::sqrt(2), 1e-12);
    CHECK_CLOSE(near[4], -1.5, 1e-12);
    for (std::size_t i = 0; i < all.size(); ++i) CHECK(near[i] <= all[i] + 1e-12);
    const Walls walls{{{1, 0}}, {-2}};
    const std::vector<double> depths = sampled_depths(part, poses, walls);
    CHECK_CLOSE(depths[0], 1.0, 1e-12);
    CHECK_CLOSE(depths[2], 5.5, 1e-12);
    CHECK(sampled_clearances(part, {}, obstacles, 8).empty());
}

TEST(nearness_on_intervals_is_the_least_of_the_samples) {
    const Obstacles obstacles({box(4, 5, -1, 1), box(0, 1, 30, 31), box(-3, -2.5, 2, 4)});
    const Walls walls{{{1, 0}, {0, -1}}, {-2, -9}};
    const std::vector<Outline> parts{box(-1, 1, -0.5, 0.5), box(0.5, 2, -0.2, 0.2)};
    constexpr std::size_t intervals = 6, each = 5;
    std::vector<Pose> poses;
    for (std::size_t i = 0; i <= intervals * each; ++i) {
        const double s = 0.3 * static_cast<double>(i);
        poses.push_back({3.5 * std::sin(s), 2 * std::cos(0.7 * s), s * s / 9});
    }
    for (const double far : {0.5, 8.0, 1e9}) {
        std::vector<SampledPart> bodies;
        std::vector<std::size_t> first;
        for (std::size_t k = 0; k <= intervals; ++k) first.push_back(k * each);
        for (const Outline& part : parts) bodies.emplace_back(part, poses, first);
        const Nearness found = nearness(bodies, obstacles, walls, far);
        CHECK(found.near.size() == (far > 1e8 ? 3u : 2u));
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const std::vector<double> clear = sampled_clearances(parts[i], poses, obstacles, far);
            const std::vector<double> depths = sampled_depths(parts[i], poses, walls);
            const auto least = [&](const std::vector<double>& all, std::size_t k, std::size_t column, std::size_t of) {
                double value = all[k * each * of + column];
                for (std::size_t s = k * each; s <= (k + 1) * each; ++s) value = std::min(value, all[s * of + column]);
                return value;
            };
            for (std::size_t k = 0; k < intervals; ++k) {
                const std::size_t row = k * parts.size() + i;
                const std::size_t near = found.near.size();
                for (std::size_t j = 0; j < near; ++j)
                    CHECK_CLOSE(found.clearances[row * near + j], least(clear, k, found.near[j], 3), 1e-12);
                for (std::size_t w = 0; w < 2; ++w)
                    CHECK_CLOSE(found.depths[row * 2 + w], least(depths, k, w, 2), 1e-12);
            }
        }
    }
}
