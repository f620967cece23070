#include <algorithm>
#include <random>

#include "check.hpp"
#include "shapes.hpp"

using namespace shapes;

TEST(polygons_are_cleaned_and_turned_counter_clockwise) {
    const Polygon clockwise({{0, 0}, {0, 1}, {2, 1}, {2, 1}, {2, 0}, {0, 0}});
    CHECK(clockwise.size() == 4);
    CHECK_CLOSE(clockwise.doubled_area(), 4.0, 1e-15);
    bool refused = false;
    try {
        const Polygon line({{0, 0}, {1, 0}, {1, 0}});
    } catch (const std::invalid_argument&) {
        refused = true;
    }
    CHECK(refused);
}

TEST(distances_of_known_pairs) {
    const Polygon unit = rectangle(0, 1, 0, 1);
    CHECK_CLOSE(signed_distance(unit, rectangle(3, 4, 0, 1)), 2.0, 1e-15);
    CHECK_CLOSE(signed_distance(unit, rectangle(4, 5, 5, 6)), 5.0, 1e-15);
    CHECK_CLOSE(signed_distance(unit, rectangle(0.75, 2, -5, 5)), -0.25, 1e-15);
    CHECK_CLOSE(signed_distance(unit, rectangle(-5, 5, 0.4, 0.5)), -0.5, 1e-15);  // a plus sign: no vertex inside
    CHECK_CLOSE(signed_distance(unit, Polygon({{2, 0.5}, {3, 0}, {3, 1}})), 1.0, 1e-15);
    CHECK_CLOSE(point_distance(unit, {0.5, 0.5}), 0.0, 0.0);
    CHECK_CLOSE(point_distance(unit, {2, 2}), std::sqrt(2.0), 1e-15);
}

TEST(slack_bounds_the_clearance_and_agrees_on_its_sign) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const double margin : {0.0, 0.1, 0.4}) {
        std::vector<Polygon> obstacles;
        for (int i = 0; i < 40; ++i) {
            const double x = 30 * unit(random), y = 30 * unit(random), turn = 2 * pi * unit(random);
            std::vector<Point> points;
            const int corners = 3 + i % 5;
            for (int k = 0; k < corners; ++k)
                points.push_back(
                    {x + std::cos(turn + 2 * pi * k / corners), y + 0.6 * std::sin(turn + 2 * pi * k / corners)});
            obstacles.emplace_back(points);
        }
        const CollisionChecker checker(car(), rectangle(0, 30, 0, 30), obstacles, margin);
        for (int i = 0; i < 4000; ++i) {
            const Pose pose{30 * unit(random), 30 * unit(random), 7 * unit(random)};
            const Contact contact = checker.contact(pose);
            const bool is_inside = contact.obstacle != Contact::workspace;
            const double slack = checker.slack(pose);
            CHECK((slack > 0.0) == (is_inside && contact.clearance > margin));
            if (slack > 0.0) CHECK(slack <= contact.clearance - margin + 1e-9);
        }
    }
}

TEST(a_map_lists_all_obstacles_within_reach_and_few_others) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Polygon> obstacles{rectangle(0, 100, 30, 31), rectangle(-20, -10, 0, 100)};
    for (int i = 0; i < 400; ++i) {
        const double x = 110 * unit(random) - 5, y = 110 * unit(random) - 5;
        obstacles.push_back(rectangle(x, x + 3 * unit(random) + 0.1, y, y + 0.1 + 12 * unit(random)));
    }
    const double reach = 3.5, cell = 0.8;
    const ObstacleMap map(obstacles, rectangle(0, 100, 0, 100), reach, cell);
    for (int i = 0; i < 3000; ++i) {
        const Point q{100 * unit(random), 100 * unit(random)};
        std::vector<int> listed(map.near(q).begin(), map.near(q).end());
        CHECK(std::is_sorted(listed.begin(), listed.end()));
        for (int j = 0; j < static_cast<int>(obstacles.size()); ++j) {
            const bool is_listed = std::binary_search(listed.begin(), listed.end(), j);
            const double distance = point_distance(obstacles[j], q);
            if (distance <= reach) CHECK(is_listed);
            if (is_listed) CHECK(distance <= reach + 9.0);
        }
    }
}

TEST(touching_the_workspace_is_allowed) {
    const CollisionChecker checker(car(), rectangle(-0.929, 10, -1.0485, 1.0485), {}, 0.1);
    CHECK(checker.is_free({0, 0, 0}));
    CHECK(!checker.is_free({-1e-6, 0, 0}));
    CHECK(checker.contact({0, 0.1, 0}).obstacle == Contact::workspace);
    CHECK_CLOSE(checker.contact({0, 0.1, 0}).clearance, -0.1, 1e-12);
}

TEST(a_thin_post_between_samples_is_not_missed) {
    const double thin = 1e-3;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
        const Arc arc{3.0 * unit(random), 0.3 * unit(random)};
        const double x = 4.0 * unit(random) + 1.5, y = 2.0 * unit(random);
        const Polygon post = rectangle(x, x + thin, y, y + thin);
        const CollisionChecker checker(car(), rectangle(-20, 20, -20, 20), {post}, 0.01);
        const double slack = checker.slack({0, 0, 0});
        if (slack <= 0.0) continue;
        double at_end = 0.0;
        const bool is_free = checker.arc_is_free({0, 0, 0}, arc, slack, at_end);
        double nearest = HUGE_VAL;
        for (int k = 0; k <= 1000; ++k) {
            const Pose pose = advance({0, 0, 0}, {arc.length * k / 1000, arc.curvature});
            nearest = std::min(nearest, checker.contact(pose).clearance);
        }
        if (is_free) CHECK(nearest > 0.01 - checker.sweep_tolerance());
        if (nearest <= 0.01 - checker.sweep_tolerance()) CHECK(!is_free);
        if (nearest > 0.01 + 0.003) CHECK(is_free);
        hits += is_free ? 0 : 1;
    }
    CHECK(hits > 50);
}

TEST(many_obstacles_cost_no_more_where_few_are_near) {
    std::vector<Polygon> obstacles;
    for (int i = 0; i < 100; ++i)
        for (int j = 0; j < 100; ++j) obstacles.push_back(rectangle(6.0 * i, 6.0 * i + 0.5, 6.0 * j, 6.0 * j + 0.5));
    const CollisionChecker checker(car(), rectangle(-10, 610, -10, 610), obstacles, 0.05);
    for (int i = 0; i < 1000; ++i) checker.slack({3.0 + 0.5 * i, 303.0 + 0.01 * i, 0.01 * i});
    CHECK(checker.pose_checks() == 1000);
    CHECK(checker.pair_tests() < 4000);
}

TEST(free_length_stops_before_the_obstacle) {
    const CollisionChecker checker(car(), rectangle(-20, 20, -5, 5), {rectangle(8, 9, -5, 5)}, 0.1);
    const double ahead = checker.free_length({0, 0, 0}, 10.0, 0.0);
    CHECK(ahead <= 8 - 3.699 - 0.1 && ahead > 8 - 3.699 - 0.1 - 0.5);
    CHECK_CLOSE(checker.free_length({0, 0, 0}, -10.0, 0.0), -10.0, 0.5);
}
