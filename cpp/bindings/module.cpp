// tightspot._core: plain arrays in, plain arrays out. The GIL is released while the core works.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "judge.hpp"
#include "resampling.hpp"
#include "stagewise.hpp"
#include "tightspot/collision.hpp"
#include "tightspot/hybrid_astar.hpp"
#include "tightspot/path.hpp"
#include "tightspot/reeds_shepp.hpp"
#include "tightspot/rolling.hpp"
#include "tightspot/shortcut.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace tightspot;

namespace {

using Rows2 = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Rows5 = nb::ndarray<const double, nb::shape<-1, 5>, nb::c_contig, nb::device::cpu>;
using Rows3 = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Vector3 = nb::ndarray<const double, nb::shape<3>, nb::c_contig, nb::device::cpu>;

/// Ways below this, m, are none.
constexpr double shortest_way = 1e-9;

Pose to_pose(const Vector3& pose) { return {pose(0), pose(1), pose(2)}; }

Polygon to_polygon(const Rows2& vertices, std::size_t first, std::size_t last) {
    std::vector<Point> points;
    points.reserve(last - first);
    for (std::size_t i = first; i < last; ++i) points.push_back({vertices(i, 0), vertices(i, 1)});
    return Polygon(points);
}

Polygon to_polygon(const Rows2& vertices) { return to_polygon(vertices, 0, vertices.shape(0)); }

/// Polygon i has the vertices from first[i] to first[i + 1].
std::vector<Polygon> to_polygons(const Rows2& vertices, const Indices& first) {
    std::vector<Polygon> polygons;
    for (std::size_t i = 0; i + 1 < first.size(); ++i) {
        if (first(i) < 0 || first(i) > first(i + 1) || first(i + 1) > static_cast<std::int64_t>(vertices.shape(0)))
            throw nb::value_error("the polygons' vertices must follow one another");
        polygons.push_back(to_polygon(vertices, first(i), first(i + 1)));
    }
    return polygons;
}

std::vector<Polygon> to_polygons(const std::vector<Rows2>& all) {
    std::vector<Polygon> polygons;
    for (const Rows2& vertices : all) polygons.push_back(to_polygon(vertices));
    return polygons;
}

std::vector<Arc> to_arcs(const Rows2& rows) {
    std::vector<Arc> arcs;
    for (std::size_t i = 0; i < rows.shape(0); ++i) arcs.push_back({rows(i, 0), rows(i, 1)});
    return arcs;
}

Table from_arcs(const std::vector<Arc>& arcs) {
    std::vector<double> values;
    for (const Arc& arc : arcs) values.insert(values.end(), {arc.length, arc.curvature});
    return table(std::move(values), 2);
}

Table from_poses(const std::vector<Pose>& poses) {
    std::vector<double> values;
    for (const Pose& pose : poses) values.insert(values.end(), {pose.x, pose.y, pose.theta});
    return table(std::move(values), 3);
}

std::pair<std::string, Column> from_word(const Word& word, double radius) {
    std::string kinds;
    std::vector<double> lengths;
    for (int i = 0; i < word.size; ++i) {
        kinds += word.turns[i] == Turn::left ? 'L' : word.turns[i] == Turn::right ? 'R' : 'S';
        lengths.push_back(word.lengths[i] * radius);
    }
    return {kinds, column(std::move(lengths))};
}

const char* name(Outcome outcome) {
    switch (outcome) {
        case Outcome::found:
            return "found";
        case Outcome::exhausted:
            return "exhausted";
        case Outcome::disconnected:
            return "disconnected";
        case Outcome::expansion_limit:
            return "expansion_limit";
        case Outcome::time_limit:
            return "time_limit";
        case Outcome::start_blocked:
            return "start_blocked";
        case Outcome::goal_blocked:
            return "goal_blocked";
        case Outcome::interrupted:
            break;
    }
    return "interrupted";
}

nb::dict search(const CollisionChecker& checker, const Vector3& start, const Vector3& goal,
                const SearchOptions& options, bool shortcuts) {
    const Pose from = to_pose(start), to = to_pose(goal);
    SearchResult result;
    {
        nb::gil_scoped_release release;
        HybridAStar searcher(checker, options);
        result = searcher.run(from, to, [] {
            nb::gil_scoped_acquire acquire;
            return PyErr_CheckSignals() != 0;
        });
        if (shortcuts && result.outcome == Outcome::found) {
            result.arcs = Shortcutter(checker, options.cost, options.gears).improve(from, std::move(result.arcs));
            result.cost = options.cost.path(result.arcs);
        }
    }
    if (result.outcome == Outcome::interrupted) throw nb::python_error();
    nb::dict answer;
    answer["outcome"] = name(result.outcome);
    answer["arcs"] = from_arcs(result.arcs);
    answer["cost"] = result.cost;
    answer["expansions"] = result.expansions;
    answer["nodes"] = result.nodes;
    answer["pose_checks"] = result.pose_checks;
    answer["pair_tests"] = result.pair_tests;
    answer["seconds"] = result.seconds;
    answer["blocking"] = result.contact.obstacle;
    answer["clearance"] = result.contact.clearance;
    answer["closed"] = from_poses(result.closed);
    return answer;
}

void bind_reeds_shepp(nb::module_& m) {
    m.def(
        "reeds_shepp_shortest",
        [](const Vector3& start, const Vector3& goal, double radius) {
            return from_word(reeds_shepp::shortest(to_pose(start), to_pose(goal), radius), radius);
        },
        "start"_a, "goal"_a, "radius"_a);
    m.def(
        "reeds_shepp_all",
        [](const Vector3& start, const Vector3& goal, double radius) {
            std::vector<std::pair<std::string, Column>> words;
            for (const Word& word : reeds_shepp::all(to_pose(start), to_pose(goal), radius))
                words.push_back(from_word(word, radius));
            return words;
        },
        "start"_a, "goal"_a, "radius"_a);
    m.def(
        "sample_arcs",
        [](const Vector3& start, const Rows2& arcs, double spacing) {
            std::vector<double> values;
            for (const Sample& s : sample(to_pose(start), to_arcs(arcs), spacing))
                values.insert(values.end(),
                              {s.pose.x, s.pose.y, s.pose.theta, s.curvature, static_cast<double>(s.gear)});
            return table(std::move(values), 5);
        },
        "start"_a, "arcs"_a, "spacing"_a);
}

void bind_checker(nb::module_& m) {
    nb::class_<CollisionChecker>(m, "CollisionChecker")
        .def(
            "__init__",
            [](CollisionChecker* self, const std::vector<Rows2>& parts, const Rows2& workspace,
               const Rows2& obstacles, const Indices& first, double margin) {
                new (self) CollisionChecker(Footprint(to_polygons(parts)), to_polygon(workspace),
                                            to_polygons(obstacles, first), margin);
            },
            "parts"_a, "workspace"_a, "obstacles"_a, "first"_a, "margin"_a)
        .def(
            "slack",
            [](const CollisionChecker& self, const Rows3& poses) {
                std::vector<double> slacks;
                for (std::size_t i = 0; i < poses.shape(0); ++i)
                    slacks.push_back(self.slack({poses(i, 0), poses(i, 1), poses(i, 2)}));
                return column(std::move(slacks));
            },
            "poses"_a)
        .def(
            "contact",
            [](const CollisionChecker& self, const Vector3& pose) {
                const Contact contact = self.contact(to_pose(pose));
                return std::pair<int, double>(contact.obstacle, contact.clearance);
            },
            "pose"_a)
        .def(
            "free_length",
            [](const CollisionChecker& self, const Vector3& pose, double longest, double curvature) {
                return self.free_length(to_pose(pose), longest, curvature);
            },
            "pose"_a, "longest"_a, "curvature"_a)
        .def_prop_ro("narrowest", [](const CollisionChecker& self) { return self.footprint().narrowest; })
        .def_prop_ro("pose_checks", &CollisionChecker::pose_checks)
        .def_prop_ro("pair_tests", &CollisionChecker::pair_tests);
}

/// Knot times, states and inputs of a path (x, y, theta, curvature, gear) that is driven; see rolling.hpp. Poses that do
/// not move on are left out.
nb::tuple rolling(const Rows5& path, double first, double last, const RollingLimits& limits) {
    std::vector<double> ways, gears, curvatures;
    std::vector<std::size_t> kept(1, 0);
    for (std::size_t i = 1; i < path.shape(0); ++i) {
        const double half_turn = (path(i, 2) - path(i - 1, 2)) / 2;
        const double chord = std::hypot(path(i, 0) - path(i - 1, 0), path(i, 1) - path(i - 1, 1));
        const double way = half_turn == 0 ? chord : chord * half_turn / std::sin(half_turn);
        if (!(way > shortest_way)) continue;
        ways.push_back(way), curvatures.push_back(path(i, 3)), gears.push_back(path(i, 4)), kept.push_back(i);
    }
    if (ways.empty()) throw nb::value_error("the path moves nowhere");
    const Rolling driven(ways, gears, curvatures, first, last, limits);
    std::vector<double> states, inputs;
    states.reserve(5 * kept.size()), inputs.reserve(2 * kept.size());
    for (std::size_t k = 0; k < kept.size(); ++k) {
        for (int i = 0; i < 3; ++i) states.push_back(path(kept[k], i));
        states.push_back(driven.v[k]), states.push_back(driven.delta[k]);
        if (k + 1 < kept.size()) inputs.push_back(driven.a[k]), inputs.push_back(driven.omega[k]);
    }
    return nb::make_tuple(column(driven.t), table(std::move(states), 5), table(std::move(inputs), 2));
}

void bind_rolling(nb::module_& m) {
    nb::class_<RollingLimits>(m, "RollingLimits")
        .def(nb::init<double, double, double, double, double, double, double, double>(), "wheelbase"_a, "steering"_a,
             "steering_rate"_a, "forwards"_a, "backwards"_a, "slowest"_a, "fastest"_a, "half_window"_a);
    m.def("rolling", &rolling, "path"_a, "first"_a, "last"_a, "limits"_a);
}

void bind_search(nb::module_& m) {
    nb::class_<MotionCost>(m, "MotionCost")
        .def(nb::init<>())
        .def_rw("gear_change", &MotionCost::gear_change)
        .def_rw("reverse", &MotionCost::reverse)
        .def_rw("steering", &MotionCost::steering)
        .def_rw("steering_change", &MotionCost::steering_change)
        .def_rw("full_curvature", &MotionCost::full_curvature);
    nb::class_<SearchOptions>(m, "SearchOptions")
        .def(nb::init<>())
        .def_rw("cell", &SearchOptions::cell)
        .def_rw("heading_bins", &SearchOptions::heading_bins)
        .def_rw("step", &SearchOptions::step)
        .def_rw("halvings", &SearchOptions::halvings)
        .def_rw("steering", &SearchOptions::steering)
        .def_rw("full_curvature", &SearchOptions::full_curvature)
        .def_rw("cost", &SearchOptions::cost)
        .def_rw("heuristic_weight", &SearchOptions::heuristic_weight)
        .def_rw("patience", &SearchOptions::patience)
        .def_rw("tolerance", &SearchOptions::tolerance)
        .def_prop_rw(
            "gears", [](const SearchOptions& o) { return std::pair<int, int>(o.gears.first, o.gears.last); },
            [](SearchOptions& o, std::pair<int, int> gears) { o.gears = {gears.first, gears.second}; })
        .def_rw("backward", &SearchOptions::backward)
        .def_rw("max_words", &SearchOptions::max_words)
        .def_rw("extra_expansions", &SearchOptions::extra_expansions)
        .def_rw("max_expansions", &SearchOptions::max_expansions)
        .def_rw("time_limit", &SearchOptions::time_limit)
        .def_rw("keep_closed", &SearchOptions::keep_closed);
    m.def("search", &search, "checker"_a, "start"_a, "goal"_a, "options"_a, "shortcuts"_a = true);
}

}  // namespace

NB_MODULE(_core, m) {
    m.doc() = "The compiled core of tightspot: Reeds-Shepp curves, exact collision checks, hybrid A*, the judge and the stagewise solver.";
    bind_reeds_shepp(m);
    bind_checker(m);
    bind_search(m);
    bind_rolling(m);
    bind_judge(m);
    bind_resampling(m);
#ifdef TIGHTSPOT_HAS_V3
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        bind_stagewise_v3(m);
    else
#endif
        bind_stagewise(m);
}
