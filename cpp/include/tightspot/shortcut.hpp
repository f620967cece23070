// Cutting corners: stretches of a path replaced by cheaper Reeds-Shepp curves that are free of collisions.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tightspot/collision.hpp"
#include "tightspot/motion_cost.hpp"
#include "tightspot/reeds_shepp.hpp"

namespace tightspot {

class Shortcutter {
public:
    Shortcutter(const CollisionChecker& checker, const MotionCost& cost) : checker_(checker), cost_(cost) {}

    /// A path from the same start to the same end that costs no more.
    std::vector<Arc> improve(const Pose& start, std::vector<Arc> arcs) const {
        for (int round = 0; round < most_rounds; ++round) {
            if (!improve_once(start, arcs)) break;
        }
        return arcs;
    }

private:
    struct Candidate {
        double cost;
        std::vector<Arc> arcs;
        Pose from;
        std::size_t first, count;  ///< the arcs that are new
    };

    bool improve_once(const Pose& start, std::vector<Arc>& arcs) const {
        const std::vector<Arc> pieces = split(arcs);
        std::vector<Pose> knots{start};
        for (const Arc& piece : pieces) knots.push_back(advance(knots.back(), piece));
        const double now = cost_.path(merged(pieces));
        std::vector<Candidate> candidates = cheaper(pieces, knots, now);
        std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
        for (const Candidate& candidate : candidates) {
            if (!is_free(candidate)) continue;
            arcs = merged(candidate.arcs);
            return true;
        }
        return false;
    }

    std::vector<Arc> split(const std::vector<Arc>& arcs) const {
        double total = 0.0;
        for (const Arc& arc : arcs) total += std::abs(arc.length);
        const double longest = std::max(0.5, total / most_pieces);
        std::vector<Arc> pieces;
        for (const Arc& arc : arcs) {
            const int count = std::max(1, static_cast<int>(std::ceil(std::abs(arc.length) / longest - 1e-9)));
            for (int i = 0; i < count; ++i) pieces.push_back({arc.length / count, arc.curvature});
        }
        return pieces;
    }

    std::vector<Candidate> cheaper(const std::vector<Arc>& pieces, const std::vector<Pose>& knots, double now) const {
        const double radius = 1.0 / cost_.full_curvature;
        std::vector<Candidate> found;
        std::vector<Arc> stretch, trial;
        for (std::size_t i = 0; i + 2 < knots.size(); ++i) {
            for (std::size_t j = i + 2; j < knots.size(); ++j) {
                stretch.assign(pieces.begin() + static_cast<std::ptrdiff_t>(i), pieces.begin() + static_cast<std::ptrdiff_t>(j));
                const double gap = std::hypot(knots[j].x - knots[i].x, knots[j].y - knots[i].y);
                if (cost_.path(stretch) + 2.0 * cost_.gear_change + 2.0 * cost_.steering_change <= gap + least_gain) continue;
                reeds_shepp::for_each_word(relative(knots[i], knots[j]), radius, [&](const Word& raw) {
                    if (raw.length() * radius >= now) return;
                    const Word word = reeds_shepp::without_negligible(raw);
                    trial.assign(pieces.begin(), pieces.begin() + static_cast<std::ptrdiff_t>(i));
                    for (int k = 0; k < word.size; ++k) trial.push_back(word.arc(k, radius));
                    trial.insert(trial.end(), pieces.begin() + static_cast<std::ptrdiff_t>(j), pieces.end());
                    const double cost = cost_.path(trial);
                    if (cost < now - least_gain) found.push_back({cost, trial, knots[i], i, static_cast<std::size_t>(word.size)});
                });
            }
        }
        return found;
    }

    bool is_free(const Candidate& candidate) const {
        Pose pose = candidate.from;
        double slack = checker_.slack(pose);
        for (std::size_t k = 0; k < candidate.count; ++k) {
            const Arc arc = candidate.arcs[candidate.first + k];
            if (!checker_.arc_is_free(pose, arc, slack, slack)) return false;
            pose = advance(pose, arc);
        }
        return true;
    }

    static constexpr int most_rounds = 20;
    static constexpr double most_pieces = 36.0;
    static constexpr double least_gain = 0.05;

    const CollisionChecker& checker_;
    MotionCost cost_;
};

}  // namespace tightspot
