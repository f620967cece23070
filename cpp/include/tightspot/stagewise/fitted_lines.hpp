// Lines that would stop a step short are fitted anew to the poses that the step reaches.
#pragma once

#include <algorithm>
#include <vector>

#include "tightspot/stagewise/assembly.hpp"
#include "tightspot/stagewise/point.hpp"

namespace tightspot::stagewise {

template <class Model>
class FittedLines {
   public:
    FittedLines(const Problem& problem, const Assembly<Model>& assembly)
        : problem_(problem), assembly_(assembly), primal_(assembly.rows.intervals.size(), 0.0), dual_(primal_) {
        int most = 0;
        for (const RowGroup& group : assembly.rows.pairs) most = std::max(most, rows_of(group));
        fit_.reserve(most);
        fitted_.reserve(primal_.size());
    }

    // How fast a step uses up slacks and multipliers: the largest -ds/s and -dz/z.
    struct Rates {
        double primal = 0, dual = 0;

        void add(double s, double ds, double z, double dz) {
            primal = std::max(primal, -ds / s), dual = std::max(dual, -dz / z);
        }
    };

    // Notes the rates of each line; returns those of the rest: bounds, walls and soft pairs, whose lines are weighed against
    // penetrations.
    Rates rates(const Point& at, const Point& step) {
        rest_ = {};
        for (std::size_t i = 0; i < at.sb.size(); ++i) rest_.add(at.sb[i], step.sb[i], at.zb[i], step.zb[i]);
        for (const RowGroup& group : assembly_.rows.walls)
            for (int l = 0; l < group.width; ++l) add_line(group, l, at, step, rest_);
        for (const RowGroup& group : assembly_.rows.pairs)
            for (int l = 0; l < group.width; ++l) {
                Rates own;
                add_line(group, l, at, step, group.soft ? rest_ : own);
                primal_[group.line + l] = own.primal, dual_[group.line + l] = own.dual;
            }
        return rest_;
    }

    // Fits the lines whose primal rate is above the limit to the poses of a trial point, and sets their slacks. False if
    // one of them finds no room.
    bool fit(double limit, const Point& from, Point& trial, Values<Model>& values, const Layout& layout) {
        fitted_.clear();
        for (const RowGroup& group : assembly_.rows.pairs) {
            bool any = false;
            for (int l = 0; l < group.width; ++l) {
                if (!(primal_[group.line + l] > limit)) continue;
                const int phi = layout.aux(assembly_.rows.line_pairs[group.line + l]);
                assembly_.read_points(group, l, values, fit_);
                if (!fit_.fit(from.v[phi])) return false;
                trial.v[phi] = fit_.phi, trial.v[phi + 1] = fit_.mu;
                fitted_.push_back({group.row + l, rows_of(group), group.width});
                any = true;
            }
            if (any) assembly_.evaluate_lines(group, trial.v.data(), values);
        }
        over_rows([&](int row) { trial.s[row] = values.rows[row]; });
        return true;
    }

    // The largest dual rate of the rest and of those lines whose primal rate is not above the limit.
    double dual_rate(double limit) const {
        double rate = rest_.dual;
        for (std::size_t i = 0; i < primal_.size(); ++i)
            if (!(primal_[i] > limit)) rate = std::max(rate, dual_[i]);
        return rate;
    }

    void clear() { fitted_.clear(); }

    // Calls body(row) for every row of a fitted line.
    template <class Body>
    void over_rows(Body&& body) const {
        for (const Rows& rows : fitted_)
            for (int i = 0; i < rows.count; ++i) body(rows.first + i * rows.stride);
    }

   private:
    struct Rows {
        int first, count, stride;
    };

    int rows_of(const RowGroup& group) const {
        return group.corners + group.samples * problem_.parts.count(group.part) + (group.soft ? 1 : 0);
    }

    void add_line(const RowGroup& group, int l, const Point& at, const Point& step, Rates& to) const {
        const int count = rows_of(group);
        for (int i = 0, row = group.row + l; i < count; ++i, row += group.width)
            to.add(at.s[row], step.s[row], at.z[row], step.z[row]);
    }

    const Problem& problem_;
    const Assembly<Model>& assembly_;
    Vector primal_, dual_;  // rates of each line
    Rates rest_;
    LineFit fit_;
    std::vector<Rows> fitted_;
};

}  // namespace tightspot::stagewise
