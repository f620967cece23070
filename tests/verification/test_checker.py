"""The checker accepts what the judge proves and rejects every alteration, false ones by proof alone."""

import copy

import numpy as np
import pytest

from tightspot.errors import PlanFileError, TightspotError
from tightspot.scenarios import Obstacle
from tightspot.verification import Plan, check_certificate, verify, verify_plan
from tightspot.verification.certificate import digest
from tightspot.verification.checker import prove


def resealed(data):
    """The plan with its digest computed anew, as a forger would."""
    plan = Plan.from_dict(data)
    keys = ("scenario", "vehicle", "trajectory", "certificate")
    written = plan.to_dict()
    data["certificate"]["digest"] = digest(*(written[key] for key in keys))
    return Plan.from_dict(data)


def answer(plan):
    return check_certificate(plan.scenario, plan.vehicle, plan.trajectory, plan.certificate)


def leaves(data, path=()):
    """Paths of all numbers, texts, flags and nulls; of long lists the first, a middle and the last entry."""
    if isinstance(data, dict):
        for key in data:
            yield from leaves(data[key], (*path, key))
    elif isinstance(data, list):
        for index in sorted({0, len(data) // 2, len(data) - 1} & set(range(len(data)))):
            yield from leaves(data[index], (*path, index))
    else:
        yield path


def containers(data, path=()):
    """Paths of all entries of objects and lists that could be dropped."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        if isinstance(data, dict) or key in {0, len(data) // 2, len(data) - 1}:
            yield (*path, key)
            yield from containers(value, (*path, key))


def parent(data, path):
    for key in path[:-1]:
        data = data[key]
    return data


def alterations(value):
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int | float):
        return [float(np.nextafter(value, np.inf)), value + 1e-3, -value - 1.0, None, 1e30]
    if isinstance(value, str):
        return [value + "'", None, *([""] if value else [])]
    return [1.0]


def rejected(data, original=None):
    """Whether the file is refused or its certificate rejected, unless it says what the original says."""
    try:
        plan = Plan.from_dict(data)
    except TightspotError:
        return True
    return plan.to_dict() == original or not answer(plan).ok


def test_a_good_certificate_is_accepted(plan):
    assert answer(plan).ok
    assert prove(plan.scenario, plan.vehicle, plan.trajectory, plan.certificate).ok
    assert answer(Plan.from_dict(plan.to_dict())).ok
    assert verify_plan(plan).upheld
    assert plan.certificate.intervals > 30


@pytest.mark.parametrize("section", ["scenario", "vehicle", "trajectory", "certificate"])
def test_every_altered_field_is_rejected(plan, section):
    original = plan.to_dict()
    paths = list(leaves(original[section]))
    assert len(paths) > 15
    survived = []
    for path in paths:
        for value in alterations(parent(original[section], path)[path[-1]]):
            data = copy.deepcopy(original)
            parent(data[section], path)[path[-1]] = value
            if not rejected(data, original):
                survived.append((path, value))
    assert survived == []


@pytest.mark.parametrize("section", ["scenario", "trajectory", "certificate"])
def test_every_dropped_or_repeated_entry_is_rejected(plan, section):
    original = plan.to_dict()
    survived = []
    for path in containers(original[section]):
        data = copy.deepcopy(original)
        owner = parent(data[section], path)
        removed = owner.pop(path[-1])
        if not rejected(data, original):
            survived.append(path)
        if isinstance(owner, list):
            owner[path[-1] : path[-1]] = [removed, removed]
            if not rejected(data, original):
                survived.append((*path, "twice"))
    assert survived == []


def test_reordered_pairs_are_rejected(plan):
    data = copy.deepcopy(plan.to_dict())
    data["certificate"]["pairs"].reverse()
    assert rejected(data)
    assert "in order" in answer(resealed(data)).reasons[0]


def pair(data, index=2):
    """The pair of the cab and the near wall, of many intervals."""
    return data["certificate"]["pairs"][index]


def move_line(data):
    pair(data)["c"][3] += 0.2


def turn_line(data):
    angle = np.arctan2(pair(data)["ny"][3], pair(data)["nx"][3]) + 0.3
    pair(data)["nx"][3], pair(data)["ny"][3] = np.cos(angle), np.sin(angle)


def flip_line(data):
    for key in ("nx", "ny", "c"):
        pair(data)[key] = [-value for value in pair(data)[key]]


def stretch_normal(data):
    for key in ("nx", "ny", "c", "clearance"):
        pair(data)[key] = [1.01 * value for value in pair(data)[key]]


def drop_interval(data):
    del pair(data)["t"][4]
    for key in ("nx", "ny", "c", "clearance"):
        del pair(data)[key][4]


def drop_last_interval(data):
    for key in ("t", "nx", "ny", "c", "clearance"):
        del pair(data)[key][-1]


def move_cut(data):
    pair(data)["t"][5] = 0.99 * pair(data)["t"][6]
    pair(data)["t"][4] = 0.98 * pair(data)["t"][6]


def swap_cuts(data):
    t = pair(data)["t"]
    t[3], t[4] = t[4], t[3]


def raise_interval_clearance(data):
    pair(data)["clearance"] = [value + 1e-4 for value in pair(data)["clearance"]]


def raise_clearance(data):
    data["certificate"]["clearance"] += 1e-6
    data["certificate"]["checks"][0]["value"] += 1e-6


def raise_margin(data):
    data["certificate"]["margin"] = 0.2
    data["certificate"]["checks"][0]["limit"] = 0.2


def negative_margin(data):
    data["certificate"]["margin"] = -1.0


def drop_pair(data):
    del data["certificate"]["pairs"][2]


def proof_of_the_far_obstacle_for_the_near_one(data):
    pairs = data["certificate"]["pairs"]
    pairs[2] = {**pairs[3], "obstacle": pairs[2]["obstacle"]}


def swap_names(data):
    obstacles = data["scenario"]["obstacles"]
    obstacles[1]["name"], obstacles[2]["name"] = obstacles[2]["name"], obstacles[1]["name"]


def grow_obstacle(data):
    data["scenario"]["obstacles"][1]["vertices"][3][1] += 0.1
    data["scenario"]["obstacles"][1]["vertices"][2][1] += 0.1


def add_obstacle(data):
    ring = [[20.0, 20.0], [21.0, 20.0], [21.0, 21.0]]
    data["scenario"]["obstacles"].append({"name": "new", "vertices": ring})


def widen_vehicle(data):
    for vertex in data["vehicle"]["body"][0]["vertices"]:
        vertex[1] *= 1.1


def shorten_wheelbase(data):
    data["vehicle"]["wheelbase"] -= 0.02


def tighten_limits(data):
    data["vehicle"]["limits"]["acceleration"] = [-0.5, 0.5]


def nudge_input(data):
    data["trajectory"]["inputs"]["omega"][0] += 0.01


def nudge_start(data):
    data["trajectory"]["states"]["y"][0] -= 1e-5


def nudge_knot(data):
    data["trajectory"]["states"]["y"][2] += 0.006


def slow_down(data):
    data["trajectory"]["t"] = [1.01 * value for value in data["trajectory"]["t"]]


def move_goal(data):
    data["scenario"]["goal"]["x"] += 0.02


def turn_goal(data):
    data["scenario"]["goal"]["theta"] += 0.05


def move_start(data):
    data["scenario"]["start"]["x"] += 1e-5


def tighten_tolerance(data):
    data["scenario"]["tolerance"]["position"] = 0.02


def shrink_workspace(data):
    for vertex in data["scenario"]["workspace"]:
        vertex[1] = max(vertex[1], -0.7)


def raise_workspace_clearance(data):
    data["certificate"]["workspace"][0]["clearance"][0] += 10.0


def drop_workspace_edge(data):
    del data["certificate"]["workspace"][1]


def drop_check(data):
    del data["certificate"]["checks"][3]


def loosen_check(data):
    data["certificate"]["checks"][2]["limit"] = 1.0


def fail_check(data):
    data["certificate"]["checks"][4]["passed"] = False


def lie_in_check(data):
    data["certificate"]["checks"][2]["value"] = 0.004


def uncertify(data):
    data["certificate"]["certified"] = False


def add_witness(data):
    data["certificate"]["witnesses"].append(
        {
            "time": 1.0,
            "part": "cab",
            "obstacle": "o1/0",
            "clearance": -1.0,
            "pose": [0.0] * 3,
            "kind": "collision",
        }
    )


def move_coordinates(data):
    data["certificate"]["offset"] = [1.0, 0.0]


def huge_numbers(data):
    pair(data)["c"] = [1e300 for _ in pair(data)["c"]]


def huge_normals(data):
    pair(data)["nx"] = [1e300 for _ in pair(data)["nx"]]


def uneven_columns(data):
    del pair(data)["nx"][0]


def no_intervals(data):
    for key in ("t", "nx", "ny", "c", "clearance"):
        pair(data)[key] = []


def shrink_listed_obstacle(data):
    data["certificate"]["obstacles"][2]["vertices"][0][1] -= 0.1


def swap_listed_obstacles(data):
    data["certificate"]["obstacles"].reverse()


def claim_exact_integration(data):
    data["certificate"]["integration"]["position_error"] = -1.0


LIES = [
    move_line,
    turn_line,
    flip_line,
    stretch_normal,
    drop_interval,
    drop_last_interval,
    move_cut,
    swap_cuts,
    raise_interval_clearance,
    raise_clearance,
    raise_margin,
    negative_margin,
    drop_pair,
    proof_of_the_far_obstacle_for_the_near_one,
    swap_names,
    grow_obstacle,
    add_obstacle,
    widen_vehicle,
    shorten_wheelbase,
    tighten_limits,
    nudge_input,
    nudge_start,
    nudge_knot,
    slow_down,
    move_goal,
    turn_goal,
    move_start,
    tighten_tolerance,
    shrink_workspace,
    raise_workspace_clearance,
    drop_workspace_edge,
    drop_check,
    loosen_check,
    fail_check,
    lie_in_check,
    uncertify,
    add_witness,
    move_coordinates,
    huge_numbers,
    huge_normals,
    uneven_columns,
    no_intervals,
    claim_exact_integration,
    shrink_listed_obstacle,
    swap_listed_obstacles,
]


@pytest.mark.parametrize("lie", LIES, ids=lambda lie: lie.__name__)
def test_mathematics_alone_rejects_a_lie_with_a_fresh_digest(plan, lie):
    data = copy.deepcopy(plan.to_dict())
    lie(data)
    forged = resealed(data)
    result = answer(forged)
    assert not result.ok
    assert not any("digest" in reason for reason in result.reasons)
    assert not verify_plan(forged).upheld


def test_what_remains_true_passes_with_a_fresh_digest(plan):
    data = copy.deepcopy(plan.to_dict())
    pair(data)["c"][3] += 1e-4
    data["certificate"]["clearance"] -= 1e-3
    data["certificate"]["checks"][0]["value"] -= 1e-3
    data["certificate"]["checks"][0]["sentence"] = "reworded"
    assert rejected(data)
    assert answer(resealed(data)).ok


def test_certificate_of_another_trajectory_is_rejected(plan, kit):
    shorter = kit.drive(plan.vehicle, plan.trajectory.t[:-1], plan.trajectory.inputs[:-1])
    assert not prove(plan.scenario, plan.vehicle, shorter, plan.certificate).ok


def test_uncertified_certificates_are_not_ok(plan):
    blocked = plan.scenario.with_(obstacles=(Obstacle("in the way", [(1, -1), (3, -1), (3, 1)]),))
    certificate = verify(blocked, plan.vehicle, plan.trajectory)
    result = check_certificate(blocked, plan.vehicle, plan.trajectory, certificate)
    assert not result.ok
    assert "itself" in result.reasons[0]


@pytest.mark.parametrize("seed", range(10))
def test_accepts_what_the_judge_proves_of_random_motions(kit, seed):
    car = kit.box_car()
    trajectory = kit.wander(car, 100 + seed, steps=20)
    low, high = trajectory.poses[:, :2].min(axis=0) - 12, trajectory.poses[:, :2].max(axis=0) + 12
    scenario = kit.scene(trajectory, kit.boxes(seed, 12, low, high))
    hit = {w.obstacle.rsplit("/", 1)[0] for w in verify(scenario, car, trajectory).witnesses}
    in_the_way = {member for solid in scenario.solids if solid.name in hit for member in solid.members}
    scenario = scenario.with_(obstacles=tuple(o for o in scenario.obstacles if o.name not in in_the_way))
    certificate = verify(scenario, car, trajectory)
    assert certificate.certified
    assert check_certificate(scenario, car, trajectory, certificate).reasons == ()


def test_summary_of_a_rejected_plan_gives_the_reason(plan):
    data = copy.deepcopy(plan.to_dict())
    data["certificate"]["clearance"] += 1e-3
    lines = verify_plan(Plan.from_dict(data)).summary()
    assert lines[0] == "the plan is NOT upheld"
    assert any("digest" in line for line in lines)


def test_certificate_of_the_wrong_format_is_refused(plan):
    data = copy.deepcopy(plan.to_dict())
    data["certificate"]["format"] = "tightspot-certificate/2"
    with pytest.raises(PlanFileError, match=r"certificate\.format"):
        Plan.from_dict(data)
