// What the solver may be told, and what it says.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

namespace tightspot::stagewise {

enum class Status { solved, acceptable, infeasible, iteration_limit, time_limit, stopped, diverged, numerical, invalid };

struct Options {
    double tolerance = 1e-8;
    double acceptable_tolerance = 1e-6;  // after this many iterations in a row below it
    int acceptable_iterations = 15;
    int max_iterations = 500;
    double time_limit = 10;  // s
    double initial_barrier = 0;  // 0: see InteriorPoint::first_barrier
    double bound_push = 1e-2;  // how far the start is moved away from bounds, relative
    double slack_push = 1e-2;  // least slack of a row at the start, m
    bool second_order_correction = true;
    bool warm = false;  // keep the multipliers that were set, and take long steps from the first one on
};

// One iteration: the point before its step, and the step.
struct Record {
    int iteration = 0;
    double objective = 0, violation = 0, stationarity = 0, complementarity = 0;
    double barrier = 0, regularisation = 0, primal_step = 0, dual_step = 0;
    int trials = 0;
};

// Return false to stop.
using Callback = std::function<bool(const Record&)>;

struct Outcome {
    Status status = Status::invalid;
    int iterations = 0, factorisations = 0;
    double objective = 0, violation = 0, stationarity = 0, complementarity = 0, seconds = 0;
    double residual = 0;  // stationarity, not scaled
    double audited = HUGE_VAL;  // violation by the problem's definition: see Audit
};

}  // namespace tightspot::stagewise
