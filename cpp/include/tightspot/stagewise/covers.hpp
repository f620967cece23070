// Covers: how far a body's points can leave the chords between an interval's samples, a function of
// ((x_k + x_{k+1}) / 2, widths[k] t_f, u_k) for every part, but not of the pose, the first three states.
#pragma once

#include <vector>

#include "tightspot/stagewise/motion.hpp"
#include "tightspot/stagewise/stage_quadratic.hpp"

namespace tightspot::stagewise {

template <class Model>
class Covers {
    using S = Sizes<Model>;

   public:
    Covers(const Problem& problem, const Layout& layout) : problem_(problem), layout_(layout) {
        const std::size_t parts = problem.parts.size();
        gradients.assign(problem.steps * parts * S::nw, 0);
        hessians_.assign(layout.convoys.size() * parts * S::na * S::na, 0);
    }

    void evaluate(const double* v, const Convoy& convoy, Vector& covers) const {
        const Arguments at(*this, v, convoy);
        const int parts = problem_.parts.size();
        Pack value;
        for (int part = 0; part < parts; ++part) {
            Model::cover(at.middle, at.h, at.u, problem_.parameters.data(), problem_.radii[part], convoy.pieces, &value);
            for (int l = 0; l < convoy.count; ++l) covers[(convoy.first + l) * parts + part] = value[l];
        }
    }

    // Gradients with respect to w; the second derivatives are kept for `add_curvature`.
    void differentiate(const double* v, int index) {
        const Convoy& convoy = layout_.convoys[index];
        const Arguments at(*this, v, convoy);
        const int parts = problem_.parts.size();
        Pack scale[S::na], gradient[S::na];
        for (int i = 0; i < S::na; ++i) scale[i] = i < S::nx ? 0.5 : 1.0;
        scale[S::nx] = at.width;
        for (int part = 0; part < parts; ++part) {
            Pack* H = hessians_.data() + (index * parts + part) * S::na * S::na;
            Model::cover_derivatives(at.middle, at.h, at.u, problem_.parameters.data(), problem_.radii[part],
                                     convoy.pieces, gradient, H);
            for (int i = pose; i < S::na; ++i)
                for (int j = pose; j < S::na; ++j) H[i * S::na + j] *= scale[i] * scale[j];
            for (int l = 0; l < convoy.count; ++l) {
                double* w = gradients.data() + ((convoy.first + l) * parts + part) * S::nw;
                for (int i = pose; i < S::na; ++i) w[i] = (scale[i] * gradient[i])[l];
                for (int i = pose; i < S::nx; ++i) w[S::na + i] = w[i];
            }
        }
    }

    // Second derivatives of sum over parts of forces[part] cover, for lane l of a convoy.
    void add_curvature(int index, int l, const double* forces, StageQuadratic<Model>& out) const {
        const int parts = problem_.parts.size();
        for (int part = 0; part < parts; ++part) {
            if (forces[part] == 0) continue;
            const Pack* H = hessians_.data() + (index * parts + part) * S::na * S::na;
            for (int i = pose; i < S::na; ++i)
                for (int j = pose; j < S::na; ++j) {
                    const double entry = forces[part] * H[i * S::na + j][l];
                    out.own[i * S::na + j] += entry;
                    if (i < S::nx) out.mixed[i * S::na + j] += entry;
                    if (i < S::nx && j < S::nx) out.ahead[i * S::na + j] += entry;
                }
        }
    }

    // What is of first order in a cover, with the gradient g of interval k and part: `own` g g' + row g' + g row', where
    // only poses of x_{k+1} count in `row`, and g is zero along poses and the same for both states.
    void add_outer(int k, int part, double own, const double* row, StageQuadratic<Model>& out) const {
        using Row = RowVector<S::na>;
        const double* g = gradients.data() + (k * problem_.parts.size() + part) * S::nw;
        const Row gradient = Row::read(g);
        Row both = Row::read(row);
        both.add(own, gradient);
        const auto add = [](double* to, double factor, const Row& by) {
            Row sum = Row::read(to);
            sum.add(factor, by);
            sum.write(to);
        };
        for (int i = 0; i < S::na; ++i) add(out.own + i * S::na, row[i], gradient);
        for (int i = pose; i < S::na; ++i) add(out.own + i * S::na, g[i], both);
        for (int i = 0; i < S::nx; ++i)
            add(out.mixed + i * S::na, i < pose ? row[S::na + i] : g[i], i < pose ? gradient : both);
        for (int j = pose; j < S::nx; ++j) {
            for (int i = 0; i < pose; ++i) {
                const double entry = row[S::na + i] * g[j];
                out.ahead[i * S::na + j] += entry, out.ahead[j * S::na + i] += entry;
            }
            for (int i = pose; i < S::nx; ++i) out.ahead[i * S::na + j] += own * g[i] * g[j];
        }
    }

    static constexpr int pose = 3;
    Vector gradients;  // by (interval, part), nw each; 0 along poses

   private:
    struct Arguments {
        Pack middle[S::nx], u[S::nu], width, h;

        Arguments(const Covers& covers, const double* v, const Convoy& convoy) {
            const Layout& layout = covers.layout_;
            Pack next[S::nx];
            Drive<Model>::template read<S::nx>(v + layout.x(convoy.first), convoy, middle);
            Drive<Model>::template read<S::nx>(v + layout.x(convoy.first + 1), convoy, next);
            Drive<Model>::template read<S::nu>(v + layout.u(convoy.first), convoy, u);
            Drive<Model>::template read<1>(covers.problem_.widths.data() + convoy.first, convoy, &width);
            for (int i = 0; i < S::nx; ++i) middle[i] = 0.5 * (middle[i] + next[i]);
            h = v[layout.time] * width;
        }
    };

    const Problem& problem_;
    const Layout& layout_;
    Packs hessians_;  // by (convoy, part), na x na, with respect to a and, by the same entries, x_{k+1}
};

}  // namespace tightspot::stagewise
