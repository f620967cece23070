// tightspot._core.StagewiseSolver: a stage problem's plain arrays in, iterates out. The GIL is released while it works.
#include "stagewise.hpp"

#include "arrays.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "tightspot/stagewise/demanded.hpp"
#include "tightspot/stagewise/generated/single_track.hpp"
#include "tightspot/stagewise/interior_point.hpp"
#include "tightspot/stagewise/start_lines.hpp"
#include "tightspot/stagewise/validate.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace tightspot::stagewise;

namespace {

using Array = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Integers = nb::ndarray<const std::int64_t, nb::c_contig, nb::device::cpu>;
using tightspot::Table;

/// How long a solve without a callback goes on before it asks whether Ctrl-C was pressed.
constexpr std::chrono::milliseconds signal_interval{50};

/// The numbers of an attribute: read in place where it is a contiguous array of the type, else converted by NumPy.
template <class Number>
class Numbers {
   public:
    Numbers(nb::handle problem, const char* name) : value_(problem.attr(name)) {
        if (in_place()) return;
        if (!nb::try_cast(value_, converted_))
            throw nb::value_error(
                (std::string("stage problem: ") + name + " is not a contiguous array of the right type").c_str());
        data_ = converted_.data(), size_ = converted_.size();
    }
    Numbers(const Numbers&) = delete;
    Numbers& operator=(const Numbers&) = delete;
    ~Numbers() {
        if (view_.obj) PyBuffer_Release(&view_);
    }

    std::size_t size() const { return size_; }
    const Number* begin() const { return data_; }
    const Number* end() const { return data_ + size_; }
    Number operator[](std::size_t i) const { return data_[i]; }

   private:
    bool in_place() {
        if (!PyObject_CheckBuffer(value_.ptr())) return false;
        if (PyObject_GetBuffer(value_.ptr(), &view_, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0) {
            PyErr_Clear();
            return false;
        }
        const std::string format = view_.format ? view_.format : "B";
        const bool same = std::is_floating_point_v<Number> ? format == "d" : format == "l" || format == "q";
        if (!same || view_.itemsize != sizeof(Number)) {
            PyBuffer_Release(&view_);
            return false;
        }
        data_ = static_cast<const Number*>(view_.buf), size_ = static_cast<std::size_t>(view_.len) / sizeof(Number);
        return true;
    }

    nb::object value_;
    Py_buffer view_{};
    nb::ndarray<const Number, nb::c_contig, nb::device::cpu> converted_;
    const Number* data_ = nullptr;
    std::size_t size_ = 0;
};

Vector doubles(nb::handle problem, const char* name) {
    const Numbers<double> numbers(problem, name);
    return Vector(numbers.begin(), numbers.end());
}

Indices integers(nb::handle problem, const char* name) {
    const Numbers<std::int64_t> numbers(problem, name);
    Indices result;
    result.reserve(numbers.size());
    for (const std::int64_t value : numbers) {
        const bool fits = value >= std::numeric_limits<int>::min() && value <= std::numeric_limits<int>::max();
        result.push_back(fits ? static_cast<int>(value) : -1);
    }
    return result;
}

template <class Number = double>
Number number(nb::handle problem, const char* name) {
    Number value;
    if (!nb::try_cast(problem.attr(name), value))
        throw nb::value_error((std::string("stage problem: ") + name + " is not a number or truth value as needed").c_str());
    return value;
}

void need(bool holds, const char* name) {
    if (!holds) throw nb::value_error((std::string("stage problem: ") + name + " has a shape that does not fit").c_str());
}

std::vector<Demand> demands(nb::handle problem, const char* name) {
    const Numbers<double> table(problem, name);
    std::vector<Demand> result(table.size() / 2);
    for (std::size_t i = 0; i < result.size(); ++i) {
        const bool used = !std::isnan(table[2 * i]);
        result[i] = {used ? table[2 * i] : 0, used ? table[2 * i + 1] : 0, used};
    }
    return result;
}

Polygons polygons(nb::handle problem, const char* vertices, const char* first) {
    const Numbers<double> xy(problem, vertices);
    Polygons result;
    result.first = integers(problem, first);
    result.x.reserve(xy.size() / 2), result.y.reserve(xy.size() / 2);
    for (std::size_t i = 0; i + 1 < xy.size(); i += 2) result.x.push_back(xy[i]), result.y.push_back(xy[i + 1]);
    return result;
}

std::vector<Motion> motions(nb::handle problem) {
    const Indices obstacles = integers(problem, "motion_obstacles");
    const Vector times = doubles(problem, "motion_times");
    const Vector poses = doubles(problem, "motion_poses"), slopes = doubles(problem, "motion_slopes");
    const std::size_t count = obstacles.size(), numbers = count == 0 ? 0 : poses.size() / count;
    need(times.size() == count, "motion_times");
    need(poses.size() == count * numbers, "motion_poses");
    need(slopes.size() == poses.size(), "motion_slopes");
    std::vector<Motion> result;
    for (std::size_t i = 0; i < count; ++i) {
        const auto own = [&](const Vector& all) {
            return Vector(all.data() + i * numbers, all.data() + (i + 1) * numbers);
        };
        result.push_back({obstacles[i], times[i], own(poses), own(slopes)});
    }
    return result;
}

Problem to_problem(nb::handle from) {
    Problem problem;
    problem.widths = doubles(from, "widths");
    problem.steps = static_cast<int>(problem.widths.size());
    problem.pieces = integers(from, "pieces"), problem.substeps = integers(from, "substeps");
    problem.parameters = doubles(from, "parameters");
    problem.time_weight = number(from, "time_weight"), problem.input_weights = doubles(from, "input_weights");
    problem.time_scaled = number<bool>(from, "time_scaled");
    problem.state_low = doubles(from, "state_low"), problem.state_high = doubles(from, "state_high");
    problem.input_low = doubles(from, "input_low"), problem.input_high = doubles(from, "input_high");
    problem.time_low = number(from, "time_low"), problem.time_high = number(from, "time_high");
    problem.start = doubles(from, "start"), problem.goal = doubles(from, "goal");
    problem.parts = polygons(from, "part_vertices", "part_first");
    problem.obstacles = polygons(from, "obstacle_vertices", "obstacle_first");
    problem.radii = doubles(from, "part_radii");
    const Indices pairs = integers(from, "pairs");
    const Numbers<double> origins(from, "pair_origins"), sides(from, "pair_sides"), penalties(from, "pair_penalties");
    need(origins.size() == pairs.size() / 3 * 2 && pairs.size() % 3 == 0, "pair_origins");
    need(sides.size() == origins.size(), "pair_sides");
    need(penalties.size() == origins.size(), "pair_penalties");
    problem.pairs.reserve(pairs.size() / 3);
    for (std::size_t i = 0; 3 * i < pairs.size(); ++i) {
        const bool soft = !std::isnan(penalties[2 * i]);
        const Penalty penalty{soft ? penalties[2 * i] : 0, soft ? penalties[2 * i + 1] : 0, soft};
        problem.pairs.push_back({pairs[3 * i], pairs[3 * i + 1], pairs[3 * i + 2],
                                 {origins[2 * i], origins[2 * i + 1]}, sides[2 * i], sides[2 * i + 1], 0, penalty});
    }
    const Numbers<double> extras(from, "pair_extras");
    need(extras.size() == 0 || extras.size() == problem.pairs.size(), "pair_extras");
    for (std::size_t i = 0; i < extras.size(); ++i) problem.pairs[i].extra = extras[i];
    const Indices walls = integers(from, "walls");
    const Numbers<double> lines(from, "wall_lines");
    need(walls.size() % 2 == 0 && lines.size() == walls.size() / 2 * 3, "wall_lines");
    problem.walls.reserve(walls.size() / 2);
    for (std::size_t i = 0; 2 * i < walls.size(); ++i)
        problem.walls.push_back(
            {walls[2 * i], walls[2 * i + 1], {lines[3 * i], lines[3 * i + 1]}, lines[3 * i + 2]});
    problem.pair_demands = demands(from, "pair_demands"), problem.wall_demands = demands(from, "wall_demands");
    problem.motions = motions(from);
    return problem;
}

nb::object flat(Vector values) { return nb::cast(tightspot::column(std::move(values))); }

const char* name(Status status) {
    switch (status) {
        case Status::solved:
            return "solved";
        case Status::acceptable:
            return "acceptable";
        case Status::infeasible:
            return "infeasible";
        case Status::iteration_limit:
            return "iteration_limit";
        case Status::time_limit:
            return "time_limit";
        case Status::stopped:
            return "stopped";
        case Status::diverged:
            return "diverged";
        case Status::numerical:
            return "numerical";
        case Status::invalid:
            break;
    }
    return "invalid";
}

void fill(Vector& into, const Array& from, const char* what) {
    if (from.size() != into.size())
        throw nb::value_error((std::string(what) + " has " + std::to_string(from.size()) + " numbers, but needs " +
                               std::to_string(into.size()))
                                  .c_str());
    std::copy(from.data(), from.data() + from.size(), into.begin());
}

Indices integers(const Integers& from) { return Indices(from.data(), from.data() + from.size()); }

Polygons polygons(const Array& vertices, const Integers& first, const char* what) {
    Polygons result;
    result.first = integers(first);
    for (std::size_t i = 0; i + 1 < vertices.size(); i += 2)
        result.x.push_back(vertices.data()[i]), result.y.push_back(vertices.data()[i + 1]);
    bool sound = vertices.size() % 2 == 0 && !result.first.empty() && result.first.front() == 0 &&
                 result.first.back() == static_cast<int>(result.x.size());
    for (int i = 0; sound && i < result.size(); ++i) sound = result.count(i) > 0;
    need(sound, what);
    return result;
}

using Flags = nb::ndarray<const bool, nb::c_contig, nb::device::cpu>;

// Of every pair (phi, offset), the point (x, y), and by how much the two overlap: see start_lines.hpp. `frames` holds the
// poses (x, y, theta) of each moving obstacle's frame at all samples; of the intervals that are not `whole` only the last
// sample counts.
nb::tuple start_lines(const Array& states, const Integers& pieces, const Flags& whole, const Array& part_vertices,
                      const Integers& part_first, const Array& obstacle_vertices, const Integers& obstacle_first,
                      const Integers& pairs, const Integers& moving, const Array& frames) {
    const Polygons parts = polygons(part_vertices, part_first, "part_vertices");
    const Polygons obstacles = polygons(obstacle_vertices, obstacle_first, "obstacle_vertices");
    const Indices each = integers(pieces), wanted = integers(pairs);
    const int steps = static_cast<int>(each.size());
    need(states.ndim() == 2 && states.shape(0) == each.size() + 1 && states.shape(1) >= 3, "states");
    Indices first(1, 0), frame_of(static_cast<std::size_t>(obstacles.size()), -1);
    for (int count : each) {
        need(count >= 1 && count <= 1000, "pieces");
        first.push_back(first.back() + count + 1);
    }
    need(frames.size() == moving.size() * 3 * static_cast<std::size_t>(first.back()), "motion_poses");
    for (std::size_t i = 0; i < moving.size(); ++i) {
        const std::int64_t obstacle = moving.data()[i];
        need(obstacle >= 0 && obstacle < obstacles.size(), "motion_obstacles");
        frame_of[static_cast<std::size_t>(obstacle)] = static_cast<int>(i);
    }
    need(whole.size() == each.size(), "whole");
    const std::vector<char> at_all(whole.data(), whole.data() + whole.size());
    need(wanted.size() % 3 == 0, "pairs");
    const GuessedMotion motion{states.data(), static_cast<int>(states.shape(1)), each, at_all};
    StartLines lines(parts, obstacles);
    Vector found, points, overlaps;
    found.reserve(wanted.size() / 3 * 2), points.reserve(wanted.size() / 3 * 2), overlaps.reserve(wanted.size() / 3);
    for (std::size_t i = 0; i < wanted.size(); i += 3) {
        const int k = wanted[i], part = wanted[i + 1], obstacle = wanted[i + 2];
        need(k >= 0 && k < steps && part >= 0 && part < parts.size() && obstacle >= 0 && obstacle < obstacles.size(),
             "pairs");
        const int frame = frame_of[obstacle];
        const double* poses = frame < 0 ? nullptr : frames.data() + 3 * (frame * first.back() + first[k]);
        const StartLine line = lines.of(motion, k, part, obstacle, poses);
        found.push_back(line.phi), found.push_back(line.offset);
        points.push_back(line.x), points.push_back(line.y);
        overlaps.push_back(std::max(-line.gap, 0.0));
    }
    return nb::make_tuple(tightspot::table(std::move(found), 2), tightspot::table(std::move(points), 2),
                          flat(std::move(overlaps)));
}

// What a solve came to; of rows in the problem's order.
struct Answer {
    Outcome outcome;
    Vector v, s, z, zb, lam, nu, rows, defects, bounds, demands;
    std::vector<Record> log;
    std::string flaw;  // why nothing could be solved
    double build = 0;  // s
};

template <class Model>
Answer answer_of(const InteriorPoint<Model>& core, const Outcome& outcome) {
    const Point& point = core.point;
    return {outcome,
            point.v,
            core.in_order(point.s),
            core.in_order(point.z),
            point.zb,
            point.lam,
            point.nu,
            core.in_order(core.values().rows),
            core.values().defects,
            core.bound_multipliers(),
            core.demands(),
            core.log,
            "",
            0};
}

Table logged(const std::vector<Record>& log) {
    Vector rows;
    rows.reserve(10 * log.size());
    for (const Record& r : log)
        for (double value : {double(r.iteration), r.objective, r.violation, r.stationarity, r.complementarity,
                             r.barrier, r.regularisation, r.primal_step, r.dual_step, double(r.trials)})
            rows.push_back(value);
    return tightspot::table(std::move(rows), 10);
}

/// The largest multiplier of rows and dynamics, 1 if they are smaller.
double largest_multiplier(const Answer& answer) {
    double largest = 1;
    for (const Vector* multipliers : {&answer.z, &answer.lam})
        for (double multiplier : *multipliers) largest = std::max(largest, std::abs(multiplier));
    return largest;
}

nb::dict told(Answer&& answer) {
    nb::dict told;
    if (!answer.flaw.empty()) {
        told["flaw"] = answer.flaw;
        return told;
    }
    const Outcome& outcome = answer.outcome;
    told["status"] = name(outcome.status);
    told["iterations"] = outcome.iterations, told["factorisations"] = outcome.factorisations;
    told["objective"] = outcome.objective, told["violation"] = outcome.violation, told["audited"] = outcome.audited;
    told["stationarity"] = outcome.stationarity, told["complementarity"] = outcome.complementarity;
    told["seconds"] = outcome.seconds, told["build"] = answer.build, told["residual"] = outcome.residual;
    told["largest_multiplier"] = largest_multiplier(answer);
    told["v"] = flat(std::move(answer.v)), told["s"] = flat(std::move(answer.s)), told["z"] = flat(std::move(answer.z));
    told["zb"] = flat(std::move(answer.zb)), told["lam"] = flat(std::move(answer.lam));
    told["nu"] = flat(std::move(answer.nu)), told["rows"] = flat(std::move(answer.rows));
    told["defects"] = flat(std::move(answer.defects)), told["bounds"] = flat(std::move(answer.bounds));
    told["demands"] = flat(std::move(answer.demands)), told["log"] = logged(answer.log);
    return told;
}

// The problem, if it can be used; else throws std::invalid_argument.
template <class Model>
std::unique_ptr<InteriorPoint<Model>> core_of(Problem problem) {
    const std::string wrong = flaw(problem, Model::states, Model::inputs, Model::parameters);
    if (!wrong.empty()) throw std::invalid_argument("stage problem: " + wrong + " cannot be used");
    return std::make_unique<InteriorPoint<Model>>(std::move(problem));
}

// One of many: a problem and its start, or why there is none.
struct Job {
    Problem problem;
    Vector start;
    std::string flaw;
};

Job job_of(nb::handle problem, nb::handle start) {
    Job job;
    try {
        job.problem = to_problem(problem);
        Array v;
        if (!nb::try_cast<Array>(start, v)) throw std::invalid_argument("the start's arrays do not fit each other");
        job.start.assign(v.data(), v.data() + v.size());
    } catch (const std::exception& error) {
        job.flaw = error.what();
    }
    return job;
}

template <class Model>
Answer answer_to(Job& job, const Options& options) {
    using Clock = std::chrono::steady_clock;
    const auto began = Clock::now();
    Answer answer;
    answer.flaw = job.flaw;
    if (!job.flaw.empty()) return answer;
    try {
        const auto core = core_of<Model>(std::move(job.problem));
        if (core->point.v.size() != job.start.size()) throw std::invalid_argument("the start does not fit the problem");
        core->point.v = std::move(job.start);
        const double build = std::chrono::duration<double>(Clock::now() - began).count();
        answer = answer_of(*core, core->solve(options));
        answer.build = build;
    } catch (const std::exception& error) {
        answer.flaw = error.what();
    }
    return answer;
}

// Calls work(i) for all i < count, on several threads; on fewer if the system gives no more.
template <class Work>
void spread(std::size_t count, int threads, const Work& work) {
    std::atomic<std::size_t> next{0};
    const auto all = [&] {
        for (std::size_t i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::thread> others;
    try {
        while (static_cast<int>(others.size()) + 1 < threads) others.emplace_back(all);
    } catch (const std::system_error&) {
    }
    all();
    for (std::thread& other : others) other.join();
}

// Each problem is solved by itself from its start; none begins after `seconds`.
template <class Model>
nb::list solve_many(nb::list problems, nb::list starts, const Options& options, int threads, double seconds) {
    using Clock = std::chrono::steady_clock;
    const auto began = Clock::now();
    std::vector<Job> jobs;
    jobs.reserve(problems.size());
    for (std::size_t i = 0; i < problems.size(); ++i) jobs.push_back(job_of(problems[i], starts[i]));
    std::vector<Answer> answers(jobs.size());
    {
        nb::gil_scoped_release release;
        spread(jobs.size(), threads, [&](std::size_t i) {
            Options own = options;
            const double left = seconds - std::chrono::duration<double>(Clock::now() - began).count();
            own.time_limit = std::min(own.time_limit, std::max(left, 0.0));
            answers[i] = answer_to<Model>(jobs[i], own);
        });
    }
    nb::list told_all;
    for (Answer& answer : answers) told_all.append(told(std::move(answer)));
    return told_all;
}

/// Lets a solve go on until Ctrl-C is pressed or another signal's handler raises.
Callback until_a_signal(std::unique_ptr<nb::python_error>& raised) {
    auto asked = std::chrono::steady_clock::now();
    return [asked, &raised](const Record&) mutable {
        const auto now = std::chrono::steady_clock::now();
        if (now - asked < signal_interval) return true;
        asked = now;
        nb::gil_scoped_acquire acquire;
        if (PyErr_CheckSignals() == 0) return true;
        raised = std::make_unique<nb::python_error>();
        return false;
    };
}

/// Tells a Python function of each iteration, until it returns False or raises.
Callback told_to(const nb::object& callback, std::unique_ptr<nb::python_error>& raised) {
    return [&callback, &raised](const Record& record) {
        nb::gil_scoped_acquire acquire;
        try {
            nb::object verdict = callback(record.iteration, record.objective, record.violation);
            return !(verdict.ptr() == Py_False);
        } catch (nb::python_error& error) {
            raised = std::make_unique<nb::python_error>(error);
            return false;
        }
    };
}

using Mask = nb::ndarray<const bool, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

/// The (interval, part, other) that are true, in order.
std::vector<std::int64_t> chosen(const Mask& mask) {
    std::vector<std::int64_t> found;
    const bool* at = mask.data();
    for (std::size_t k = 0; k < mask.shape(0); ++k)
        for (std::size_t part = 0; part < mask.shape(1); ++part)
            for (std::size_t other = 0; other < mask.shape(2); ++other)
                if (*at++)
                    for (std::size_t index : {k, part, other}) found.push_back(static_cast<std::int64_t>(index));
    return found;
}

/// The rows of a problem: pairs, their sides' demands, walls and their lines (normals and offsets of W's edges), and what
/// is demanded of pairs and walls at each sample.
nb::tuple rows(const Mask& active, const Mask& near, const Array& normals, const Array& offsets, const Integers& poses,
               const Clearances& wanted) {
    const std::size_t steps = poses.size();
    need(active.shape(0) == steps && near.shape(0) == steps, "active");
    need(normals.size() == 2 * offsets.size() && near.shape(2) == offsets.size(), "wall_lines");
    std::vector<std::int64_t> pieces;
    std::vector<char> whole;
    for (std::size_t k = 0; k < steps; ++k) {
        const std::int64_t count = poses.data()[k];
        need(count >= 0 && count <= 1000, "pieces");
        pieces.push_back(std::max<std::int64_t>(count, 1)), whole.push_back(count > 0);
    }
    Demanded demanded(pieces, whole, wanted);
    std::vector<std::int64_t> pairs = chosen(active), edges = chosen(near), walls;
    Vector sides, lines;
    for (std::size_t i = 0; i < pairs.size(); i += 3)
        for (std::size_t j : {0, 1}) sides.push_back(demanded.sides[2 * static_cast<std::size_t>(pairs[i]) + j]);
    for (std::size_t i = 0; i < edges.size(); i += 3) {
        const auto edge = static_cast<std::size_t>(edges[i + 2]);
        walls.push_back(edges[i]), walls.push_back(edges[i + 1]);
        lines.push_back(normals.data()[2 * edge]), lines.push_back(normals.data()[2 * edge + 1]);
        lines.push_back(offsets.data()[edge]);
    }
    return nb::make_tuple(tightspot::table_of(std::move(pairs), 3), tightspot::table(std::move(sides), 2),
                          tightspot::table_of(std::move(walls), 2), tightspot::table(std::move(lines), 3),
                          tightspot::table(std::move(demanded.pairs), 2), tightspot::table(std::move(demanded.walls), 2));
}

template <class Model>
class Solver {
   public:
    explicit Solver(nb::handle from) {
        try {
            core_ = core_of<Model>(to_problem(from));
        } catch (const std::invalid_argument& error) {
            throw nb::value_error(error.what());
        }
    }

    nb::dict sizes() const {
        const Layout& layout = core_->layout();
        nb::dict answer;
        answer["variables"] = layout.variables, answer["rows"] = layout.rows, answer["bounds"] = core_->bounds().size();
        return answer;
    }

    void set(const Array& v) { fill(core_->point.v, v, "the start"); }

    void set_ends(const Array& start, const Array& goal) {
        const auto vector = [](const Array& a) { return Vector(a.data(), a.data() + a.size()); };
        if (!core_->move_ends(vector(start), vector(goal))) throw nb::value_error("other entries of start or goal are free");
    }

    void set_multipliers(const Array& s, const Array& z, const Array& zb, const Array& lam, const Array& nu) {
        Point& point = core_->point;
        fill_rows(point.s, s, "s"), fill_rows(point.z, z, "z"), fill(point.zb, zb, "zb"), fill(point.lam, lam, "lam");
        fill(point.nu, nu, "nu");
    }

    nb::dict solve(const Options& options, nb::object callback) {
        Outcome outcome;
        std::unique_ptr<nb::python_error> raised;
        const Callback watch = callback.is_none() ? until_a_signal(raised) : told_to(callback, raised);
        {
            nb::gil_scoped_release release;
            outcome = core_->solve(options, watch);
        }
        if (raised) throw *raised;
        return told(answer_of(*core_, outcome));
    }

    nb::dict derivatives(const Array& v, const Array& lam, const Array& z) {
        Point& point = core_->point;
        fill(point.v, v, "v"), fill(point.lam, lam, "lam"), fill_rows(point.z, z, "z");
        const auto check = core_->lagrangian();
        nb::dict answer;
        answer["objective"] = core_->values().objective;
        answer["defects"] = flat(core_->values().defects), answer["rows"] = of_rows(core_->values().rows);
        answer["gradient"] = flat(check.gradient);
        answer["hessian"] = tightspot::table(check.hessian, point.v.size());
        return answer;
    }

   private:
    nb::object of_rows(const Vector& values) const { return flat(core_->in_order(values)); }

    void fill_rows(Vector& into, const Array& from, const char* what) {
        Vector ordered(into.size());
        fill(ordered, from, what);
        core_->put_in_place(ordered, into);
    }

    std::unique_ptr<InteriorPoint<Model>> core_;
};

template <class Model>
void bind_model(nb::module_& m, const char* name) {
    nb::class_<Solver<Model>>(m, name)
        .def(nb::init<nb::handle>(), "problem"_a)
        .def_prop_ro("sizes", &Solver<Model>::sizes)
        .def("set", &Solver<Model>::set, "v"_a)
        .def("set_ends", &Solver<Model>::set_ends, "start"_a, "goal"_a)
        .def("set_multipliers", &Solver<Model>::set_multipliers, "s"_a, "z"_a, "zb"_a, "lam"_a, "nu"_a)
        .def("solve", &Solver<Model>::solve, "options"_a, "callback"_a = nb::none())
        .def_static("solve_many", &solve_many<Model>, "problems"_a, "starts"_a, "options"_a, "threads"_a, "seconds"_a)
        .def("derivatives", &Solver<Model>::derivatives, "v"_a, "lam"_a, "z"_a);
}

}  // namespace

#ifndef TIGHTSPOT_BIND_STAGEWISE
#define TIGHTSPOT_BIND_STAGEWISE bind_stagewise
#endif

void TIGHTSPOT_BIND_STAGEWISE(nb::module_& m) {
    nb::class_<Options>(m, "StagewiseOptions")
        .def(nb::init<>())
        .def_rw("tolerance", &Options::tolerance)
        .def_rw("acceptable_tolerance", &Options::acceptable_tolerance)
        .def_rw("acceptable_iterations", &Options::acceptable_iterations)
        .def_rw("max_iterations", &Options::max_iterations)
        .def_rw("time_limit", &Options::time_limit)
        .def_rw("initial_barrier", &Options::initial_barrier)
        .def_rw("bound_push", &Options::bound_push)
        .def_rw("slack_push", &Options::slack_push)
        .def_rw("second_order_correction", &Options::second_order_correction)
        .def_rw("warm", &Options::warm);
    bind_model<SingleTrack>(m, "StagewiseSingleTrack");
    nb::class_<Clearances>(m, "Clearances")
        .def(nb::init<double, double, double, bool, bool>(), "margin"_a, "end_margin"_a, "workspace_margin"_a,
             "start_given"_a, "goal_given"_a);
    m.def("stagewise_rows", &rows, "active"_a, "walls"_a, "normals"_a, "offsets"_a, "poses"_a, "clearances"_a);
    m.def("stagewise_start_lines", &start_lines, "states"_a, "pieces"_a, "whole"_a, "part_vertices"_a, "part_first"_a,
          "obstacle_vertices"_a, "obstacle_first"_a, "pairs"_a, "motion_obstacles"_a, "motion_poses"_a);
}
