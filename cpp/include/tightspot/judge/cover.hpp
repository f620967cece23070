// Covering the horizon with lines: branch and bound over time, for all (body part, barrier) pairs.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tightspot/judge/barriers.hpp"
#include "tightspot/judge/body.hpp"

namespace tightspot::judge {

/// What to prove and when to stop.
struct Task {
    double demand = 0;            // clearance to prove, m
    double resolution = 1e-3;     // the proved clearance is raised to within this of the smallest one, m, if it is cheap
    double floor = 1e-5;          // shorter intervals are given up, s
    double tolerance = 1e-9;      // a clearance this much below the demand is a witness, m
    double worst = 1e-5;          // the worst clearance of a pair without proof is found to this accuracy, m
    double most_open = 3e5;       // more open intervals mean that bisecting leads nowhere
};

/// An interval of a pair with its line and the clearance that it proves, m.
struct Piece {
    int pair;
    double start, end;
    Point normal;
    double support, proved;
};

/// What has been seen of a pair: its smallest clearance so far, m, when, and whether the demand is proved for all times.
struct Sight {
    double clearance = std::numeric_limits<double>::infinity(), time = 0;
    bool holds = false;
};

struct Cover {
    std::vector<Piece> pieces;  // by pair, then by time
    std::vector<Sight> pairs;   // body parts in order, and for each the barriers in order
};

/// Covers all pairs. First intervals run from knot to knot, from the whole horizon down to single ones; then single
/// intervals are bisected in time. All open ones of a level are looked at before any is closed, because what is seen
/// of one pair decides how much is wanted of the others.
template <class Model, class Barriers>
class Search {
   public:
    using State = typename Motion<Model>::State;

    Search(const Body<Model>& body, const Barriers& barriers, const Task& task)
        : body_(body), motion_(body.motion()), barriers_(barriers), task_(task) {
        cover_.pairs.resize(body.parts.size() * barriers.size());
    }

    Cover run() {
        if (!cover_.pairs.empty()) {
            look_at_knots();
            between_knots();
            bisect();
        }
        return finish();
    }

   private:
    /// An open interval within interval k between knots.
    struct Open {
        int pair, k;
        double start, end;
        State before, after;
        Placement at_start, at_end;
    };

    int part(int pair) const { return pair / barriers_.size(); }

    int barrier(int pair) const { return pair % barriers_.size(); }

    double pad(int pair) const { return body_.parts[part(pair)].pad; }

    Line line(int pair, const Placement& at) {
        place(body_.parts[part(pair)].outline, at, placed_);
        return barriers_.line(barrier(pair), placed_);
    }

    void remember(int pair, double time, double clearance) {
        Sight& sight = cover_.pairs[pair];
        if (clearance < sight.clearance) sight.clearance = clearance, sight.time = time;
    }

    void look(int pair, int knot) {
        remember(pair, motion_.t[knot], line(pair, body_.at_knot(part(pair), knot)).clearance);
    }

    /// The smallest clearance at any knot, and that of every pair that falls short of the demand. What boxes show to be
    /// farther is passed over: first each pair's most promising knot, which tells how near matters, then the others.
    void look_at_knots() {
        double near = std::numeric_limits<double>::infinity();
        const auto matters = [&](int pair, const Box& box) {
            return barriers_.at_least(barrier(pair), box) - pad(pair) <= std::max(task_.demand, near);
        };
        std::vector<int> close, knots;
        for (int pair = 0; pair < static_cast<int>(cover_.pairs.size()); ++pair) {
            if (!matters(pair, body_.whole_box(part(pair)))) continue;
            const int knot = most_promising(pair);
            look(pair, knot);
            near = std::min(near, cover_.pairs[pair].clearance - pad(pair));
            close.push_back(pair), knots.push_back(knot);
        }
        for (std::size_t i = 0; i < close.size(); ++i) {
            if (!matters(close[i], body_.whole_box(part(close[i])))) continue;
            for (int k = 0; k <= motion_.intervals(); ++k)
                if (k != knots[i] && matters(close[i], body_.box(part(close[i]), k))) look(close[i], k);
        }
    }

    int most_promising(int pair) const {
        int best = 0;
        double nearest = std::numeric_limits<double>::infinity();
        for (int k = 0; k <= motion_.intervals(); ++k) {
            const double distance = barriers_.at_least(barrier(pair), body_.box(part(pair), k));
            if (distance < nearest) nearest = distance, best = k;
        }
        return best;
    }

    /// The bound at which an interval is closed, m: the demand, or more where that can be had; for a pair that is seen
    /// to fall short, its worst clearance so far.
    void aim() {
        common_ = task_.demand;
        double nearest = std::numeric_limits<double>::infinity();
        for (int pair = 0; pair < static_cast<int>(cover_.pairs.size()); ++pair) {
            if (violated(pair)) return;
            nearest = std::min(nearest, cover_.pairs[pair].clearance - pad(pair));
        }
        common_ = std::max(task_.demand, nearest - task_.resolution);
    }

    bool violated(int pair) const { return cover_.pairs[pair].clearance < task_.demand - task_.tolerance; }

    double target(int pair) const {
        return violated(pair) ? cover_.pairs[pair].clearance - pad(pair) - task_.worst : common_;
    }

    void between_knots() {
        struct Span {
            int pair, a, b;
        };
        aim();
        std::vector<Span> open, halves;
        for (int pair = 0; pair < static_cast<int>(cover_.pairs.size()); ++pair)
            open.push_back({pair, 0, motion_.intervals()});
        while (!open.empty()) {
            halves.clear();
            for (const Span& span : open) {
                const int middle = (span.a + span.b) / 2, p = part(span.pair);
                const Line l = line(span.pair, body_.at_knot(p, middle));
                const double bound = body_.chain(p, span.a, span.b, l.normal) - l.support - pad(span.pair);
                if (cover_.pairs[span.pair].clearance == std::numeric_limits<double>::infinity())
                    remember(span.pair, motion_.t[middle], l.clearance);
                if (bound >= target(span.pair)) {
                    close(span.pair, motion_.t[span.a], motion_.t[span.b], l, bound);
                } else if (span.b - span.a == 1) {
                    begin(span.pair, span.a);
                } else {
                    halves.push_back({span.pair, span.a, middle}), halves.push_back({span.pair, middle, span.b});
                }
            }
            open.swap(halves);
        }
    }

    void begin(int pair, int k) {
        const int p = part(pair);
        open_.push_back({pair, k, motion_.t[k], motion_.t[k + 1], motion_.knot(k), motion_.knot(k + 1),
                         body_.at_knot(p, k), body_.at_knot(p, k + 1)});
    }

    void close(int pair, double start, double end, const Line& line, double bound) {
        cover_.pieces.push_back({pair, start, end, line.normal, line.support, bound});
    }

    void bisect() {
        std::vector<Open> halves;
        std::vector<Line> lines;
        std::vector<State> states;
        while (!open_.empty()) {
            halves.clear(), lines.clear(), states.clear();
            for (const Open& piece : open_) {
                const double middle = 0.5 * (piece.start + piece.end);
                states.push_back(motion_.at(middle));
                lines.push_back(line(piece.pair, body_.placement(part(piece.pair), states.back())));
                remember(piece.pair, middle, lines.back().clearance);
            }
            aim();
            const bool too_many = static_cast<double>(open_.size()) > task_.most_open;
            for (std::size_t i = 0; i < open_.size(); ++i)
                if (!decided(open_[i], lines[i], too_many)) halve(open_[i], states[i], halves);
            open_.swap(halves);
        }
    }

    /// Closes the interval if its bound suffices or if no bisecting can make it so, or none that would end soon enough.
    bool decided(const Open& piece, const Line& line, bool too_many) {
        const int p = part(piece.pair);
        const double low = std::min(body_.lowest(p, piece.at_start, line.normal), body_.lowest(p, piece.at_end, line.normal));
        const double h = piece.end - piece.start, loss = body_.loss(p, piece.k, piece.before, piece.after, h);
        const double bound = low - loss - line.support - pad(piece.pair);
        const bool undecided = line.clearance < task_.demand + pad(piece.pair) &&
                               line.clearance >= task_.demand - task_.tolerance;
        if (!(bound >= target(piece.pair)) && !undecided && !too_many && std::isfinite(loss) && h >= task_.floor)
            return false;
        close(piece.pair, piece.start, piece.end, line, bound);
        return true;
    }

    void halve(const Open& piece, const State& state, std::vector<Open>& halves) const {
        const double middle = 0.5 * (piece.start + piece.end);
        const Placement between = body_.placement(part(piece.pair), state);
        halves.push_back({piece.pair, piece.k, piece.start, middle, piece.before, state, piece.at_start, between});
        halves.push_back({piece.pair, piece.k, middle, piece.end, state, piece.after, between, piece.at_end});
    }

    Cover finish() {
        std::sort(cover_.pieces.begin(), cover_.pieces.end(), [](const Piece& a, const Piece& b) {
            return a.pair != b.pair ? a.pair < b.pair : a.start < b.start;
        });
        for (Sight& sight : cover_.pairs) sight.holds = true;
        for (const Piece& piece : cover_.pieces)
            if (!(piece.proved >= task_.demand)) cover_.pairs[piece.pair].holds = false;
        return std::move(cover_);
    }

    const Body<Model>& body_;
    const Motion<Model>& motion_;
    const Barriers& barriers_;
    const Task task_;
    double common_ = 0;
    Cover cover_;
    Outline placed_;
    std::vector<Open> open_;
};

/// The worst moment of a pair near the one that was seen, by dense samples.
template <class Model, class Barriers>
Sight worst_moment(const Body<Model>& body, const Barriers& barriers, int pair, Sight seen) {
    const Motion<Model>& motion = body.motion();
    const int part = pair / barriers.size(), barrier = pair % barriers.size();
    Outline placed;
    for (const double width : {2e-2, 2.5e-3, 3e-4, 4e-5}) {
        constexpr int samples = 17;
        Sight best = seen;
        for (int i = 0; i < samples; ++i) {
            const double offset = i + 1 < samples ? -width + i * (2 * width / (samples - 1)) : width;
            const double time = std::clamp(seen.time + offset, motion.t.front(), motion.t.back());
            place(body.parts[part].outline, body.placement(part, motion.at(time)), placed);
            const double clearance = barriers.line(barrier, placed).clearance;
            if (clearance < best.clearance) best.clearance = clearance, best.time = time;
        }
        seen = best;
    }
    return seen;
}

}  // namespace tightspot::judge
