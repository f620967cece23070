// Hybrid A*: a search over poses joined by circular arcs, finished by Reeds-Shepp curves.
//
// D. Dolgov, S. Thrun, M. Montemerlo, J. Diebel: Path planning for autonomous vehicles in unknown semi-structured
// environments, International Journal of Robotics Research 29(5), 2010. Here the footprint is exact, the search may
// run from the goal outwards, and all Reeds-Shepp words are tried, cheapest first.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "tightspot/closed_set.hpp"
#include "tightspot/collision.hpp"
#include "tightspot/distance_grid.hpp"
#include "tightspot/motion_cost.hpp"

namespace tightspot {

struct SearchOptions {
    double cell = 0.4;            ///< side of a position cell, m
    int heading_bins = 72;        ///< heading cells of a full turn
    double step = 0.6;            ///< length of an arc, m
    int steering_levels = 5;      ///< curvatures from full left to full right, odd
    double full_curvature = 0.2;  ///< largest curvature used, 1/m
    MotionCost cost;
    double heuristic_weight = 1.0;
    bool backward = true;         ///< from the goal outwards
    int max_words = 10;           ///< Reeds-Shepp words tried at a node
    int extra_expansions = 1000;  ///< go on after the first path for that many, or half of those it took
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

class HybridAStar {
public:
    HybridAStar(const CollisionChecker& checker, const SearchOptions& options)
        : checker_(checker),
          options_(options),
          radius_(1.0 / options.full_curvature),
          time_(options.backward ? -1 : 1),
          closed_(expected_nodes) {
        const int levels = std::max(3, options.steering_levels | 1);
        for (int i = 0; i < levels; ++i) curvatures_.push_back(options.full_curvature * (2.0 * i / (levels - 1) - 1.0));
        cells_.origin = Box(checker.workspace().vertices).low;
        cells_.size = options.cell;
        cells_.heading_bins = options.heading_bins;
        nodes_.reserve(expected_nodes);
        open_.reserve(2 * expected_nodes);
        words_.reserve(64);
    }

    SearchResult run(const Pose& start, const Pose& goal, const Interrupt& interrupt = {}) {
        const Clock::time_point began = Clock::now();
        const std::int64_t pose_checks = checker_.pose_checks(), pair_tests = checker_.pair_tests();
        SearchResult result;
        if (!is_blocked(start, Outcome::start_blocked, result) && !is_blocked(goal, Outcome::goal_blocked, result)) {
            const Pose& root = options_.backward ? goal : start;
            target_ = options_.backward ? start : goal;
            DistanceGrid grid(checker_, {target_.x, target_.y},
                              std::max(options_.cell, 0.12 * checker_.footprint().narrowest));
            explores_ = options_.keep_closed && !grid.is_connected({root.x, root.y});
            result.outcome = search(root, grid, began, interrupt, result);
            if (explores_ && result.outcome != Outcome::interrupted) result.outcome = Outcome::disconnected;
            if (best_node_ >= 0) result.arcs = path();
            result.cost = best_cost_;
        }
        result.nodes = static_cast<std::int64_t>(nodes_.size());
        result.pose_checks = checker_.pose_checks() - pose_checks;
        result.pair_tests = checker_.pair_tests() - pair_tests;
        result.seconds = std::chrono::duration<double>(Clock::now() - began).count();
        return result;
    }

private:
    using Clock = std::chrono::steady_clock;

    struct Node {
        Pose pose;
        Arc arc;  ///< that leads here, in the search's direction
        double cost = 0.0;
        double estimate = 0.0;  ///< of the cost left
        double slack = 0.0;
        std::uint64_t cell = 0;
        int parent = -1;
        int gear = 0;  ///< in which the vehicle drives the arc
        bool is_refined = false;

        Motion motion() const { return {gear, arc.curvature}; }
    };

    struct Entry {
        double total;
        int node;
        bool operator>(const Entry& other) const {
            return total > other.total || (total == other.total && node > other.node);
        }
    };

    struct PricedWord {
        double cost;
        Word word;
    };

    bool is_blocked(const Pose& pose, Outcome outcome, SearchResult& result) const {
        if (checker_.is_free(pose)) return false;
        result.outcome = outcome;
        result.contact = checker_.contact(pose);
        return true;
    }

    Outcome search(const Pose& root, DistanceGrid& grid, Clock::time_point began, const Interrupt& interrupt,
                   SearchResult& result) {
        if (!explores_ && !grid.is_connected({root.x, root.y})) return Outcome::disconnected;
        add({root, {}, 0.0, 0.0, checker_.slack(root), cells_.key(root, 0), -1, 0, false}, grid);
        while (!open_.empty()) {
            const Entry entry = pop();
            const int index = entry.node;
            if (closed_.find(nodes_[index].cell) != index) continue;
            if (!nodes_[index].is_refined && refine(index, entry.total)) continue;
            if (entry.total >= best_cost_) return Outcome::found;
            if (result.expansions >= expansion_limit_)
                return best_node_ >= 0 ? Outcome::found : Outcome::expansion_limit;
            if (result.expansions % 128 == 127) {
                if (interrupt && interrupt()) return Outcome::interrupted;
                const std::chrono::duration<double> spent = Clock::now() - began;
                if (spent.count() > options_.time_limit) return best_node_ >= 0 ? Outcome::found : Outcome::time_limit;
            }
            ++result.expansions;
            if (options_.keep_closed) result.closed.push_back(nodes_[index].pose);
            if (should_connect(index, result.expansions)) connect(index, result.expansions);
            expand(index, grid);
        }
        return best_node_ >= 0 ? Outcome::found : Outcome::exhausted;
    }

    void add(const Node& node, DistanceGrid& grid) {
        const double left = explores_ ? 0.0 : grid.lower_bound({node.pose.x, node.pose.y});
        if (!std::isfinite(left)) return;
        const int index = static_cast<int>(nodes_.size());
        nodes_.push_back(node);
        nodes_.back().estimate = left;
        closed_.set(node.cell, index);
        push({node.cost + options_.heuristic_weight * left, index});
    }

    /// Raises the node's estimate by the Reeds-Shepp bound; true if that sends it back into the queue.
    bool refine(int index, double total) {
        Node& node = nodes_[index];
        node.is_refined = true;
        double bound = HUGE_VAL;
        reeds_shepp::for_each_word(relative(node.pose, target_), radius_, [&](const Word& word) {
            bound = std::min(bound, options_.cost.word_without_steering(word, radius_, node.gear, time_));
        });
        node.estimate = std::max(node.estimate, bound);
        const double refined = node.cost + options_.heuristic_weight * node.estimate;
        if (refined <= total + 1e-12) return false;
        push({refined, index});
        return true;
    }

    void expand(int index, DistanceGrid& grid) {
        const Node from = nodes_[index];
        const double length = from.slack > open_space * checker_.horizon() ? 2.0 * options_.step : options_.step;
        for (int sign = 1; sign >= -1; sign -= 2) {
            for (const double curvature : curvatures_) {
                const Arc arc{sign * length, curvature};
                const Arc driven{time_ * arc.length, curvature};
                const int gear = MotionCost::gear(driven);
                const double cost = from.cost + options_.cost.step(from.motion(), driven);
                const Pose pose = advance(from.pose, arc);
                const std::uint64_t cell = cells_.key(pose, gear);
                const int known = closed_.find(cell);
                if (known != ClosedSet::absent && nodes_[known].cost <= cost + 1e-9) continue;
                if (cost >= best_cost_) continue;
                double slack = 0.0;
                if (!checker_.arc_is_free(from.pose, arc, from.slack, slack)) continue;
                add({pose, arc, cost, 0.0, slack, cell, index, gear, false}, grid);
            }
        }
    }

    /// Curves to the target are tried at every promising node and, far away, only now and then.
    bool should_connect(int index, std::int64_t expansions) {
        const double left = nodes_[index].estimate;
        const bool is_nearest = left < nearest_left_;
        if (!is_nearest && expansions < next_connection_) return false;
        nearest_left_ = std::min(nearest_left_, left);
        next_connection_ = expansions + 1 + static_cast<std::int64_t>(left / (2.0 * radius_));
        return true;
    }

    void connect(int index, std::int64_t expansions) {
        const Node& node = nodes_[index];
        words_.clear();
        reeds_shepp::for_each_word(relative(node.pose, target_), radius_, [&](const Word& word) {
            const double cost = node.cost + options_.cost.word(word, radius_, node.motion(), time_);
            if (cost < best_cost_) words_.push_back({cost, word});
        });
        const std::size_t tried = std::min(words_.size(), static_cast<std::size_t>(options_.max_words));
        std::partial_sort(words_.begin(), words_.begin() + static_cast<std::ptrdiff_t>(tried), words_.end(),
                          [](const PricedWord& a, const PricedWord& b) { return a.cost < b.cost; });
        for (std::size_t i = 0; i < tried; ++i) {
            if (!word_is_free(node, words_[i].word)) continue;
            if (best_node_ < 0) {
                const std::int64_t extra = std::max<std::int64_t>(options_.extra_expansions, expansions / 2);
                expansion_limit_ = std::min<std::int64_t>(options_.max_expansions, expansions + extra);
            }
            best_node_ = index;
            best_cost_ = words_[i].cost;
            best_word_ = words_[i].word;
            return;
        }
    }

    bool word_is_free(const Node& node, const Word& word) const {
        Pose pose = node.pose;
        double slack = node.slack;
        for (int i = 0; i < word.size; ++i) {
            const Arc arc = word.arc(i, radius_);
            if (!checker_.arc_is_free(pose, arc, slack, slack)) return false;
            pose = advance(pose, arc);
        }
        return true;
    }

    std::vector<Arc> path() const {
        std::vector<Arc> arcs;
        for (int i = best_node_; nodes_[i].parent >= 0; i = nodes_[i].parent) arcs.push_back(nodes_[i].arc);
        std::reverse(arcs.begin(), arcs.end());
        const Word word = reeds_shepp::without_negligible(best_word_);
        for (int i = 0; i < word.size; ++i) arcs.push_back(word.arc(i, radius_));
        return merged(options_.backward ? reversed(arcs) : arcs);
    }

    void push(Entry entry) {
        open_.push_back(entry);
        std::push_heap(open_.begin(), open_.end(), std::greater<Entry>());
    }

    Entry pop() {
        std::pop_heap(open_.begin(), open_.end(), std::greater<Entry>());
        const Entry entry = open_.back();
        open_.pop_back();
        return entry;
    }

    /// Beyond this part of the largest slack, arcs are twice as long.
    static constexpr double open_space = 0.65;
    /// Memory taken beforehand; only a longer search asks for more.
    static constexpr std::size_t expected_nodes = 1U << 14U;

    const CollisionChecker& checker_;
    SearchOptions options_;
    double radius_;
    int time_;  ///< -1 if the search runs against the vehicle's motion
    std::vector<double> curvatures_;
    PoseCells cells_;
    Pose target_;
    std::vector<Node> nodes_;
    std::vector<Entry> open_;
    ClosedSet closed_;
    std::vector<PricedWord> words_;
    bool explores_ = false;  ///< there is no way to the target: only look what can be reached
    std::int64_t expansion_limit_ = options_.max_expansions;
    std::int64_t next_connection_ = 0;
    double nearest_left_ = HUGE_VAL;
    int best_node_ = -1;
    double best_cost_ = HUGE_VAL;
    Word best_word_;
};

}  // namespace tightspot
