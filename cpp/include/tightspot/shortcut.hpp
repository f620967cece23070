// Cutting corners: stretches of a path replaced by cheaper Reeds-Shepp curves that are free of collisions.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tightspot/collision.hpp"
#include "tightspot/motion_cost.hpp"
#include "tightspot/reeds_shepp.hpp"

namespace tightspot {

class Shortcutter {
public:
    Shortcutter(const CollisionChecker& checker, const MotionCost& cost, EndGears gears = {})
        : checker_(checker), cost_(cost), gears_(gears), radius_(1.0 / cost.full_curvature) {}

    /// A path from the same start to the same end, in the same gears if they are demanded, that costs no more.
    std::vector<Arc> improve(const Pose& start, std::vector<Arc> arcs) {
        for (int round = 0; round < most_rounds; ++round) {
            cut(start, arcs);
            if (!improve_once(arcs)) break;
        }
        return arcs;
    }

private:
    /// A word in place of the pieces from `first` up to, not including, `last`.
    struct Candidate {
        double gain;
        std::size_t first, last;
        Word word;
    };

    /// Cuts the path into pieces, with the pose and motion before each and the cost up to it.
    void cut(const Pose& start, const std::vector<Arc>& arcs) {
        double total = 0.0;
        for (const Arc& arc : arcs) total += std::abs(arc.length);
        const double longest = std::max(0.25 * checker_.footprint().narrowest, total / most_pieces);
        pieces_.clear();
        for (const Arc& arc : arcs) {
            const int count = std::max(1, static_cast<int>(std::ceil(std::abs(arc.length) / longest - 1e-9)));
            for (int i = 0; i < count; ++i) pieces_.push_back({arc.length / count, arc.curvature});
        }
        knots_.assign(1, start);
        motions_.assign(1, {});
        costs_.assign(1, 0.0);
        slacks_.assign(1, checker_.slack(start));
        for (const Arc& piece : pieces_) {
            costs_.push_back(costs_.back() + cost_.step(motions_.back(), piece));
            knots_.push_back(advance(knots_.back(), piece));
            slacks_.push_back(checker_.slack(knots_.back()));
            motions_.push_back({MotionCost::gear(piece), piece.curvature});
        }
    }

    bool improve_once(std::vector<Arc>& arcs) {
        candidates_.clear();
        for (std::size_t i = 0; i + 1 < knots_.size(); ++i)
            for (std::size_t j = i + 1; j < knots_.size(); ++j) collect(i, j);
        std::stable_sort(candidates_.begin(), candidates_.end(),
                         [](const Candidate& a, const Candidate& b) { return a.gain > b.gain; });
        for (const Candidate& candidate : candidates_) {
            if (!is_free(candidate)) continue;
            arcs = merged(replaced(candidate));
            return true;
        }
        return false;
    }

    void collect(std::size_t i, std::size_t j) {
        const double old_cost = costs_[j] - costs_[i] + cost_after(motions_[j], j);
        if (old_cost - least_cost(i, j) < least_gain) return;
        const double most = old_cost - cost_after(motions_[i], j) - least_gain;
        reeds_shepp::for_each_word(relative(knots_[i], knots_[j]), radius_, [&](const Word& word) {
            if (word.length() * radius_ > most) return;
            const double gain = old_cost - cost_of(word, i, j);
            if (gain >= least_gain && keeps_gears(word, i, j)) candidates_.push_back({gain, i, j, word});
        });
    }

    /// No curve between the knots costs less: it has to cover the gap, to turn, and to fit to what follows.
    double least_cost(std::size_t i, std::size_t j) const {
        const double gap = std::hypot(knots_[j].x - knots_[i].x, knots_[j].y - knots_[i].y);
        const double turn = radius_ * std::abs(wrap_angle(knots_[j].theta - knots_[i].theta));
        return std::max(gap, turn) + cost_.steering * turn + cost_after(motions_[i], j);
    }

    bool keeps_gears(const Word& word, std::size_t i, std::size_t j) const {
        if (gears_.is_free()) return true;
        const EndGears ends = EndGears::of(word, 1);
        const bool begins = i > 0 || gears_.first == 0 || ends.first == gears_.first;
        return begins && (j < pieces_.size() || gears_.last == 0 || ends.last == gears_.last);
    }

    double cost_of(const Word& word, std::size_t i, std::size_t j) const {
        double sum = 0.0;
        Motion motion = motions_[i];
        for (int k = 0; k < word.size; ++k) {
            if (std::abs(word.lengths[k]) <= reeds_shepp::negligible) continue;
            const Arc arc = word.arc(k, radius_);
            sum += cost_.step(motion, arc);
            motion = {MotionCost::gear(arc), arc.curvature};
        }
        return sum + cost_after(motion, j);
    }

    /// What follows knot `j` at the price that depends on the motion before it: the next piece, or the stop.
    double cost_after(const Motion& motion, std::size_t j) const {
        return j < pieces_.size() ? cost_.step(motion, pieces_[j]) : cost_.stop(motion);
    }

    bool is_free(const Candidate& candidate) {
        arcs_.clear();
        for (int k = 0; k < candidate.word.size; ++k) arcs_.push_back(candidate.word.arc(k, radius_));
        return checker_.arcs_are_free(knots_[candidate.first], arcs_, slacks_[candidate.first]);
    }

    std::vector<Arc> replaced(const Candidate& candidate) const {
        std::vector<Arc> arcs(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(candidate.first));
        const Word word = reeds_shepp::without_negligible(candidate.word);
        for (int k = 0; k < word.size; ++k) arcs.push_back(word.arc(k, radius_));
        arcs.insert(arcs.end(), pieces_.begin() + static_cast<std::ptrdiff_t>(candidate.last), pieces_.end());
        return arcs;
    }

    static constexpr int most_rounds = 20;
    static constexpr double most_pieces = 24.0;
    static constexpr double least_gain = 0.05;

    const CollisionChecker& checker_;
    MotionCost cost_;
    EndGears gears_;
    double radius_;
    std::vector<Arc> pieces_;
    std::vector<Pose> knots_;
    std::vector<Motion> motions_;
    std::vector<double> costs_;
    std::vector<double> slacks_;
    std::vector<Arc> arcs_;
    std::vector<Candidate> candidates_;
};

}  // namespace tightspot
