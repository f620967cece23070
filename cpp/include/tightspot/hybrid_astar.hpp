// Hybrid A*: a search over poses joined by circular arcs, finished by Reeds-Shepp curves.
//
// D. Dolgov, S. Thrun, M. Montemerlo, J. Diebel: Path planning for autonomous vehicles in unknown semi-structured
// environments, International Journal of Robotics Research 29(5), 2010. Here the footprint is exact, the search may
// run from the goal outwards, arcs are checked for collisions only when their turn comes (B. Cohen, M. Phillips,
// M. Likhachev: Planning single-arm manipulations with n-arm robots, RSS 2014), and all Reeds-Shepp words are tried,
// cheapest first.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "tightspot/closed_set.hpp"
#include "tightspot/collision.hpp"
#include "tightspot/distance_grid.hpp"
#include "tightspot/motion_cost.hpp"
#include "tightspot/open_queue.hpp"
#include "tightspot/search_options.hpp"

namespace tightspot {

class HybridAStar {
public:
    HybridAStar(const CollisionChecker& checker, const SearchOptions& options)
        : checker_(checker),
          options_(options),
          radius_(1.0 / options.full_curvature),
          time_(options.backward ? -1 : 1),
          gears_(options.backward ? options.gears.reversed() : options.gears),
          closed_(1024),
          weight_(options.heuristic_weight),
          next_growth_(options.patience),
          expansion_limit_(options.max_expansions) {
        cells_.origin = Box(checker.workspace().vertices).low;
        cells_.size = options.cell;
        cells_.heading_bins = options.heading_bins;
        for (const double length : {options.step, -options.step, 2.0 * options.step, -2.0 * options.step})
            for (const double part : options.steering) add_move({length, options.full_curvature * part});
    }

    SearchResult run(const Pose& start, const Pose& goal, const Interrupt& interrupt = {}) {
        began_ = Clock::now();
        const std::int64_t pose_checks = checker_.pose_checks(), pair_tests = checker_.pair_tests();
        result_ = {};
        if (!is_blocked(start, Outcome::start_blocked) && !is_blocked(goal, Outcome::goal_blocked)) {
            target_ = options_.backward ? start : goal;
            result_.outcome = search(options_.backward ? goal : start, interrupt);
            if (explores_ && result_.outcome != Outcome::interrupted) result_.outcome = Outcome::disconnected;
            if (best_node_ >= 0) result_.arcs = path();
            result_.cost = best_cost_;
        }
        result_.nodes = static_cast<std::int64_t>(nodes_.size());
        result_.pose_checks = checker_.pose_checks() - pose_checks;
        result_.pair_tests = checker_.pair_tests() - pair_tests;
        result_.seconds = seconds();
        return std::move(result_);
    }

private:
    using Clock = std::chrono::steady_clock;

    /// An arc with its chord. Its twin is the arc with the opposite chord, if that is an earlier move, or itself.
    struct Move {
        Arc arc;
        Chord chord;
        std::size_t twin = 0;

        Move halved() const {
            const Arc half{0.5 * arc.length, arc.curvature};
            return {half, Chord(half)};
        }
    };

    void add_move(Arc arc) {
        const Chord chord(arc);
        std::size_t twin = 0;
        while (twin < moves_.size() && (moves_[twin].chord.length != -chord.length ||
                                        moves_[twin].chord.half_turn != chord.half_turn))
            ++twin;
        moves_.push_back({arc, chord, twin});
        shifts_.emplace_back();
    }

    /// A pose that the vehicle can get to.
    struct Node {
        Pose pose;
        Arc arc;  ///< that leads here, in the search's direction
        double cost = 0.0;
        double estimate = 0.0;  ///< of the cost left
        double slack = 0.0;
        std::uint64_t cell = 0;
        int parent = -1;
        int gear = 0;  ///< in which the vehicle drives the arc

        Motion motion() const { return {gear, arc.curvature}; }
    };

    struct PricedWord {
        double cost;
        Word word;
    };

    bool is_blocked(const Pose& pose, Outcome outcome) {
        if (checker_.is_free(pose)) return false;
        result_.outcome = outcome;
        result_.contact = checker_.contact(pose);
        return true;
    }

    double seconds() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

    Outcome search(const Pose& root, const Interrupt& interrupt) {
        Node first;
        first.pose = root;
        first.slack = checker_.slack(root);
        first.cell = cells_.key(root, 0, false);
        open_.push({0.0, arrive(first), OpenEntry::no_move});
        if (is_good_enough(nodes_.front().estimate)) return Outcome::found;
        DistanceGrid grid(checker_, {target_.x, target_.y},
                          std::max(options_.cell, 0.12 * checker_.footprint().narrowest));
        if (!grid.is_connected({root.x, root.y})) {
            if (!options_.keep_closed) return Outcome::disconnected;
            explores_ = true;
        }
        for (std::int64_t looked_at = 1; !open_.is_empty(); ++looked_at) {
            if (looked_at % 128 == 0) {
                if (interrupt && interrupt()) return Outcome::interrupted;
                if (seconds() > options_.time_limit) return found_or(Outcome::time_limit);
            }
            const OpenEntry entry = open_.pop();
            if (is_good_enough(entry.total)) return Outcome::found;
            const int index = entry.is_move() ? follow(entry) : entry.node;
            if (index < 0 || closed_.find(nodes_[index].cell) != index) continue;
            const double total = nodes_[index].cost + weight_ * nodes_[index].estimate;
            if (entry.is_move() && !open_.is_empty() && total > open_.least_total()) {
                open_.push({total, index, OpenEntry::no_move});
                continue;
            }
            if (result_.expansions >= expansion_limit_) return found_or(Outcome::expansion_limit);
            if (best_node_ < 0 && result_.expansions >= next_growth_) hurry();
            expand(index, grid);
        }
        return found_or(Outcome::exhausted);
    }

    Outcome found_or(Outcome otherwise) const { return best_node_ >= 0 ? Outcome::found : otherwise; }

    /// Whether the path found costs hardly more than the least that any other can, `bound`.
    bool is_good_enough(double bound) const { return !is_better(bound); }

    /// Whether a cost is lower than that of the path found by more than the tolerance.
    bool is_better(double cost) const { return cost * (1.0 + options_.tolerance) < best_cost_; }

    /// The node that a move leads to; -1 if something is in the way or its cell is known to be reached more cheaply.
    int follow(const OpenEntry& entry) {
        const Node& from = nodes_[entry.node];
        Move move = moves_[entry.move];
        for (int halved = 0; halved <= options_.halvings; ++halved, move = move.halved()) {
            std::optional<Node> node = after(from, move, move.chord.shift(from.pose.theta), halved > 0);
            if (!node) return -1;
            if (!checker_.arc_is_free(from.pose, node->arc, from.slack, node->slack)) continue;
            node->parent = entry.node;
            if (halved == 0) node->estimate = (entry.total - node->cost) / weight_;
            return arrive(*node);
        }
        return -1;
    }

    /// The node at a move's end, unchecked; none if its cell is reached as cheaply. `shift`: its chord, as it lies there.
    std::optional<Node> after(const Node& from, const Move& move, Point shift, bool is_halved) const {
        const Arc driven{time_ * move.arc.length, move.arc.curvature};
        Node node;
        node.pose = move.chord.end(from.pose, shift);
        node.arc = move.arc;
        node.gear = MotionCost::gear(driven);
        node.cost = from.cost + options_.cost.step(from.motion(), driven);
        node.cell = cells_.key(node.pose, node.gear, is_halved);
        const int known = closed_.find(node.cell);
        if (known != ClosedSet::absent && nodes_[known].cost <= node.cost + 1e-9) return std::nullopt;
        return node;
    }

    /// Keeps a node, raises its estimate to the cheapest word's cost, and tries to get from it to the target.
    int arrive(const Node& found) {
        const int index = static_cast<int>(nodes_.size());
        nodes_.push_back(found);
        closed_.set(found.cell, index);
        Node& node = nodes_.back();
        words_.clear();
        double cheapest = HUGE_VAL;
        reeds_shepp::for_each_word(relative(node.pose, target_), radius_, [&](const Word& word) {
            const double way = word.length() * radius_;
            if (way >= cheapest && !is_better(node.cost + way)) return;
            const double cost = options_.cost.word(word, radius_, node.motion(), time_);
            cheapest = std::min(cheapest, cost);
            if (is_better(node.cost + cost) && keeps_gears(node, word)) words_.push_back({node.cost + cost, word});
        });
        node.estimate = std::max(node.estimate, cheapest);
        if (should_connect(node.estimate)) connect(index);
        return index;
    }

    /// Whether a path that ends with the word begins and ends in the demanded gears.
    bool keeps_gears(const Node& node, const Word& word) const {
        if (gears_.is_free()) return true;
        const EndGears ends = EndGears::of(word, time_);
        const int last = ends.last != 0 ? ends.last : node.gear;
        return (node.parent >= 0 || gears_.first == 0 || ends.first == gears_.first) &&
               (gears_.last == 0 || last == gears_.last);
    }

    void expand(int index, DistanceGrid& grid) {
        const Node from = nodes_[index];
        ++result_.expansions;
        if (options_.keep_closed) result_.closed.push_back(from.pose);
        const std::size_t half = moves_.size() / 2;
        const std::size_t first = from.slack > open_space * checker_.horizon() ? half : 0;
        for (std::size_t i = first; i < first + half; ++i) {
            const Move& move = moves_[i];
            const Point opposite = shifts_[move.twin];
            shifts_[i] = move.twin < i ? Point{-opposite.x, -opposite.y} : move.chord.shift(from.pose.theta);
            const std::optional<Node> node = after(from, move, shifts_[i], false);
            if (!node) continue;
            if (from.parent < 0 && gears_.first != 0 && node->gear != gears_.first) continue;
            const double way = explores_ ? 0.0 : grid.lower_bound({node->pose.x, node->pose.y});
            if (!std::isfinite(way)) continue;
            const double left = std::max(way, from.estimate - (node->cost - from.cost));
            if (is_better(node->cost + left)) open_.push({node->cost + weight_ * left, index, static_cast<int>(i)});
        }
    }

    /// Makes the estimate of the cost left count more, in the queue, too: from now on, any path soon is better.
    void hurry() {
        next_growth_ = weight_ * growth < most_weight ? 2 * next_growth_ : options_.max_expansions;
        weight_ *= growth;
        open_.revalue([this](const OpenEntry& entry) {
            const Node& node = nodes_[entry.node];
            double cost = node.cost;
            if (entry.is_move()) {
                const Arc move = moves_[entry.move].arc;
                cost += options_.cost.step(node.motion(), {time_ * move.length, move.curvature});
            }
            return cost + growth * (entry.total - cost);
        });
    }

    /// Curves to the target are tried at every promising node and, far away, only now and then.
    bool should_connect(double left) {
        const bool is_nearest = left < nearest_left_;
        const auto arrivals = static_cast<std::int64_t>(nodes_.size());
        if (!is_nearest && arrivals < next_connection_) return false;
        nearest_left_ = std::min(nearest_left_, left);
        next_connection_ = arrivals + 1 + static_cast<std::int64_t>(left / (2.0 * radius_));
        return true;
    }

    /// Tries the cheapest of `words_` from a node to the target.
    void connect(int index) {
        const std::size_t tried = std::min(words_.size(), static_cast<std::size_t>(options_.max_words));
        std::partial_sort(words_.begin(), words_.begin() + static_cast<std::ptrdiff_t>(tried), words_.end(),
                          [](const PricedWord& a, const PricedWord& b) { return a.cost < b.cost; });
        for (std::size_t i = 0; i < tried; ++i) {
            if (!word_is_free(nodes_[index], words_[i].word)) continue;
            if (best_node_ < 0) {
                const std::int64_t extra = std::max<std::int64_t>(options_.extra_expansions, result_.expansions / 2);
                expansion_limit_ = std::min<std::int64_t>(options_.max_expansions, result_.expansions + extra);
            }
            best_node_ = index;
            best_cost_ = words_[i].cost;
            best_word_ = words_[i].word;
            return;
        }
    }

    bool word_is_free(const Node& node, const Word& word) {
        arcs_.clear();
        for (int i = 0; i < word.size; ++i) arcs_.push_back(word.arc(i, radius_));
        return checker_.arcs_are_free(node.pose, arcs_, node.slack);
    }

    std::vector<Arc> path() const {
        std::vector<Arc> arcs;
        for (int i = best_node_; nodes_[i].parent >= 0; i = nodes_[i].parent) arcs.push_back(nodes_[i].arc);
        std::reverse(arcs.begin(), arcs.end());
        const Word word = reeds_shepp::without_negligible(best_word_);
        for (int i = 0; i < word.size; ++i) arcs.push_back(word.arc(i, radius_));
        return merged(options_.backward ? reversed(arcs) : arcs);
    }

    /// Beyond this part of the largest slack, arcs are twice as long.
    static constexpr double open_space = 0.65;
    static constexpr double growth = 1.5;
    static constexpr double most_weight = 3.5;

    const CollisionChecker& checker_;
    SearchOptions options_;
    double radius_;
    int time_;        ///< -1 if the search runs against the vehicle's motion
    EndGears gears_;  ///< in the search's order
    std::vector<Move> moves_;    ///< the second half is twice as long
    std::vector<Point> shifts_;  ///< of the moves from a pose that is expanded
    PoseCells cells_;
    Pose target_;
    Clock::time_point began_;
    SearchResult result_;
    std::vector<Node> nodes_;
    OpenQueue open_;
    ClosedSet closed_;
    double weight_;
    std::int64_t next_growth_;  ///< expansions after which the weight grows
    std::int64_t expansion_limit_;
    bool explores_ = false;  ///< there is no way to the target: only look what can be reached
    std::vector<PricedWord> words_;
    std::vector<Arc> arcs_;
    std::int64_t next_connection_ = 0;
    double nearest_left_ = HUGE_VAL;
    int best_node_ = -1;
    double best_cost_ = HUGE_VAL;
    Word best_word_;
};

}  // namespace tightspot
