// Violation of a point, computed from the problem's definition alone, with none of the solver's machinery.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tightspot/stagewise/problem.hpp"

namespace tightspot::stagewise {

template <class Model>
class Audit {
    static constexpr int nx = Model::states, nu = Model::inputs;

   public:
    // `scratch` holds the samples of an interval; see `scratch_size`.
    Audit(const Problem& problem, const Layout& layout, const Vector& v, Vector& scratch)
        : problem_(problem), layout_(layout), v_(v), samples_(scratch) {}

    static std::size_t scratch_size(const Problem& problem) {
        int most = 0;
        for (int pieces : problem.pieces) most = std::max(most, pieces);
        return static_cast<std::size_t>((most + 1) * nx);
    }

    // The largest violation of anything; infinite if a number is not finite.
    double violation() {
        for (double value : v_)
            if (!std::isfinite(value)) return HUGE_VAL;
        bounds();
        for (int k = 0; k < problem_.steps; ++k) {
            drive(k);
            walls(k);
            pairs(k);
        }
        return worst_;
    }

   private:
    // `amount` must not be positive.
    void demand(double amount) { worst_ = std::isnan(amount) ? HUGE_VAL : std::max(worst_, amount); }

    void bounds() {
        const double time = v_[layout_.time];
        demand(problem_.time_low - time), demand(time - problem_.time_high);
        for (int k = 0; k <= problem_.steps; ++k)
            for (int i = 0; i < nx; ++i) {
                const double x = v_[layout_.x(k) + i];
                const Vector* given = k == 0 ? &problem_.start : k == problem_.steps ? &problem_.goal : nullptr;
                if (given && !std::isnan((*given)[i])) {
                    demand(std::abs(x - (*given)[i]));
                    continue;
                }
                demand(problem_.state_low[i] - x), demand(x - problem_.state_high[i]);
            }
        for (int k = 0; k < problem_.steps; ++k)
            for (int i = 0; i < nu; ++i) {
                const double u = v_[layout_.u(k) + i];
                demand(problem_.input_low[i] - u), demand(u - problem_.input_high[i]);
            }
    }

    // Fills the samples of interval k; the motion must end at x_{k+1}.
    void drive(int k) {
        const int substeps = problem_.substeps[k], pieces = problem_.pieces[k];
        const double h = v_[layout_.time] * problem_.widths[k] / (pieces * substeps);
        const double *start = v_.data() + layout_.x(k), *end = v_.data() + layout_.x(k + 1);
        double state[nx], after[nx], shared[Model::shared];
        std::copy(start, start + nx, state), std::copy(start, start + nx, samples_.begin());
        for (int piece = 1; piece <= pieces; ++piece) {
            for (int step = 0; step < substeps; ++step, std::copy(after, after + nx, state))
                Model::step(state, h, v_.data() + layout_.u(k), problem_.parameters.data(), after, shared);
            std::copy(state, state + nx, samples_.begin() + piece * nx);
        }
        for (int i = 0; i < nx; ++i) demand(std::abs(state[i] - end[i]));
        std::copy(end, end + nx, samples_.begin() + pieces * nx);
    }

    double cover(int k, int part, const Demand& at) const { return at.weight == 0 ? 0 : at.weight * cover(k, part); }

    double cover(int k, int part) const {
        double middle[nx], value = 0;
        for (int i = 0; i < nx; ++i) middle[i] = (v_[layout_.x(k) + i] + v_[layout_.x(k + 1) + i]) / 2;
        Model::cover(middle, v_[layout_.time] * problem_.widths[k], v_.data() + layout_.u(k),
                     problem_.parameters.data(), problem_.radii[part], problem_.pieces[k], &value);
        return value;
    }

    // n . V over the vertices of a part at a pose: the least.
    double nearest(int part, int sample, double nx_, double ny_) const {
        const double* state = samples_.data() + sample * nx;
        double least = HUGE_VAL;
        for (int i = problem_.parts.first[part]; i < problem_.parts.first[part + 1]; ++i) {
            const double px = problem_.parts.x[i], py = problem_.parts.y[i];
            const double X = state[0] + std::cos(state[2]) * px - std::sin(state[2]) * py;
            const double Y = state[1] + std::sin(state[2]) * px + std::cos(state[2]) * py;
            least = std::min(least, nx_ * X + ny_ * Y);
        }
        return least;
    }

    void walls(int k) {
        const int parts = problem_.parts.size();
        for (int i = layout_.wall[k * parts]; i < layout_.wall[(k + 1) * parts]; ++i) {
            const Wall& wall = problem_.walls[i];
            for (int p = 0; p <= problem_.pieces[k]; ++p) {
                const Demand& at = problem_.wall_demands[layout_.sample[k] + p];
                if (!at.used) continue;
                const double inside = wall.offset + nearest(wall.part, p, -wall.normal[0], -wall.normal[1]);
                demand(at.constant + cover(k, wall.part, at) - inside);
            }
        }
    }

    void pairs(int k) {
        const int parts = problem_.parts.size();
        for (int i = layout_.pair[k * parts]; i < layout_.pair[(k + 1) * parts]; ++i) {
            const Pair& pair = problem_.pairs[i];
            const int at_line = layout_.aux(i);
            const Motion* motion = problem_.motion_of(pair.obstacle);
            const double nx_ = std::cos(v_[at_line]), ny_ = std::sin(v_[at_line]);
            const double mu = v_[at_line + 1] + nx_ * pair.origin[0] + ny_ * pair.origin[1];
            const Demand side{pair.obstacle_side, pair.obstacle_weight, 1};
            const double sigma = pair.penalty.soft ? v_[layout_.sigma + layout_.soft[i]] : 0;
            demand(-sigma);
            for (int j = problem_.obstacles.first[pair.obstacle]; j < problem_.obstacles.first[pair.obstacle + 1]; ++j)
                demand(nx_ * problem_.obstacles.x[j] + ny_ * problem_.obstacles.y[j] - mu + side.constant +
                       cover(k, pair.part, side));
            for (int p = 0; p <= problem_.pieces[k]; ++p) {
                const Demand& at = problem_.pair_demands[layout_.sample[k] + p];
                if (!at.used) continue;
                const double inside = motion ? nearest_to_moving(*motion, k, pair.part, p, v_[at_line], mu)
                                             : nearest(pair.part, p, nx_, ny_) - mu;
                demand(at.constant + pair.extra + cover(k, pair.part, at) - inside - sigma);
            }
        }
    }

    // n . V - mu, the least, for a line (phi, mu) in a moving obstacle's frame: the line is put into the world.
    double nearest_to_moving(const Motion& motion, int k, int part, int piece, double phi, double mu) const {
        const auto at = [&](int i) { return motion.at(layout_.sample[k] + piece, i, v_[layout_.time]); };
        const double nx_ = std::cos(phi + at(2)), ny_ = std::sin(phi + at(2));
        return nearest(part, piece, nx_, ny_) - (mu + nx_ * at(0) + ny_ * at(1));
    }

    const Problem& problem_;
    const Layout& layout_;
    const Vector& v_;
    Vector& samples_;
    double worst_ = 0;
};

}  // namespace tightspot::stagewise
