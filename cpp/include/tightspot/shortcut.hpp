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
    Shortcutter(const CollisionChecker& checker, const MotionCost& cost)
        : checker_(checker), cost_(cost), radius_(1.0 / cost.full_curvature) {}

    /// A path from the same start to the same end that costs no more.
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
        for (const Arc& piece : pieces_) {
            costs_.push_back(costs_.back() + cost_.step(motions_.back(), piece));
            knots_.push_back(advance(knots_.back(), piece));
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
        const double gap = std::hypot(knots_[j].x - knots_[i].x, knots_[j].y - knots_[i].y);
        if (old_cost - gap < least_gain) return;
        reeds_shepp::for_each_word(relative(knots_[i], knots_[j]), radius_, [&](const Word& word) {
            if (word.length() * radius_ > old_cost - least_gain) return;
            const double gain = old_cost - cost_of(word, i, j);
            if (gain >= least_gain) candidates_.push_back({gain, i, j, word});
        });
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

    bool is_free(const Candidate& candidate) const {
        Pose pose = knots_[candidate.first];
        double slack = checker_.slack(pose);
        for (int k = 0; k < candidate.word.size; ++k) {
            const Arc arc = candidate.word.arc(k, radius_);
            if (!checker_.arc_is_free(pose, arc, slack, slack)) return false;
            pose = advance(pose, arc);
        }
        return true;
    }

    std::vector<Arc> replaced(const Candidate& candidate) const {
        std::vector<Arc> arcs(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(candidate.first));
        const Word word = reeds_shepp::without_negligible(candidate.word);
        for (int k = 0; k < word.size; ++k) arcs.push_back(word.arc(k, radius_));
        arcs.insert(arcs.end(), pieces_.begin() + static_cast<std::ptrdiff_t>(candidate.last), pieces_.end());
        return arcs;
    }

    static constexpr int most_rounds = 20;
    static constexpr double most_pieces = 36.0;
    static constexpr double least_gain = 0.05;

    const CollisionChecker& checker_;
    MotionCost cost_;
    double radius_;
    std::vector<Arc> pieces_;
    std::vector<Pose> knots_;
    std::vector<Motion> motions_;
    std::vector<double> costs_;
    std::vector<Candidate> candidates_;
};

}  // namespace tightspot
