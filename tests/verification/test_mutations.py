"""Real plans altered in any field, with the old digest and with one that the forger computed anew.

With the old digest nothing passes. With a new one an alteration may pass only if what the file claims is still true,
which the independent replay of :mod:`benchmarks.replay` (its own integration, shapely) and dense samples of every
line decide; and only in the places listed in ``HARMLESS``.
"""

import copy
import dataclasses
import fnmatch
import functools
import json
import math
import random

import numpy as np
import pytest
from benchmarks.replay import integrate, replay

import tightspot
from tightspot.cli import main
from tightspot.errors import TightspotError
from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario
from tightspot.verification import Plan, check_certificate, save_plan, verify
from tightspot.verification import replay as own_replay
from tightspot.verification.certificate import digest

SECTIONS = ("scenario", "vehicle", "trajectory", "certificate")

HARMLESS = {
    "scenario": "what is left out gets its default, such as a workspace in which the body still stays",
    "scenario.name": "a name",
    "scenario.description": "for people",
    "scenario.source": "for people",
    "scenario.vehicle": "a recommendation; the claim is about the file's vehicle",
    "scenario.margin": "a recommendation; the claim is about the certificate's margin",
    "scenario.workspace*": "another workspace, in which the body stays as well",
    "scenario.obstacles.#.vertices": "a corner named twice is the same obstacle",
    "vehicle": "what is left out gets its default name or source",
    "vehicle.name": "a name",
    "vehicle.source": "for people",
    "vehicle.limits*": "other limits, which the motion keeps as well",
    "vehicle.body*": "another body, which the same lines clear",
    "trajectory.states.*": "less than the 2e-7 that two integrations may differ by",
    "trajectory.inputs.*": "an input so small that the motion changes by less than that",
    "certificate.version": "for information",
    "certificate.integration*": "for information",
    "certificate.checks.#.sentence": "for people",
    "certificate.checks.#.value": "within 2e-7 of the checker's own number, or a weaker bound",
    "certificate.pairs.#.*": "a line moved within its gap, a cut moved where both lines hold, a weaker bound",
    "certificate.workspace.#.*": "a cut moved where both bounds hold, a weaker bound",
}
"""Where an alteration with a new digest may leave the claim true, and why."""


def scene(obstacles, goal, *, offset=(0.0, 0.0), vehicle="tpcap", margin=0.05):
    """A start at the offset, a goal and rings relative to it."""
    at = np.asarray(offset, float)
    return Scenario.from_dict(
        {
            "name": "test",
            "vehicle": vehicle,
            "margin": margin,
            "workspace": (np.array([(-6.0, -8.0), (14.0, -8.0), (14.0, 8.0), (-6.0, 8.0)]) + at).tolist(),
            "obstacles": [{"name": f"o{i}", "vertices": (np.array(o) + at).tolist()} for i, o in enumerate(obstacles)],
            "start": {"x": at[0], "y": at[1], "theta": 0.0},
            "goal": {"x": at[0] + goal[0], "y": at[1] + goal[1], "theta": goal[2]},
        }
    )


BOX = [(3.0, 1.1), (4.0, 1.1), (4.0, 2.5), (3.0, 2.5)]
WEDGE = [(5.0, -1.0), (7.0, -3.0), (3.0, -3.0)]
CASES = {
    "vertical": lambda: tightspot.plan("vertical"),
    "three-part": lambda: tightspot.plan(scene([BOX, WEDGE], (6.0, 0.5, 0.1), vehicle="forklift", margin=0.02)),
    "far": lambda: tightspot.plan(scene([BOX, WEDGE], (7.0, 0.3, 0.0), offset=(1.0e6 + 0.3, 2.0e6 + 0.7))),
    "empty": lambda: tightspot.plan(scene([], (5.0, 1.0, 0.2))),
}


@pytest.fixture(scope="module")
def files():
    """The plan files' objects, by name, as reading them back gives them."""
    made = {}
    for name, make in CASES.items():
        made[name] = json.loads(json.dumps(make().to_dict()))
        assert answer(made[name]).ok
        assert claims_hold(made[name])
    return made


def answer(data):
    """The checker's answer about a file's object."""
    return checked(Plan.from_dict(data))


def checked(plan):
    return check_certificate(plan.scenario, plan.vehicle, plan.trajectory, plan.certificate)


def forged(data):
    """The object with its digest computed anew, from what the reader makes of it."""
    data["certificate"]["digest"] = new_digest(Plan.from_dict(data).to_dict())
    return data


def new_digest(written):
    return digest(*(written[key] for key in SECTIONS))


# The oracle: does the file say the truth?


def claims_hold(data):
    """Whether everything that the certificate claims is true, by an integration and a geometry not our own."""
    plan = Plan.from_dict(data)
    claim, written = plan.certificate, plan.to_dict()
    fine, rows = replayed(json.dumps({key: written[key] for key in SECTIONS[:3]}), tuple(plan.scenario.offset))
    promised = max(claim.margin, claim.clearance if plan.scenario.obstacles else 0.0)
    start = [abs(a - b) for a, b in zip(plan.trajectory.states[0], plan.scenario.start, strict=True)]
    values = {check.name: check.value for check in claim.checks}
    return (
        claim.certified
        and not claim.witnesses
        and fine.problems(promised) == []
        and max(start) < 2e-6
        and abs(values["goal position"] - fine.goal_position) < 1e-6
        and abs(values["goal heading"] - fine.goal_heading) < 1e-6
        and lines_hold(plan, rows)
    )


@functools.lru_cache(maxsize=8)
def replayed(text, origin):
    """The replay of a file without its certificate, and the motion in steps of 1 ms relative to the origin."""
    file = json.loads(text)
    return replay(file), integrate(file, np.array(origin))[0]


def lines_hold(plan, rows):
    """Whether each line separates what it says by as much as it says, in a hundred samples of each interval."""
    bodies = {part.name: part.polygon.vertices for part in plan.vehicle.parts}
    obstacles = dict(plan.scenario.obstacle_parts)
    for proof in plan.certificate.pairs:
        corners = obstacles[proof.obstacle].vertices
        for i, (t0, t1) in enumerate(zip(proof.t, proof.t[1:], strict=False)):
            n = np.array([proof.nx[i], proof.ny[i]])
            beyond = placed(bodies[proof.part], sampled(rows, t0, t1)) @ n - proof.c[i]
            below = proof.c[i] - corners @ n
            above, below = beyond.min(initial=np.inf), below.min()
            if min(above, below) < -1e-6 or above + below < proof.clearance[i] - 1e-6:
                return False
    W = plan.scenario.workspace
    for proof in plan.certificate.workspace:
        for i, (t0, t1) in enumerate(zip(proof.t, proof.t[1:], strict=False)):
            inside = W.b[proof.edge] - placed(bodies[proof.part], sampled(rows, t0, t1)) @ W.A[proof.edge]
            if inside.min(initial=np.inf) < proof.clearance[i] - 1e-6:
                return False
    return True


def sampled(rows, t0, t1):
    """At most a hundred poses of the rows within [t0, t1]."""
    first, last = np.searchsorted(rows[:, 0], t0 - 1e-9), np.searchsorted(rows[:, 0], t1 + 1e-9) - 1
    return (
        rows[np.unique(np.linspace(first, max(first, last), 100).astype(int)), 1:4] if first <= last else rows[:0, 1:4]
    )


def placed(corners, poses):
    x, y, theta = poses.T[:, :, None]
    c, s = np.cos(theta), np.sin(theta)
    return np.stack([x + c * corners[:, 0] - s * corners[:, 1], y + s * corners[:, 0] + c * corners[:, 1]], axis=-1)


# Walking through a file.


def places(value, path=(), ends_only=True):
    """Paths of all values; of lists the first, a middle and the last entry, or all."""
    if path:
        yield path
    if isinstance(value, dict):
        for key in value:
            yield from places(value[key], (*path, key), ends_only)
    elif isinstance(value, list):
        some = {0, len(value) // 2, len(value) - 1} if ends_only and len(value) > 3 else set(range(len(value)))
        for index in sorted(some & set(range(len(value)))):
            yield from places(value[index], (*path, index), ends_only)


def at(data, path):
    for key in path:
        data = data[key]
    return data


def alterations(value):
    """What may be put in a value's place."""
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int | float):
        return [value * 1.001, value * 0.999, value + 1.0, value - 1.0, -value, None, str(value)]
    if isinstance(value, str):
        return [value + "'", "", None, 0]
    if isinstance(value, list):
        return [value[:-1], value[1:], [*value, *value[-1:]], [*value[:1], *value], value[::-1], None]
    if isinstance(value, dict):
        without = [{k: v for k, v in value.items() if k != key} for key in value]
        renamed = [{(k + "_" if k == key else k): v for k, v in value.items()} for key in value]
        return [*without, *renamed, {**value, "more": 1}, None]
    return [1.0]


def altered(data, path, value):
    """A copy that shares with the original what is not on the path."""
    if not path:
        return value
    new = dict(data) if isinstance(data, dict) else list(data)
    new[path[0]] = altered(data[path[0]], path[1:], value)
    return new


def pattern(path):
    return ".".join("#" if isinstance(key, int) else key for key in path)


def harmless(path):
    return any(fnmatch.fnmatchcase(pattern(path), known.replace("[", "[[]")) for known in HARMLESS)


def survivors(data, paths, choose=lambda values: values):
    """(path, value, verdict) of each alteration that passes; the verdict says with which digest, and if it is true."""
    original = Plan.from_dict(data).to_dict()
    for path in paths:
        for value in choose(alterations(at(data, path))):
            file = altered(data, path, value)
            try:
                plan = Plan.from_dict(file)
            except TightspotError:
                continue
            written = plan.to_dict()
            if written == original:
                continue
            if checked(plan).ok:
                yield path, value, "old digest"
            certificate = dataclasses.replace(plan.certificate, digest=new_digest(written))
            if path != ("certificate", "digest") and checked(dataclasses.replace(plan, certificate=certificate)).ok:
                yield path, value, "true" if claims_hold(file) else "false"


def assert_rejected_or_true(data, paths, choose=lambda values: values):
    """Nothing passes with the old digest; with a new one only what is true, in the places listed."""
    passed = list(survivors(data, paths, choose))
    assert [entry for entry in passed if entry[2] != "true"] == []
    assert {pattern(path) for path, _, _ in passed if not harmless(path)} == set()
    return passed


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("section", SECTIONS)
def test_an_altered_field_is_rejected_or_leaves_the_claim_true(files, name, section):
    rng = random.Random(f"{name} {section}")
    data = files[name]
    paths = [path for path in places(data) if path[0] == section]
    assert len(paths) > 15
    assert_rejected_or_true(data, paths, lambda values: [rng.choice(values)])


@pytest.mark.slow
def test_every_field_altered_once_is_rejected_or_leaves_the_claim_true(files):
    """Every number, text, list and object of a file, each altered in one way."""
    rng, data = random.Random(2), files["three-part"]
    paths = [path for path in places(data, ends_only=False) if path[0] in SECTIONS]
    passed = assert_rejected_or_true(data, paths, lambda values: [rng.choice(values)])
    assert len(passed) > 50


def test_the_command_line_answers_1_or_2(files, tmp_path, capsys):
    """Neither 0 nor an internal error, whatever is altered; the report alone is not covered."""
    data, rng, path = files["three-part"], random.Random(0), tmp_path / "plan.json"
    original = Plan.from_dict(data).to_dict()
    codes = []
    for place in rng.sample([p for p in places(data) if p[0] != "report"], 40):
        file = altered(data, place, rng.choice(alterations(at(data, place))))
        try:
            if Plan.from_dict(file).to_dict() == original:
                continue
        except TightspotError:
            pass
        path.write_text(json.dumps(file))
        codes.append(main(["verify", str(path)]))
    assert set(codes) == {1, 2}
    assert "internal error" not in capsys.readouterr().err
    path.write_text(json.dumps({**data, "report": {}}))
    assert main(["verify", str(path)]) == 0


# A forger who keeps the file consistent: what he alters in one place he alters wherever it is repeated.


def raise_clearances(data, by):
    claim = data["certificate"]
    claim["clearance"] += by
    claim["checks"][0]["value"] += by
    for proof in claim["pairs"]:
        proof["clearance"] = [value + by for value in proof["clearance"]]


def raise_margin(data, by):
    data["certificate"]["margin"] += by
    data["certificate"]["checks"][0]["limit"] += by


def move_obstacle(data, by):
    """All of the first obstacle, in the scene and where the certificate lists its parts."""
    owner = data["scenario"]["obstacles"][0]
    for part in [owner, *(p for p in data["certificate"]["obstacles"] if p["name"].startswith(owner["name"] + "/"))]:
        part["vertices"] = [[x + by, y + by / 3] for x, y in part["vertices"]]


def scale_body(data, by):
    for part in data["vehicle"]["body"]:
        part["vertices"] = [[(1 + by) * x, (1 + by) * y] for x, y in part["vertices"]]


def rename_obstacle(data, by):
    name = data["scenario"]["obstacles"][0]["name"]
    data["scenario"]["obstacles"][0]["name"] = "new"
    for entry in data["certificate"]["obstacles"]:
        entry["name"] = entry["name"].replace(f"{name}/", "new/")
    for proof in data["certificate"]["pairs"]:
        proof["obstacle"] = proof["obstacle"].replace(f"{name}/", "new/")


def swap_obstacles(data, by):
    """Their shapes, in the scene and in the certificate; the names and lines stay."""
    for entries in (data["scenario"]["obstacles"], data["certificate"]["obstacles"]):
        entries[0]["vertices"], entries[1]["vertices"] = entries[1]["vertices"], entries[0]["vertices"]


def steer_differently(data, by):
    """Other inputs, with the knots and all checks that follow from them."""
    omega = data["trajectory"]["inputs"]["omega"]
    omega[len(omega) // 2] += by
    drive_again(data)


def stretch_time(data, by):
    """Slower, with the cuts of the proofs."""
    data["trajectory"]["t"] = [(1 + by) * t for t in data["trajectory"]["t"]]
    for proof in [*data["certificate"]["pairs"], *data["certificate"]["workspace"]]:
        proof["t"] = [(1 + by) * t for t in proof["t"]]
    for proof in [*data["certificate"]["pairs"], *data["certificate"]["workspace"]]:
        proof["t"][-1] = data["trajectory"]["t"][-1]
    drive_again(data)


def drive_again(data):
    """Knots by replay, checks by the judge; the lines and the clearances stay."""
    plan = Plan.from_dict(data)
    states = own_replay(plan.vehicle, plan.trajectory).knots
    trajectory = dataclasses.replace(plan.trajectory, states=states)
    judged = verify(plan.scenario, plan.vehicle, trajectory, margin=plan.certificate.margin)
    data["trajectory"] = trajectory.shifted(plan.scenario.offset).to_dict()
    data["certificate"]["checks"][2:] = [dataclasses.asdict(check) for check in judged.checks[2:]]


def turn_lines(data, by):
    for proof in data["certificate"]["pairs"]:
        angles = [math.atan2(y, x) + by for x, y in zip(proof["nx"], proof["ny"], strict=True)]
        proof["nx"], proof["ny"] = [math.cos(a) for a in angles], [math.sin(a) for a in angles]


def claim_what_samples_show(data, by):
    """Every pair gets the clearance that its line shows at the ends of its intervals, as a naive judge would."""
    plan = Plan.from_dict(data)
    rows, _ = integrate(plan.to_dict(), np.array(plan.scenario.offset))
    bodies, obstacles = {part.name: part.polygon.vertices for part in plan.vehicle.parts}, plan.scenario.obstacle_parts
    for proof, stored in zip(plan.certificate.pairs, data["certificate"]["pairs"], strict=True):
        ends = rows[np.searchsorted(rows[:, 0], proof.t - 1e-9), 1:4]
        n = np.stack([proof.nx, proof.ny], axis=1)
        corners = placed(bodies[proof.part], ends)
        lowest = np.minimum(*((side @ n[:, :, None]).min(axis=(1, 2)) for side in (corners[:-1], corners[1:])))
        stored["clearance"] = (lowest - (dict(obstacles)[proof.obstacle].vertices @ n.T).max(axis=0)).tolist()
    data["certificate"]["clearance"] = min(min(p["clearance"]) for p in data["certificate"]["pairs"])
    data["certificate"]["checks"][0]["value"] = data["certificate"]["clearance"]


FORGERIES = {
    raise_clearances: (0.002, 0.05),
    raise_margin: (0.05, 1.0),
    move_obstacle: (1e-4, -1e-4, 0.02, -0.05, 0.5, -0.5),
    scale_body: (-0.2, -1e-3, 1e-4, 0.02, 0.1),
    rename_obstacle: (0,),
    swap_obstacles: (0,),
    steer_differently: (1e-5, 1e-3, -1e-2),
    stretch_time: (1e-6, -1e-4, 0.01),
    turn_lines: (1e-6, 1e-3, -0.1),
    claim_what_samples_show: (0,),
}
TRUE_FORGERIES = {"rename_obstacle", "scale_body"}
FALSE_FORGERIES = {"raise_clearances", "claim_what_samples_show", "swap_obstacles", "stretch_time"}


@pytest.mark.parametrize("name", ["vertical", "three-part", "far"])
@pytest.mark.parametrize("forgery", FORGERIES, ids=lambda forgery: forgery.__name__)
def test_a_consistent_forgery_passes_only_if_it_is_true(files, name, forgery):
    outcomes = {}
    for by in FORGERIES[forgery]:
        data = copy.deepcopy(files[name])
        forgery(data, by)
        try:
            outcomes[by] = answer(forged(data)).ok
        except TightspotError:
            outcomes[by] = False
        assert not outcomes[by] or claims_hold(data), (by, "a false claim passes")
    if forgery.__name__ in FALSE_FORGERIES:
        assert not any(outcomes.values()), outcomes
    if forgery.__name__ in TRUE_FORGERIES and name != "three-part":  # whose tines come nearer to the middle
        assert outcomes[FORGERIES[forgery][0]], outcomes
    largest = max(outcomes, key=abs)
    assert forgery.__name__ in TRUE_FORGERIES or not outcomes[largest], outcomes


def nudge_knot(data, name, by):
    column = data["trajectory"]["states"][name]
    column[len(column) // 2] += by


@pytest.mark.parametrize("name", ["x", "y", "theta", "v", "delta"])
@pytest.mark.parametrize("by", [1e-6, 1e-3, 0.1])
def test_a_nudged_knot_is_rejected_whatever_the_digest(files, name, by):
    data = copy.deepcopy(files["three-part"])
    nudge_knot(data, name, by)
    reasons = answer(forged(data)).reasons
    group = {"x": "position", "y": "position", "theta": "heading", "v": "speed", "delta": "steering"}[name]
    assert any(f"dynamics {group}" in reason for reason in reasons)


def test_a_knot_of_another_speed_is_refused_by_the_judge(files):
    data = copy.deepcopy(files["three-part"])
    v = data["trajectory"]["states"]["v"]
    nudge_knot(data, "v", -math.copysign(0.006, v[len(v) // 2]))
    plan = Plan.from_dict(data)
    judged = verify(plan.scenario, plan.vehicle, plan.trajectory)
    assert [check.name for check in judged.failed] == ["dynamics speed"]
    assert judged.check("dynamics speed").value == pytest.approx(0.006, abs=1e-9)


def test_the_certificate_of_one_plan_does_not_serve_another(files):
    for name, other in (("vertical", "empty"), ("empty", "three-part"), ("three-part", "far")):
        data = copy.deepcopy(files[name])
        data["certificate"] = copy.deepcopy(files[other]["certificate"])
        assert not answer(forged(data)).ok


def test_an_obstacle_that_appears_is_not_covered(files, tmp_path):
    """The certificate of the empty scene, after a wall was put across the way; the file is written and read."""
    plan = Plan.from_dict(files["empty"])
    wall = Obstacle("wall", ConvexPolygon.rectangle(4.9, 5.1, -3, 3).vertices)
    scenario = plan.scenario.with_(obstacles=(wall,))
    data = Plan(scenario, plan.vehicle, plan.trajectory, plan.certificate).to_dict()
    path = tmp_path / "plan.json"
    save_plan(Plan.from_dict(forged(data)), path)
    assert main(["verify", str(path)]) == 1
