// What hybrid A* is asked for and what it answers.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tightspot/collision.hpp"
#include "tightspot/motion_cost.hpp"

namespace tightspot {

struct SearchOptions {
    double cell = 0.4;            ///< side of a position cell, m
    int heading_bins = 72;        ///< heading cells of a full turn
    double step = 0.6;            ///< length of an arc, m
    int halvings = 0;             ///< so often an arc that is blocked is tried again at half its length
    std::vector<double> steering{-1.0, -0.5, 0.0, 0.5, 1.0};  ///< curvatures tried, parts of the full one
    double full_curvature = 0.2;  ///< largest curvature used, 1/m
    MotionCost cost;
    double heuristic_weight = 1.0;
    int patience = 500;           ///< without a path after that many expansions, the weight begins to grow
    double tolerance = 0.02;      ///< a path is good enough if none can be cheaper by more than this part
    bool backward = true;         ///< from the goal outwards
    EndGears gears;               ///< in which the vehicle must set out and arrive
    int max_words = 10;           ///< Reeds-Shepp words tried at a node
    int extra_expansions = 300;   ///< go on after the first path for that many, or half of those it took
    int max_expansions = 100000;
    double time_limit = 10.0;  ///< s
    bool keep_closed = false;  ///< also return the poses expanded; if disconnected, all that can be reached
};

/// `disconnected`: not even the body's inscribed disc gets from one end to the other, so there is no path at all.
enum class Outcome {
    found,
    exhausted,
    disconnected,
    expansion_limit,
    time_limit,
    start_blocked,
    goal_blocked,
    interrupted
};

struct SearchResult {
    Outcome outcome = Outcome::exhausted;
    std::vector<Arc> arcs;  ///< from start to goal
    double cost = 0.0;
    std::int64_t expansions = 0;
    std::int64_t nodes = 0;
    std::int64_t pose_checks = 0;
    std::int64_t pair_tests = 0;
    double seconds = 0.0;
    Contact contact;  ///< what blocks the start or the goal
    std::vector<Pose> closed;
};

/// Asked now and then; true stops the search.
using Interrupt = std::function<bool()>;

}  // namespace tightspot
