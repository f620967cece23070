"""A round that need not be judged: what its samples say is what the judge would say; a loose one is never a plan."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from tightspot.planner import plan, rounds
from tightspot.planner.pairs import SURE, Room
from tightspot.planner.request import Request, resolve
from tightspot.planner.rounds import Round, Step, run_round
from tightspot.planner.strategy import ENOUGH, EXTRA, FIRST_EXTRA, first_step, next_step
from tightspot.scenarios import builtin
from tightspot.solvers import Stagewise
from tightspot.trajectory import Trajectory
from tightspot.verification import Certificate, replay, verify

SCENES = ["oblique", "vertical", "parallel"]


def begun(name: str, **changes: object) -> tuple[Request, Trajectory, Step]:
    asked = resolve(builtin(name), None, None, None, None, None, None, 0.02, 8, 60.0)
    asked = replace(asked, **changes)  # type: ignore[arg-type]
    guess = asked.guess.make(asked.scenario, asked.vehicle, margin=asked.margin).trajectory
    assert guess is not None
    return asked, guess, first_step(asked, guess)


def judged(asked: Request, outcome: Round) -> Certificate:
    return verify(asked.scenario, asked.vehicle, outcome.trajectory, margin=asked.margin)


def solved(asked: Request, step: Step) -> Round:
    return run_round(asked, step, 0, lambda news: None, 30.0)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("steps", [12, 20, 30, 60])
def test_what_samples_object_to_the_judge_refuses_and_his_witness_is_at_least_as_bad(name: str, steps: int) -> None:
    asked, guess, _ = begun(name, steps=steps)
    outcome = solved(asked, first_step(asked, guess))
    assert outcome.solved
    assert outcome.room is not None
    verdict = judged(asked, outcome)
    told = outcome.to_dict()
    assert outcome.certified is told["certified"] is verdict.certified
    if outcome.objection:
        assert verdict.witness is not None
        assert verdict.witness.clearance <= outcome.room.deepest + 2 * SURE
        assert told["witness"] == outcome.objection
        assert told["clearance"] == outcome.room.deepest


def test_the_objection_names_part_obstacle_and_interval_of_the_nearest_sample() -> None:
    asked, guess, _ = begun("parallel")
    outcome = solved(asked, first_step(asked, guess))
    assert outcome.replay is not None
    witness = judged(asked, outcome).witness
    assert witness is not None
    assert outcome.objection.startswith(f"{witness.part} overlaps by ")
    assert witness.obstacle in outcome.objection
    start, end = (float(number) for number in re.findall(r"(\d+\.\d{3}) s", outcome.objection))
    assert start - 1e-3 <= witness.time <= end + 1e-3


def test_a_motion_beyond_the_workspace_is_objected_to() -> None:
    asked, _, _ = begun("vertical")
    ahead = np.array([[1.0, 0.0], *[[0.0, 0.0]] * 18, [-1.0, 0.0]])
    t = np.arange(len(ahead) + 1.0)
    rough = Trajectory(t, np.zeros((len(t), 5)) + asked.scenario.start * [1, 1, 1, 0, 0], ahead)
    room = Room.of_replay(replay(asked.vehicle, rough), asked.scenario)
    assert "leaves the workspace by" in room.objection(t, -np.inf, asked.scenario, asked.vehicle)


def test_the_judge_is_asked_only_where_there_is_need_to(monkeypatch: pytest.MonkeyPatch) -> None:
    asked_of: list[float] = []

    def counted(*arguments: object, **options: object) -> Certificate:
        asked_of.append(1.0)
        return verify(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(rounds, "verify", counted)
    asked, _, step = begun("parallel")
    outcome = solved(asked, step)
    assert outcome.objection
    assert not asked_of
    assert outcome.certificate is outcome.certificate
    assert len(asked_of) == 1, "who asks for the certificate has it made, once"
    assert not outcome.certified


def test_a_loose_step_is_a_start_for_the_next_one_and_no_plan() -> None:
    asked, guess, step = begun("vertical")
    exact, loose = solved(asked, step), solved(asked, replace(step, loose=True))
    assert loose.solved
    assert loose.report.iterations < exact.report.iterations
    assert not loose.certified
    assert not loose.to_dict()["certified"]
    after = next_step(asked, [loose], guess)
    assert after is not None
    assert after.mesh.formulation is asked.formulation
    assert not after.loose
    exactly = replace(asked, solver=Stagewise(tolerance=1e-1))
    assert solved(exactly, replace(step, loose=True)).report.iterations <= loose.report.iterations, "as asked for"


def test_the_last_round_that_is_allowed_is_not_a_loose_one() -> None:
    asked, guess, step = begun("parallel")
    first = solved(asked, step)
    again = next_step(asked, [first], guess)
    assert again is not None
    assert (again.kind, again.loose) == ("again", True)
    only = next_step(replace(asked, refinements=1), [first], guess)
    assert only is not None
    assert (only.kind, only.loose) == ("again", False)


@pytest.mark.parametrize("name", SCENES)
def test_more_is_demanded_at_the_knots_where_the_guess_has_it_and_only_there(name: str) -> None:
    asked, guess, step = begun(name)
    room = Room.of_guess(guess, step.mesh.grid, asked.scenario, asked.vehicle)
    assert step.mesh.extra == (FIRST_EXTRA if room.spare(asked.margin).min() >= ENOUGH else EXTRA)
    narrow = replace(asked, margin=asked.margin + max(float(room.spare(asked.margin).min()), 0.0) - ENOUGH / 2)
    assert first_step(narrow, guess).mesh.extra == EXTRA
    at_knots = replace(asked, formulation=step.mesh.formulation)
    assert first_step(at_knots, guess).mesh.extra == EXTRA, "who demands the knots alone gets them"


@pytest.mark.parametrize("name", SCENES)
def test_what_is_demanded_on_top_costs_hardly_anything(name: str) -> None:
    """Beside the same rounds without it; plans may end in another optimum, but not in a much worse one."""
    found = plan(name, margin=0.02)
    asked, guess, step = begun(name)
    usual = replace(step, mesh=replace(step.mesh, extra=EXTRA))
    course = [solved(asked, usual)]
    while not course[-1].certified:
        after = next_step(asked, course, guess)
        assert after is not None
        course.append(run_round(asked, after, len(course), lambda news: None, 30.0))
    last = course[-1].trajectory
    assert found.report["objective"]["value"] <= 1.01 * asked.objective.value(last.t, last.inputs)
