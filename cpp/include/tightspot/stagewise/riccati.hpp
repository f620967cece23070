// One stage of the Riccati recursion. Matrices are kept by rows of length na, whatever part of them is used.
#pragma once

#include "tightspot/stagewise/chain.hpp"
#include "tightspot/stagewise/row_vector.hpp"
#include "tightspot/stagewise/stage_quadratic.hpp"

namespace tightspot::stagewise {

template <class Model>
class RiccatiStage {
    using S = Sizes<Model>;
    static constexpr int nx = S::nx, nu = S::nu, nz = S::nz, na = S::na;
    static constexpr double smallest_pivot = 1e-12;
    using Row = RowVector<na>;

   public:
    // From P = P_{k+1} (nz rows), the interval's quadratic, what else there is at the pose of x_{k+1} (see
    // add_pose_block), and the sensitivities F of the interval's motion (nx rows) to P_k, whose upper half counts. False
    // if the inputs' block is not positive definite.
    template <bool coupled>
    bool back(const StageQuadratic<Model>& stage, const double* pose, const double* F, double regularisation, double* P) {
        look_ahead<coupled>(stage, pose, P);
        Row motion[nx], M[nz], controls[nu];
        for (int j = 0; j < nx; ++j) motion[j] = Row::read(F + j * na);
        for (int i = 0; i < nz; ++i) M[i] = through_motion<coupled>(i, P, motion);
        const auto reduced = [&](int r) {  // row r of W_aa + F'M + C'F, regularised
            Row row = Row::read(stage.own + r * na);
            row.add(regularisation, Row::read(unit.rows + r * na));
            for (int j = 0; j < nx; ++j) row.add(F[j * na + r], M[j]);
            if (r == nx) row.add(1.0, M[nx]);
            if (coupled)
                for (int j = 0; j < nx; ++j) row.add(mixed_[j * na + r], motion[j]);
            return row;
        };
        for (int i = 0; i < nu; ++i) {
            controls[i] = reduced(nz + i);
            controls[i].write(controls_ + i * na);
        }
        if (!factor_controls(controls)) return false;
        double eliminated[nu * na];
        for (int i = 0; i < nu; ++i) controls[i].write(eliminated + i * na);
        for (int r = 0; r < nz; ++r) {
            Row row = reduced(r);
            for (int i = 0; i < nu; ++i) row.add(-eliminated[i * na + r] * inverse_[i], controls[i]);
            row.write(P + r * na);
        }
        return true;
    }

    // The same for the gradients: p (na numbers, nz used) from that of the cost to go at k + 1 to that at k; g is the
    // interval's, d its defect.
    template <bool coupled>
    void vector_back(const double* g, const double* F, const double* d, double* p) {
        for (int i = 0; i < nx; ++i) p[i] += g[na + i];
        Row row = Row::read(p);
        row.write(value_);
        for (int j = 0; j < nx; ++j) row.add(d[j], Row::read(ahead_ + j * na));
        double q[na];
        row.write(q);
        row = Row::read(g);
        for (int j = 0; j < nx; ++j) row.add(q[j], Row::read(F + j * na));
        if (coupled)
            for (int j = 0; j < nx; ++j) row.add(d[j], Row::read(mixed_ + j * na));
        row.write(p);
        p[nx] += q[nx];
        for (int i = 0; i < nu; ++i) {
            offset_[i] = p[nz + i];
            for (int j = 0; j < i; ++j) offset_[i] -= below_[i * nu + j] * offset_[j];
        }
        for (int i = nu - 1; i >= 0; --i) {
            offset_[i] *= -inverse_[i];
            for (int j = i + 1; j < nu; ++j) offset_[i] -= below_[j * nu + i] * offset_[j];
        }
        row = Row::read(p);
        for (int i = 0; i < nu; ++i) row.add(offset_[i], Row::read(controls_ + i * na));
        row.write(p);
    }

    // From the step of (x_k, t_f) in a to that of the inputs, also in a, of x_{k+1}, and to the dynamics' multipliers.
    template <bool coupled>
    void forward(const double* F, const double* d, double* a, double* next, double* lam) const {
        Row row = Row::read(a);
        double u[nu];
        for (int i = 0; i < nu; ++i) u[i] = offset_[i] + Row::read(gain_ + i * na).dot(row);
        for (int i = 0; i < nu; ++i) a[nz + i] = u[i];
        row = Row::read(a);
        for (int i = 0; i < nx; ++i) next[i] = d[i] + Row::read(F + i * na).dot(row);
        Row multipliers = Row::read(value_);
        for (int j = 0; j < nx; ++j) multipliers.add(next[j], Row::read(ahead_ + j * na));
        multipliers.add(a[nx], Row::read(ahead_ + nx * na));
        double all[na];
        multipliers.write(all);
        for (int i = 0; i < nx; ++i) lam[i] = all[i];
        if (coupled)
            for (int i = 0; i < nx; ++i) lam[i] += Row::read(mixed_ + i * na).dot(row);
    }

   private:
    // P' = P_{k+1} plus the interval's own quadratic in (x_{k+1}, t_f); C: what is mixed between x_{k+1} and (x_k, u_k).
    template <bool coupled>
    void look_ahead(const StageQuadratic<Model>& stage, const double* pose, double* P) {
        if (coupled) return add_whole(stage, P);
        for (int i = 0; i < nx; ++i) {
            for (int j = 0; j < 3 && i < 3; ++j) P[i * na + j] += stage.ahead[i * na + j];
            if (i >= 3) P[i * na + i] += stage.ahead[i * na + i];
        }
        add_pose_block(pose, P, na);
        for (int i = 0; i < nz; ++i) Row::read(P + i * na).write(ahead_ + i * na);
    }

    // The same where all of the quadratic counts: whole rows at once.
    void add_whole(const StageQuadratic<Model>& stage, double* P) {
        const Row time = Row::read(unit.rows + nx * na);
        double of_time[na] = {};
        for (int i = 0; i < nx; ++i) {
            const double entry = of_time[i] = stage.mixed[i * na + nx];
            Row row = Row::read(P + i * na), mixed = Row::read(stage.mixed + i * na);
            row.add(1.0, Row::read(stage.ahead + i * na)), row.add(entry, time);
            row.write(P + i * na), row.write(ahead_ + i * na);
            mixed.add(-entry, time);
            mixed.write(mixed_ + i * na);
        }
        Row last = Row::read(P + nx * na);
        last.add(1.0, Row::read(of_time));
        last.write(P + nx * na), last.write(ahead_ + nx * na);
    }

    // Row i of M = P' F + C, where F goes on with the unit row of t_f.
    template <bool coupled>
    Row through_motion(int i, const double* P, const Row* motion) const {
        const auto entry = [&](int j) { return i <= j ? P[i * na + j] : P[j * na + i]; };
        Row row = Row::read(unit.rows + nx * na).times(entry(nx));
        if (coupled && i < nx) row.add(1.0, Row::read(mixed_ + i * na));
        for (int j = 0; j < nx; ++j) row.add(entry(j), motion[j]);
        return row;
    }

    // L D L' of the inputs' block, which the rows are left divided by L of; the gains.
    bool factor_controls(Row* controls) {
        double pivots[na];
        for (int i = 0; i < nu; ++i) {
            for (int j = 0; j < i; ++j) controls[i].add(-below_[i * nu + j], controls[j]);
            controls[i].write(pivots);
            if (!(pivots[nz + i] > smallest_pivot)) return false;
            inverse_[i] = 1 / pivots[nz + i];
            for (int j = i + 1; j < nu; ++j) below_[j * nu + i] = pivots[nz + j] * inverse_[i];
        }
        Row gains[nu];
        for (int i = nu - 1; i >= 0; --i) {
            gains[i] = controls[i].times(-inverse_[i]);
            for (int j = i + 1; j < nu; ++j) gains[i].add(-below_[j * nu + i], gains[j]);
            gains[i].write(gain_ + i * na);
            for (int c = nz; c < na; ++c) gain_[i * na + c] = 0;
        }
        return true;
    }

    struct Unit {
        double rows[na * na] = {};
        constexpr Unit() {
            for (int i = 0; i < na; ++i) rows[i * (na + 1)] = 1;
        }
    };
    static constexpr Unit unit{};

    double ahead_[nz * na], mixed_[nx * na];
    double controls_[nu * na];  // the inputs' rows of the reduced Hessian
    double below_[nu * nu], inverse_[nu], gain_[nu * na];
    double offset_[nu], value_[na];  // of the vector recursion
};

}  // namespace tightspot::stagewise
