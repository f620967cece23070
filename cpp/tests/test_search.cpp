#include <random>

#include "check.hpp"
#include "shapes.hpp"
#include "tightspot/path.hpp"
#include "tightspot/shortcut.hpp"

using namespace shapes;

namespace {

const Pose road{0, 0, 0};
const Pose parked{6.3, -6.7, pi / 2};

void check_path(const CollisionChecker& checker, const Pose& start, const Pose& goal, const std::vector<Arc>& arcs) {
    const Pose end = end_of(start, arcs);
    CHECK_CLOSE(end.x, goal.x, 1e-6);
    CHECK_CLOSE(end.y, goal.y, 1e-6);
    CHECK_CLOSE(wrap_angle(end.theta - goal.theta), 0.0, 1e-6);
    for (const Arc& arc : arcs) CHECK(std::abs(arc.curvature) <= 0.285 + 1e-12);
    for (const Sample& s : sample(start, arcs, 0.01)) {
        const Contact contact = checker.contact(s.pose);
        CHECK(contact.clearance > checker.margin() - 2.0 * checker.sweep_tolerance());
        CHECK(contact.obstacle != Contact::workspace || contact.clearance > -2.0 * checker.sweep_tolerance());
    }
}

}  // namespace

TEST(parks_from_either_end) {
    const CollisionChecker checker = slot(2.5, 0.05);
    for (const bool backward : {true, false}) {
        SearchOptions o = options();
        o.backward = backward;
        const SearchResult result = HybridAStar(checker, o).run(road, parked);
        CHECK(result.outcome == Outcome::found);
        check_path(checker, road, parked, result.arcs);
        CHECK_CLOSE(o.cost.path(result.arcs), result.cost, 1e-6);
        const std::vector<Arc> shorter = Shortcutter(checker, o.cost).improve(road, result.arcs);
        check_path(checker, road, parked, shorter);
        CHECK(o.cost.path(shorter) <= result.cost + 1e-9);
    }
}

TEST(searches_are_deterministic) {
    const CollisionChecker checker = slot(2.4, 0.05);
    const SearchResult first = HybridAStar(checker, options()).run(road, parked);
    const SearchResult second = HybridAStar(checker, options()).run(road, parked);
    CHECK(first.expansions == second.expansions && first.pose_checks == second.pose_checks);
    CHECK(first.arcs.size() == second.arcs.size() && first.cost == second.cost);
}

TEST(a_slot_too_narrow_is_blocked_and_names_the_obstacle) {
    const SearchResult result = HybridAStar(slot(2.1, 0.05), options()).run(road, parked);
    CHECK(result.outcome == Outcome::goal_blocked);
    CHECK(result.contact.obstacle == 0 || result.contact.obstacle == 1);
    CHECK_CLOSE(result.contact.clearance, 0.0015, 1e-9);
    const SearchResult other = HybridAStar(slot(2.5, 0.05), options()).run({4, -3, 0}, parked);
    CHECK(other.outcome == Outcome::start_blocked && other.contact.clearance < 0.0);
}

TEST(a_wall_across_the_road_is_a_proof) {
    const CollisionChecker checker(car(), rectangle(-5, 20, -4, 4), {rectangle(8, 9, -4, 4)}, 0.05);
    const SearchResult result = HybridAStar(checker, options()).run({0, 0, 0}, {12, 0, 0});
    CHECK(result.outcome == Outcome::disconnected);
    CHECK(result.expansions == 0);
}

TEST(a_room_without_exit_for_the_body_is_exhausted) {
    const double gap = 1.96;  // lets the disc of radius 0.929 pass but not the car
    const CollisionChecker checker(car(), rectangle(-5, 20, -4, 4),
                                   {rectangle(8, 9, -4, -gap / 2), rectangle(8, 9, gap / 2, 4)}, 0.0);
    const SearchResult result = HybridAStar(checker, options()).run({0, 0, 0}, {12, 0, 0});
    CHECK(result.outcome == Outcome::exhausted);
    CHECK(result.expansions > 100);
}

TEST(limits_end_a_search) {
    const CollisionChecker checker = slot(2.5, 0.05);
    SearchOptions o = options();
    o.max_words = 0;
    o.max_expansions = 50;
    CHECK(HybridAStar(checker, o).run(road, parked).outcome == Outcome::expansion_limit);
    o.max_expansions = 1000000;
    o.time_limit = 1e-4;
    CHECK(HybridAStar(checker, o).run(road, parked).outcome == Outcome::time_limit);
    o.time_limit = 10.0;
    int asked = 0;
    const SearchResult result = HybridAStar(checker, o).run(road, parked, [&] { return ++asked == 3; });
    CHECK(result.outcome == Outcome::interrupted && asked == 3);
}

TEST(start_at_goal_is_an_empty_path) {
    const SearchResult result = HybridAStar(slot(2.5, 0.05), options()).run(road, road);
    CHECK(result.outcome == Outcome::found && result.arcs.empty());
    CHECK_CLOSE(result.cost, 0.0, 1e-9);
}

TEST(without_obstacles_the_path_is_no_longer_than_the_cheapest_word_and_keeps_its_gear_count) {
    const CollisionChecker checker(car(), rectangle(-40, 40, -40, 40), {}, 0.05);
    const SearchOptions o = options();
    for (const Pose goal : {Pose{12, 5, 1}, Pose{-9, 3, -2}, Pose{2, 2, 3}, Pose{0.5, 3, 0}}) {
        const SearchResult result = HybridAStar(checker, o).run(road, goal);
        double cheapest = HUGE_VAL;
        for (const Word& word : reeds_shepp::all(road, goal, 1.0 / o.full_curvature))
            cheapest = std::min(cheapest, o.cost.word(word, 1.0 / o.full_curvature, {}, 1));
        CHECK(result.outcome == Outcome::found && result.cost <= cheapest + 1e-9);
    }
}

TEST(the_grid_never_overrates_the_way) {
    const CollisionChecker checker = slot(2.5, 0.05);
    DistanceGrid grid(checker, {0, 0}, 0.3);
    for (double x = -1; x < 14; x += 0.7) CHECK(grid.lower_bound({x, 3.0}) <= std::hypot(x, 3.0) + 1e-9);
    const SearchResult result = HybridAStar(checker, options()).run(road, parked);
    double length = 0.0;
    for (const Arc& arc : result.arcs) length += std::abs(arc.length);
    CHECK(grid.lower_bound({parked.x, parked.y}) <= length);
}

TEST(distances_do_not_depend_on_what_was_asked_before) {
    std::vector<Polygon> obstacles;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(3.0, 57.0);
    for (int i = 0; i < 150; ++i) {
        const double x = place(random), y = place(random);
        obstacles.push_back(rectangle(x, x + 1.2, y, y + 0.8));
    }
    const CollisionChecker checker(car(), rectangle(0, 60, 0, 60), obstacles, 0.05);
    DistanceGrid asked_once(checker, {1.5, 1.5}, 0.3);
    DistanceGrid outward(checker, {1.5, 1.5}, 0.3);
    int reached = 0, blocked = 0;
    for (double x = 1.0; x < 60; x += 1.7)
        for (double y = 1.0; y < 60; y += 1.3) {
            const double way = outward.lower_bound({x, y});
            DistanceGrid anew(checker, {1.5, 1.5}, 0.3);
            CHECK(anew.lower_bound({x, y}) == way && asked_once.lower_bound({x, y}) == way);
            // A disc that stands clear of everything is in no blocked cell; one that is deep in an obstacle is.
            double room = HUGE_VAL;
            for (const Polygon& obstacle : obstacles) room = std::min(room, point_distance(obstacle, {x, y}));
            (std::isfinite(way) ? reached : blocked) += 1;
            if (room == 0.0) CHECK(!std::isfinite(way));
            if (std::isfinite(way)) CHECK(room > 0.0 && way + 1.0 >= 0.95 * std::hypot(x - 1.5, y - 1.5));
        }
    CHECK(reached > 300 && blocked > 100);
}

TEST(a_rear_axle_beside_the_body_may_pass_over_obstacles) {
    const Footprint crane({rectangle(2.0, 5.0, -1.0, 1.0)});
    CHECK(crane.inscribed < 0.0);
    const CollisionChecker checker(crane, rectangle(-10, 20, -10, 10), {rectangle(-0.5, 0.5, -10, 10)}, 0.05);
    const SearchResult result = HybridAStar(checker, options()).run({0, 0, 0}, {8, 3, 0.5});
    CHECK(result.outcome == Outcome::found);
    check_path(checker, {0, 0, 0}, {8, 3, 0.5}, result.arcs);
}

TEST(the_closed_set_survives_growing) {
    ClosedSet set(4);
    for (int i = 0; i < 50000; ++i) set.set(static_cast<std::uint64_t>(i) * 7919U + 1U, i);
    bool all_there = true;
    for (int i = 0; i < 50000; ++i) all_there = all_there && set.find(static_cast<std::uint64_t>(i) * 7919U + 1U) == i;
    CHECK(all_there && set.find(2) == ClosedSet::absent);
}
