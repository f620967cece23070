// Reeds-Shepp curves: the shortest paths of a car that drives forwards and backwards with a smallest turning radius.
//
// J. A. Reeds, L. A. Shepp: Optimal paths for a car that goes both forwards and backwards, Pacific Journal of
// Mathematics 145(2), 1990. The numbers (8.x) below are that paper's equations.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

#include "tightspot/pose.hpp"

namespace tightspot {

enum class Turn : signed char { right = -1, straight = 0, left = 1 };

/// Up to five segments; lengths are in units of the turning radius, negative when driven in reverse.
struct Word {
    int size = 0;
    std::array<Turn, 5> turns{};
    std::array<double, 5> lengths{};

    double length() const {
        double sum = 0.0;
        for (int i = 0; i < size; ++i) sum += std::abs(lengths[i]);
        return sum;
    }

    Arc arc(int i, double radius) const { return {lengths[i] * radius, static_cast<double>(turns[i]) / radius}; }
};

namespace reeds_shepp {

/// Segments shorter than this (in turning radii) are rounding, not motion.
constexpr double negligible = 1e-9;

namespace detail {

constexpr double slack = 1e-10;

inline bool nonnegative(double value) { return value >= -slack; }
inline bool nonpositive(double value) { return value <= slack; }

/// Angles here are sums of a few principal values, so one turn more or less suffices mostly.
inline double wrapped(double angle) {
    while (angle > pi) angle -= 2.0 * pi;
    while (angle < -pi) angle += 2.0 * pi;
    return angle;
}

/// A vector from one circle's centre to another's, in polar coordinates. If the circles do not overlap, they have an
/// inner tangent of length `tangent` that leaves the vector by the angle `slant`; otherwise both are NaN.
struct Offset {
    double radius, angle, tangent, slant;

    Offset(double x, double y)
        : radius(std::sqrt(x * x + y * y)),
          angle(std::atan2(y, x)),
          tangent(radius >= 2.0 ? std::sqrt(radius * radius - 4.0) : std::nan("")),
          slant(radius >= 2.0 ? std::atan2(2.0, tangent) : std::nan("")) {}

    bool has_tangent() const { return radius >= 2.0; }

    /// A vector as long as this one at another angle.
    Offset turned_to(double another) const {
        Offset turned = *this;
        turned.angle = another;
        return turned;
    }

    /// The vector (-x, y).
    Offset mirrored() const { return turned_to(std::copysign(pi, angle) - angle); }
};

/// The middle lengths of the words without a straight segment: they depend on the distances between the centres only,
/// so that all symmetries of a goal share them. NaN where the circles are too far apart.
struct Bends {
    double lrl, mirrored, repeated, repeated_angle;

    /// The first as given, the others as those of `others`.
    Bends(double given_lrl, const Bends& others) : Bends(others) { lrl = given_lrl; }

    Bends(const Offset& same, const Offset& cross)
        : lrl(same.radius <= 4.0 ? -2.0 * std::asin(0.25 * same.radius) : std::nan("")),
          mirrored(std::nan("")),
          repeated(std::nan("")),
          repeated_angle(std::nan("")) {
        if (const double rho = 0.25 * (2.0 + cross.radius); rho <= 1.0) mirrored = std::acos(rho);
        const double rho = (20.0 - cross.radius * cross.radius) / 16.0;
        if (rho < 0.0 || rho > 1.0) return;
        repeated = -std::acos(rho);
        repeated_angle = std::atan2(2.0 - rho, -std::sqrt(1.0 - rho * rho));
    }
};

/// What the equations need of a goal pose (x, y, phi), in turning radii and seen from the start: where the centre of
/// its left circle (`same`) and of its right circle (`cross`) lie, seen from the centre of the start's left circle.
struct Goal {
    double phi;
    Offset same, cross;
    Bends bends;

    Goal(double heading, const Offset& to_same, const Offset& to_cross)
        : Goal(heading, to_same, to_cross, Bends(to_same, to_cross)) {}

    Goal(double heading, const Offset& to_same, const Offset& to_cross, const Bends& known)
        : phi(heading), same(to_same), cross(to_cross), bends(known) {}

    /// The goal (-x, y, -phi): the same path driven with the gears exchanged.
    Goal time_flipped() const { return {-phi, same.mirrored(), cross.mirrored(), bends}; }

    /// The goal of the same path driven from its end with the gears exchanged. `reflected` is (x, -y, -phi).
    Goal opposite(const Goal& reflected) const {
        return {phi, same.turned_to(wrapped(phi - same.angle)),
                reflected.cross.turned_to(wrapped(phi + reflected.cross.angle)),
                {bends.lrl, reflected.bends}};
    }
};

/// The unknown lengths of one equation.
struct Lengths {
    double t, u, v;
};

using Equation = bool (*)(const Goal&, Lengths&);

/// (8.1) L+ S+ L+
inline bool lsl(const Goal& goal, Lengths& out) {
    out = {goal.same.angle, goal.same.radius, wrapped(goal.phi - goal.same.angle)};
    return nonnegative(out.t) && nonnegative(out.v);
}

/// (8.2) L+ S+ R+
inline bool lsr(const Goal& goal, Lengths& out) {
    if (!goal.cross.has_tangent()) return false;
    const double t = wrapped(goal.cross.angle + goal.cross.slant);
    out = {t, goal.cross.tangent, wrapped(t - goal.phi)};
    return nonnegative(out.t) && nonnegative(out.v);
}

/// (8.3), (8.4) L+ R- L, the last either way
inline bool lrl(const Goal& goal, Lengths& out) {
    const double u = goal.bends.lrl;
    if (std::isnan(u)) return false;
    const double t = wrapped(goal.same.angle + 0.5 * u + pi);
    out = {t, u, wrapped(goal.phi - t + u)};
    return nonnegative(out.t) && nonpositive(out.u);
}

/// (8.7) L+ R+u L-u R-
inline bool lrlr_mirrored(const Goal& goal, Lengths& out) {
    const double u = goal.bends.mirrored;
    if (std::isnan(u)) return false;
    const double t = wrapped(goal.cross.angle + 0.5 * pi + u);
    out = {t, u, wrapped(t - 2.0 * u - goal.phi)};
    return nonnegative(out.t) && nonpositive(out.v);
}

/// (8.8) L+ R-u L-u R+
inline bool lrlr_repeated(const Goal& goal, Lengths& out) {
    if (std::isnan(goal.bends.repeated)) return false;
    const double t = wrapped(goal.cross.angle + goal.bends.repeated_angle);
    out = {t, goal.bends.repeated, wrapped(t - goal.phi)};
    return nonnegative(out.t) && nonnegative(out.v);
}

/// (8.9) L+ R-(pi/2) S- L-
inline bool lrsl(const Goal& goal, Lengths& out) {
    if (!goal.same.has_tangent()) return false;
    const double t = wrapped(goal.same.angle + 0.5 * pi + goal.same.slant);
    out = {t, 2.0 - goal.same.tangent, wrapped(goal.phi - 0.5 * pi - t)};
    return nonnegative(out.t) && nonpositive(out.u) && nonpositive(out.v);
}

/// (8.10) L+ R-(pi/2) S- R-
inline bool lrsr(const Goal& goal, Lengths& out) {
    if (goal.cross.radius < 2.0) return false;
    const double t = wrapped(goal.cross.angle + 0.5 * pi);
    out = {t, 2.0 - goal.cross.radius, wrapped(t + 0.5 * pi - goal.phi)};
    return nonnegative(out.t) && nonpositive(out.u) && nonpositive(out.v);
}

/// (8.11) L+ R-(pi/2) S- L-(pi/2) R+
inline bool lrslr(const Goal& goal, Lengths& out) {
    const double u = 4.0 - goal.cross.tangent;
    if (!nonpositive(u)) return false;
    const double t = wrapped(goal.cross.angle + 0.5 * pi + goal.cross.slant);
    out = {t, u, wrapped(t - goal.phi)};
    return nonnegative(out.t) && nonnegative(out.v);
}

/// Where a segment's length comes from.
enum class Term : unsigned char { t, u, v, minus_u, minus_quarter };

inline double value(Term term, const Lengths& lengths) {
    switch (term) {
        case Term::t:
            return lengths.t;
        case Term::u:
            return lengths.u;
        case Term::v:
            return lengths.v;
        case Term::minus_u:
            return -lengths.u;
        case Term::minus_quarter:
            break;
    }
    return -0.5 * pi;
}

/// One equation, its segments, and whether the opposite order is a word of its own.
struct Family {
    Equation equation;
    int size;
    std::array<Turn, 5> turns;
    std::array<Term, 5> terms;
    bool has_opposite_order;
};

constexpr Turn L = Turn::left, S = Turn::straight, R = Turn::right;

/// With the four symmetries and both orders these are the 48 words (eq. 8.3 and 8.4 share one line).
inline constexpr std::array<Family, 8> families{{
    {lsl, 3, {L, S, L}, {Term::t, Term::u, Term::v}, false},
    {lsr, 3, {L, S, R}, {Term::t, Term::u, Term::v}, false},
    {lrl, 3, {L, R, L}, {Term::t, Term::u, Term::v}, true},
    {lrlr_mirrored, 4, {L, R, L, R}, {Term::t, Term::u, Term::minus_u, Term::v}, false},
    {lrlr_repeated, 4, {L, R, L, R}, {Term::t, Term::u, Term::u, Term::v}, false},
    {lrsl, 4, {L, R, S, L}, {Term::t, Term::minus_quarter, Term::u, Term::v}, true},
    {lrsr, 4, {L, R, S, R}, {Term::t, Term::minus_quarter, Term::u, Term::v}, true},
    {lrslr, 5, {L, R, S, L, R}, {Term::t, Term::minus_quarter, Term::u, Term::minus_quarter, Term::v}, false},
}};

inline Word assemble(const Family& family, const Lengths& lengths, bool flipped, bool reflected, bool opposite) {
    Word word;
    word.size = family.size;
    for (int i = 0; i < family.size; ++i) {
        const int source = opposite ? family.size - 1 - i : i;
        const double length = value(family.terms[source], lengths);
        word.lengths[i] = flipped ? -length : length;
        const auto turn = static_cast<signed char>(family.turns[source]);
        word.turns[i] = static_cast<Turn>(reflected ? -turn : turn);
    }
    return word;
}

/// One of the symmetries of a goal, and how its words are read.
struct Symmetry {
    bool flipped, reflected, opposite;
};

template <std::size_t I, class Visit>
void visit_family(const Goal& target, Symmetry symmetry, Visit&& visit) {
    constexpr Family family = families[I];
    if (symmetry.opposite && !family.has_opposite_order) return;
    Lengths lengths{};
    if (family.equation(target, lengths))
        visit(assemble(family, lengths, symmetry.flipped, symmetry.reflected, symmetry.opposite));
}

/// All families one after the other, each compiled by itself.
template <class Visit, std::size_t... I>
void visit_families(const Goal& target, Symmetry symmetry, Visit&& visit, std::index_sequence<I...> /*all*/) {
    (visit_family<I>(target, symmetry, visit), ...);
}

}  // namespace detail

/// Calls `visit(const Word&)` with every word that leads from the origin to `goal` (m, rad).
template <class Visit>
void for_each_word(const Pose& goal, double radius, Visit&& visit) {
    using detail::Goal, detail::Offset;
    const double x = goal.x / radius, y = goal.y / radius, phi = wrap_angle(goal.theta);
    const double s = std::sin(phi), c = std::cos(phi);
    const Goal direct(phi, Offset(x - s, y - 1.0 + c), Offset(x + s, y - 1.0 - c));
    const Goal reflected(-phi, Offset(x + s, -y - 1.0 + c), Offset(x - s, -y - 1.0 - c));
    for (const bool opposite : {false, true}) {
        for (const bool is_reflected : {false, true}) {
            const Goal& order = is_reflected ? reflected : direct;
            const Goal ahead = opposite ? order.opposite(is_reflected ? direct : reflected) : order;
            for (const bool flipped : {false, true}) {
                const Goal target = flipped ? ahead.time_flipped() : ahead;
                detail::visit_families(target, {flipped, is_reflected, opposite}, visit,
                                       std::make_index_sequence<detail::families.size()>());
            }
        }
    }
}

/// The word without segments that are only rounding.
inline Word without_negligible(const Word& word) {
    Word kept;
    for (int i = 0; i < word.size; ++i) {
        if (std::abs(word.lengths[i]) <= negligible) continue;
        kept.turns[kept.size] = word.turns[i];
        kept.lengths[kept.size++] = word.lengths[i];
    }
    return kept;
}

/// The shortest word from `start` to `goal`.
inline Word shortest(const Pose& start, const Pose& goal, double radius) {
    Word best;
    double best_length = HUGE_VAL;
    for_each_word(relative(start, goal), radius, [&](const Word& word) {
        const double length = word.length();
        if (length < best_length) {
            best_length = length;
            best = word;
        }
    });
    return without_negligible(best);
}

inline bool same_word(const Word& a, const Word& b) {
    if (a.size != b.size || a.turns != b.turns) return false;
    for (int i = 0; i < a.size; ++i)
        if (std::abs(a.lengths[i] - b.lengths[i]) > 1e-7) return false;
    return true;
}

/// All words from `start` to `goal`, shortest first, each once.
inline std::vector<Word> all(const Pose& start, const Pose& goal, double radius) {
    std::vector<Word> words;
    for_each_word(relative(start, goal), radius, [&](const Word& word) { words.push_back(without_negligible(word)); });
    std::stable_sort(words.begin(), words.end(), [](const Word& a, const Word& b) { return a.length() < b.length(); });
    std::vector<Word> distinct;
    for (const Word& word : words) {
        const bool known =
            std::any_of(distinct.begin(), distinct.end(), [&](const Word& w) { return same_word(w, word); });
        if (!known) distinct.push_back(word);
    }
    return distinct;
}

}  // namespace reeds_shepp
}  // namespace tightspot
