#include "check.hpp"
#include "tightspot/motion_cost.hpp"
#include "tightspot/path.hpp"

using namespace tightspot;

TEST(advance_agrees_with_integrating_small_steps) {
    for (const Arc arc : {Arc{2.0, 0.3}, Arc{-3.0, 0.25}, Arc{1.5, 0.0}, Arc{-2.0, -1e-7}, Arc{4.0, 1e-5}}) {
        const Pose start{1.0, -2.0, 0.7};
        double x = start.x, y = start.y;
        const int steps = 20000;
        for (int i = 0; i < steps; ++i) {
            const double theta = start.theta + arc.curvature * arc.length * (i + 0.5) / steps;
            x += arc.length / steps * std::cos(theta);
            y += arc.length / steps * std::sin(theta);
        }
        const Pose end = advance(start, arc);
        CHECK_CLOSE(end.x, x, 1e-8);
        CHECK_CLOSE(end.y, y, 1e-8);
        CHECK_CLOSE(end.theta, start.theta + arc.curvature * arc.length, 1e-14);
    }
}

TEST(driving_an_arc_back_returns_to_its_start) {
    const Pose start{3.0, 4.0, 2.0};
    const Pose back = advance(advance(start, {5.0, -0.2}), {-5.0, -0.2});
    CHECK_CLOSE(back.x, start.x, 1e-13);
    CHECK_CLOSE(back.y, start.y, 1e-13);
    CHECK_CLOSE(back.theta, start.theta, 1e-15);
}

TEST(wrapped_angles_are_equivalent_and_small) {
    for (double angle = -50.0; angle < 50.0; angle += 0.37) {
        const double wrapped = wrap_angle(angle);
        CHECK(std::abs(wrapped) <= pi);
        CHECK_CLOSE(std::sin(wrapped), std::sin(angle), 1e-13);
        CHECK_CLOSE(std::cos(wrapped), std::cos(angle), 1e-13);
    }
}

TEST(merging_joins_only_arcs_of_one_curvature_and_gear) {
    const std::vector<Arc> arcs = merged({{1, 0.1}, {2, 0.1}, {-1, 0.1}, {0, 0.3}, {-1, 0.1}, {-1, 0.2}});
    CHECK(arcs.size() == 3);
    CHECK_CLOSE(arcs[0].length, 3.0, 0.0);
    CHECK_CLOSE(arcs[1].length, -2.0, 0.0);
}

TEST(cost_of_a_path_is_the_same_in_both_directions) {
    MotionCost cost;
    cost.full_curvature = 0.3;
    const std::vector<Arc> arcs{{2, 0.3}, {1, 0.0}, {-3, -0.3}, {1, 0.15}};
    CHECK_CLOSE(cost.path(reversed(reversed(arcs))), cost.path(arcs), 1e-12);
    CHECK_CLOSE(cost.path(reversed(arcs)), cost.path(arcs), 1e-12);  // reverse factor 1
    cost.reverse = 2.0;
    CHECK(cost.path(arcs) > cost.path({{2, 0.3}, {1, 0.0}, {3, -0.3}, {1, 0.15}}) - 2.0 * cost.gear_change);
    CHECK_CLOSE(cost.path(arcs),
                2 * 1.1 + 1 + 2 * 3 * 1.1 + 1.05 + 2 * cost.gear_change + 0.5 * (1 + 1 + 1 + 1.5 + 0.5), 1e-12);
}

TEST(samples_are_dense_and_end_where_the_arcs_do) {
    const std::vector<Arc> arcs{{2.03, 0.3}, {-1.0, 0.0}};
    const std::vector<Sample> samples = sample({0, 0, 0}, arcs, 0.1);
    CHECK(samples.size() == 1 + 21 + 10);
    const Pose end = advance(advance({0, 0, 0}, arcs[0]), arcs[1]);
    CHECK_CLOSE(samples.back().pose.x, end.x, 1e-12);
    CHECK(samples.back().gear == -1 && samples[1].gear == 1 && samples[0].gear == 1);
    CHECK(sample({1, 2, 3}, {}, 0.1).size() == 1);
}
