// The judge for Python: a motion, the body on it, barriers, and lines that keep the two apart at all times.
#include "judge.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "tightspot/judge/cover.hpp"
#include "tightspot/judge/sampled.hpp"
#include "tightspot/judge/single_track.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace tightspot;
using namespace tightspot::judge;

namespace {

using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Rows2 = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Rows3 = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Rows3OfParts = nb::ndarray<const double, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;

void need(bool holds, const char* sentence) {
    if (!holds) throw nb::value_error(sentence);
}

std::vector<double> copied(const Numbers& numbers) { return {numbers.data(), numbers.data() + numbers.size()}; }

std::vector<double> copied(const Rows& rows) { return {rows.data(), rows.data() + rows.size()}; }

/// Polygon i has the vertices from first[i] to first[i + 1].
std::vector<Outline> outlines(const Rows2& vertices, const Indices& first) {
    std::vector<Outline> all;
    for (std::size_t i = 0; i + 1 < first.size(); ++i) {
        need(first(i) >= 0 && first(i + 1) - first(i) >= 3 && first(i + 1) <= static_cast<std::int64_t>(vertices.shape(0)),
             "a polygon needs at least three vertices, one after the other");
        std::vector<Point> points;
        for (std::int64_t v = first(i); v < first(i + 1); ++v) points.push_back({vertices(v, 0), vertices(v, 1)});
        all.emplace_back(std::move(points));
    }
    return all;
}

Walls walls(const Rows2& normals, const Numbers& supports) {
    need(normals.shape(0) == supports.size(), "each edge needs a normal and a support");
    Walls result;
    for (std::size_t i = 0; i < supports.size(); ++i) {
        result.normals.push_back({normals(i, 0), normals(i, 1)});
        result.supports.push_back(supports(i));
    }
    return result;
}

Outline outline(const Rows2& vertices) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < vertices.shape(0); ++i) points.push_back({vertices(i, 0), vertices(i, 1)});
    return Outline(std::move(points));
}

std::vector<Pose> to_poses(const Rows3& rows) {
    std::vector<Pose> result;
    for (std::size_t i = 0; i < rows.shape(0); ++i) result.push_back({rows(i, 0), rows(i, 1), rows(i, 2)});
    return result;
}

nb::tuple told(Nearness found) {
    return nb::make_tuple(column(std::vector<std::int64_t>(found.near.begin(), found.near.end())),
                          column(std::move(found.apart)), column(std::move(found.clearances)),
                          column(std::move(found.depths)));
}

nb::tuple nearness_of(const Rows2& vertices, const Indices& first, const Rows3OfParts& poses, std::int64_t per_interval,
                      const Obstacles& obstacles, const Walls& walls, double far) {
    const std::vector<Outline> parts = outlines(vertices, first);
    const std::size_t samples = poses.shape(1);
    need(!parts.empty() && parts.size() == poses.shape(0), "each part needs poses");
    need(per_interval >= 1 && samples > 1 && (samples - 1) % static_cast<std::size_t>(per_interval) == 0,
         "the samples must be so many an interval, and one at the end");
    std::vector<SampledPart> bodies;
    std::vector<std::size_t> at;
    for (std::size_t s = 0; s < samples; s += static_cast<std::size_t>(per_interval)) at.push_back(s);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        std::vector<Pose> places;
        places.reserve(samples);
        for (std::size_t s = 0; s < samples; ++s) places.push_back({poses(i, s, 0), poses(i, s, 1), poses(i, s, 2)});
        bodies.emplace_back(parts[i], places, at);
    }
    return told(nearness(bodies, obstacles, walls, far));
}

/// The same at the nodes of a motion.
template <class Model>
nb::tuple nearness_along(const Motion<Model>& motion, const Rows2& vertices, const Indices& first, const Indices& frames,
                         const Obstacles& obstacles, const Walls& walls, double far) {
    const std::vector<Outline> parts = outlines(vertices, first);
    need(!motion.nodes.empty(), "integrate first");
    need(!parts.empty() && parts.size() == frames.size(), "each part needs a frame");
    std::vector<SampledPart> bodies;
    std::vector<std::size_t> at;
    for (int k = 0; k <= motion.intervals(); ++k) at.push_back(motion.node_at(k));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        need(frames(i) >= 0 && frames(i) < Model::frames, "the model has no such frame");
        std::vector<Pose> places;
        places.reserve(motion.node_states.size());
        for (const auto& state : motion.node_states) places.push_back(motion.model.frame(state.data(), static_cast<int>(frames(i))));
        bodies.emplace_back(parts[i], places, at);
    }
    return told(nearness(bodies, obstacles, walls, far));
}

nb::dict report(const Cover& cover) {
    std::vector<std::int64_t> pair;
    std::vector<double> start, end, normal, support, proved, seen, seen_at;
    std::vector<std::uint8_t> holds;
    for (const Piece& piece : cover.pieces) {
        pair.push_back(piece.pair), start.push_back(piece.start), end.push_back(piece.end);
        normal.push_back(piece.normal.x), normal.push_back(piece.normal.y);
        support.push_back(piece.support), proved.push_back(piece.proved);
    }
    for (const Sight& sight : cover.pairs)
        seen.push_back(sight.clearance), seen_at.push_back(sight.time), holds.push_back(sight.holds);
    nb::dict answer;
    answer["pair"] = column(std::move(pair)), answer["start"] = column(std::move(start));
    answer["end"] = column(std::move(end)), answer["normal"] = table(std::move(normal), 2);
    answer["support"] = column(std::move(support)), answer["proved"] = column(std::move(proved));
    answer["holds"] = column(std::move(holds));
    answer["seen"] = column(std::move(seen)), answer["seen_at"] = column(std::move(seen_at));
    return answer;
}

template <class Model>
Motion<Model> motion_of(const Numbers& t, const Numbers& start, const Rows& inputs, const Numbers& parameters) {
    need(t.size() >= 2, "a motion needs two knots");
    need(start.size() == Model::states, "the first state does not fit the model");
    need(inputs.shape(0) + 1 == t.size() && inputs.shape(1) == Model::inputs, "the inputs do not fit knots and model");
    need(parameters.size() == Model::parameters, "the parameters do not fit the model");
    typename Motion<Model>::State first;
    std::copy(start.data(), start.data() + start.size(), first.begin());
    return Motion<Model>(Model(parameters.data()), copied(t), first, copied(inputs));
}

template <class Model>
Table states(const std::vector<typename Motion<Model>::State>& from) {
    std::vector<double> values;
    for (const auto& state : from) values.insert(values.end(), state.begin(), state.end());
    return table(std::move(values), Model::states);
}

template <class Model>
void bind_motion(nb::module_& m, const char* name) {
    using M = Motion<Model>;
    nb::class_<M>(m, name)
        .def(
            "__init__",
            [](M* self, const Numbers& t, const Numbers& start, const Rows& inputs, const Numbers& parameters) {
                new (self) M(motion_of<Model>(t, start, inputs, parameters));
            },
            "t"_a, "start"_a, "inputs"_a, "parameters"_a)
        .def("integrate", &M::integrate, "accuracy"_a, nb::call_guard<nb::gil_scoped_release>())
        .def("at",
             [](const M& self, const Numbers& times) {
                 need(!self.nodes.empty(), "integrate first");
                 std::vector<typename M::State> found;
                 for (std::size_t i = 0; i < times.size(); ++i) found.push_back(self.at(times(i)));
                 return states<Model>(found);
             })
        .def("nearness", &nearness_along<Model>, "vertices"_a, "first"_a, "frames"_a, "obstacles"_a, "walls"_a, "far"_a)
        .def_prop_ro(
            "substeps",
            [](const M& self) { return column(std::vector<std::int64_t>(self.substeps.begin(), self.substeps.end())); },
            nb::rv_policy::automatic)
        .def_prop_ro("nodes", [](const M& self) { return column(self.nodes); }, nb::rv_policy::automatic)
        .def_prop_ro(
            "node_states", [](const M& self) { return states<Model>(self.node_states); }, nb::rv_policy::automatic)
        .def_prop_ro(
            "knots",
            [](const M& self) {
                std::vector<typename M::State> found;
                for (int k = 0; !self.nodes.empty() && k <= self.intervals(); ++k) found.push_back(self.knot(k));
                return states<Model>(found);
            },
            nb::rv_policy::automatic)
        .def_prop_ro(
            "extremes",
            [](const M& self) {
                need(!self.nodes.empty(), "integrate first");
                const auto [low, high] = self.extremes();
                return states<Model>({low, high});
            },
            nb::rv_policy::automatic)
        .def(
            "apart",
            [](const M& self, const Rows& record) {
                need(!self.nodes.empty() && static_cast<int>(record.shape(0)) == self.intervals() + 1 &&
                         record.shape(1) == Model::states,
                     "the record does not fit the motion");
                const auto [position, furthest] = self.apart(record.data());
                return std::pair(position, column(std::vector<double>(furthest.begin(), furthest.end())));
            },
            "record"_a)
        .def_ro("position_error", &M::position_error)
        .def_ro("heading_error", &M::heading_error);
}

template <class Model>
void bind_body(nb::module_& m, const char* name) {
    using B = Body<Model>;
    nb::class_<B>(m, name).def(
        "__init__",
        [](B* self, const Motion<Model>& motion, const Rows2& vertices, const Indices& first, const Indices& frames,
           const Numbers& radii, const Numbers& pads, double reserve) {
            need(!motion.nodes.empty(), "integrate the motion first");
            std::vector<Outline> all = outlines(vertices, first);
            need(all.size() == frames.size() && all.size() == radii.size() && all.size() == pads.size(),
                 "each part needs a frame, a radius and a pad");
            std::vector<Part> parts;
            for (std::size_t i = 0; i < all.size(); ++i) {
                need(frames(i) >= 0 && frames(i) < Model::frames, "the model has no such frame");
                parts.push_back({std::move(all[i]), static_cast<int>(frames(i)), radii(i), pads(i)});
            }
            new (self) B(motion, std::move(parts), reserve);
        },
        "motion"_a, "vertices"_a, "first"_a, "frames"_a, "radii"_a, "pads"_a, "reserve"_a, nb::keep_alive<1, 2>());
}

template <class Model, class Barriers>
void bind_cover(nb::module_& m) {
    m.def(
        "judge_cover",
        [](const Body<Model>& body, const Barriers& barriers, const Task& task) {
            Cover cover;
            {
                nb::gil_scoped_release release;
                cover = Search<Model, Barriers>(body, barriers, task).run();
            }
            return report(cover);
        },
        "body"_a, "barriers"_a, "task"_a);
    m.def(
        "judge_worst_moments",
        [](const Body<Model>& body, const Barriers& barriers, const Indices& pairs, const Numbers& times,
           const Numbers& clearances) {
            need(pairs.size() == times.size() && pairs.size() == clearances.size(), "lists of different lengths");
            std::vector<double> at, worst;
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                need(pairs(i) >= 0 && pairs(i) < static_cast<std::int64_t>(body.parts.size() * barriers.size()),
                     "there is no such pair");
                const Sight found =
                    worst_moment(body, barriers, static_cast<int>(pairs(i)), {clearances(i), times(i), false});
                at.push_back(found.time), worst.push_back(found.clearance);
            }
            return std::pair(column(std::move(at)), column(std::move(worst)));
        },
        "body"_a, "barriers"_a, "pairs"_a, "times"_a, "clearances"_a);
}

template <class Model>
void bind_model(nb::module_& m, const std::string& name) {
    bind_motion<Model>(m, ("Judge" + name + "Motion").c_str());
    bind_body<Model>(m, ("Judge" + name + "Body").c_str());
    bind_cover<Model, Obstacles>(m);
    bind_cover<Model, Walls>(m);
}

}  // namespace

void bind_judge(nb::module_& m) {
    nb::class_<Accuracy>(m, "JudgeAccuracy")
        .def(nb::init<>())
        .def_rw("tolerance", &Accuracy::tolerance)
        .def_rw("first_step", &Accuracy::first_step)
        .def_rw("max_steps", &Accuracy::max_steps)
        .def_rw("largest", &Accuracy::largest)
        .def_rw("reserve", &Accuracy::reserve)
        .def_rw("rounding", &Accuracy::rounding);
    nb::class_<Task>(m, "JudgeTask")
        .def(nb::init<>())
        .def_rw("demand", &Task::demand)
        .def_rw("resolution", &Task::resolution)
        .def_rw("floor", &Task::floor)
        .def_rw("tolerance", &Task::tolerance)
        .def_rw("worst", &Task::worst)
        .def_rw("most_open", &Task::most_open);
    nb::class_<Obstacles>(m, "JudgeObstacles")
        .def(
            "__init__",
            [](Obstacles* self, const Rows2& vertices, const Indices& first) {
                new (self) Obstacles(outlines(vertices, first));
            },
            "vertices"_a, "first"_a);
    nb::class_<Walls>(m, "JudgeWalls")
        .def(
            "__init__",
            [](Walls* self, const Rows2& normals, const Numbers& supports) { new (self) Walls(walls(normals, supports)); },
            "normals"_a, "supports"_a);
    m.def(
        "sampled_clearances",
        [](const Rows2& part, const Rows3& poses, const Obstacles& obstacles, double far) {
            need(part.shape(0) >= 3, "a part needs at least three vertices");
            return column(sampled_clearances(outline(part), to_poses(poses), obstacles, far));
        },
        "part"_a, "poses"_a, "obstacles"_a, "far"_a);
    m.def(
        "sampled_depths",
        [](const Rows2& part, const Rows3& poses, const Walls& walls) {
            return column(sampled_depths(outline(part), to_poses(poses), walls));
        },
        "part"_a, "poses"_a, "walls"_a);
    m.def("sampled_nearness", &nearness_of, "vertices"_a, "first"_a, "poses"_a, "per_interval"_a, "obstacles"_a,
          "walls"_a, "far"_a);
    bind_model<SingleTrack>(m, "SingleTrack");
}
