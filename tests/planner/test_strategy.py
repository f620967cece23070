"""What the planner does next: split where it is too near, then ask for more, and know when to stop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tightspot.formulations import SeparatingLine, SweptLine, UnitNormalLine
from tightspot.guesses import GivenPath, LinearInterpolation
from tightspot.planner.pairs import Room
from tightspot.planner.request import Request, resolve
from tightspot.planner.rounds import Mesh, Round, Step, run_round
from tightspot.planner.strategy import (
    ASTRAY,
    DEEP,
    EXTRA,
    FAILED_SOLVES,
    HOPELESS,
    at_knots,
    between_the_knots,
    first_step,
    next_step,
    refine,
)
from tightspot.scenarios import Scenario, builtin
from tightspot.solvers import Ipopt, StageReport
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid
from tightspot.verification import replay, verify


def request(formulation: object = None, **changes: object) -> Request:
    base = resolve(builtin("vertical"), None, None, None, LinearInterpolation(), None, 10, None, 4, 60.0)
    return replace(base, formulation=formulation or SweptLine(), **changes)  # type: ignore[arg-type]


def straight(asked: Request) -> Trajectory:
    """Drives ahead from the start, touches nothing at first, then leaves W."""
    inputs = np.array([[1.0, 0.0], *[[0.0, 0.0]] * 11, [-1.0, 0.0]])
    t = np.arange(len(inputs) + 1.0)
    rough = Trajectory(t, np.zeros((len(t), 5)), inputs)
    return Trajectory(t, replay(asked.vehicle, rough).knots, inputs)


def mesh(steps: int, formulation: object = None) -> Mesh:
    return Mesh(
        formulation or SweptLine(),
        TimeGrid.uniform(steps),
        (2,) * steps,
        EXTRA,
        np.zeros((steps, 1, 2), bool),
        np.ones((steps, 1, 4), bool),
    )  # type: ignore[arg-type]


def test_a_guess_is_first_made_free_at_the_knots() -> None:
    guess = LinearInterpolation().make(builtin("vertical"), request().vehicle, margin=0.05).trajectory
    assert guess is not None
    assert first_step(request(), guess).mesh.formulation.holds == "knots"
    asked = request(UnitNormalLine())
    assert first_step(asked, guess).mesh.formulation is asked.formulation
    assert at_knots(SweptLine()) == SeparatingLine()


def room_of(asked: Request, trajectory: Trajectory) -> Room:
    return Room.of_replay(replay(asked.vehicle, trajectory), asked.scenario)


def test_refine_splits_exactly_the_intervals_that_are_too_near() -> None:
    asked = request()
    trajectory = straight(asked)
    judged = verify(asked.scenario, asked.vehicle, trajectory, margin=asked.margin)
    only_space = tuple(check for check in judged.checks if check.name in ("obstacles", "workspace"))
    judged = replace(judged, checks=only_space)
    old = replace(mesh(13), grid=TimeGrid(trajectory.t / trajectory.t[-1]))
    new = refine(asked, old, room_of(asked, trajectory), judged, 1)
    nose = trajectory.column("x") + 3.699
    outside = nose[1:] > 15.0
    assert new.grid.steps == 13 + outside.sum()
    kept = np.isin(np.round(old.grid.fractions, 12), np.round(new.grid.fractions, 12))
    assert kept.all(), "old knots stay knots"
    assert new.extra == old.extra, "the margin grows later only"
    assert refine(asked, old, room_of(asked, trajectory), judged, 4).extra > old.extra
    assert len(new.poses) == new.grid.steps
    assert new.active.shape == (new.grid.steps, 1, 2)


def test_an_objection_other_than_clearance_splits_everything() -> None:
    asked = request()
    trajectory = straight(asked)
    judged = verify(asked.scenario, asked.vehicle, trajectory, margin=asked.margin)
    assert any(check.name.startswith("goal") for check in judged.failed)
    old = replace(mesh(13), grid=TimeGrid(trajectory.t / trajectory.t[-1]))
    assert refine(asked, old, room_of(asked, trajectory), judged, 1).grid.steps == 26


def failed(asked: Request, step: Step) -> Round:
    hopeless = replace(asked, solver=Ipopt(max_iterations=1), fallbacks=())
    outcome = run_round(hopeless, step, 0, lambda news: None, 10.0)
    assert not outcome.solved
    return outcome


def test_after_failed_solves_it_tries_whole_intervals_then_more_of_them_then_stops() -> None:
    asked = request()
    guess = LinearInterpolation().make(asked.scenario, asked.vehicle, margin=0.05).trajectory
    assert guess is not None
    rounds = [failed(asked, first_step(asked, guess))]
    second = next_step(asked, rounds, guess)
    assert second is not None
    assert second.mesh.formulation is asked.formulation
    assert second.mesh.grid.steps == 10
    rounds.append(failed(asked, second))
    third = next_step(asked, rounds, guess)
    assert third is not None
    assert third.mesh.grid.steps == 15
    assert third.mesh.formulation.holds == "knots"
    while len(rounds) <= FAILED_SOLVES:
        rounds.append(rounds[-1])
    assert next_step(asked, rounds, guess) is None


def solved_at_the_knots(name: str, **changes: object) -> tuple[Request, Trajectory, Round]:
    asked = replace(resolve(builtin(name), None, None, None, None, None, None, 0.02, 4, 60.0), **changes)  # type: ignore[arg-type]
    guess = asked.guess.make(asked.scenario, asked.vehicle, margin=asked.margin).trajectory
    assert guess is not None
    return asked, guess, run_round(asked, first_step(asked, guess), 0, lambda news: None, 30.0)


def test_after_the_knots_come_whole_intervals_on_a_mesh_that_is_finer_where_it_is_near() -> None:
    asked, guess, first = solved_at_the_knots("parallel")
    assert first.replay is not None
    again = next_step(asked, [first], guess)
    assert again is not None
    assert again.mesh.formulation.holds == "knots", "0.3 m deep in an obstacle: first once more at the knots"
    assert again.mesh.grid.steps > first.mesh.grid.steps
    first = run_round(asked, again, 1, lambda news: None, 30.0)
    assert first.replay is not None
    step = next_step(asked, [first], guess)
    assert step is not None
    if step.kind == "again":
        first = run_round(asked, step, 1, lambda news: None, 30.0)
        assert first.replay is not None
        step = between_the_knots(asked, first, first.replay, Room.of_replay(first.replay, asked.scenario))
    assert step.mesh.formulation is asked.formulation
    assert step.before is first, "lines and multipliers are carried over"
    finer = step.mesh.grid.fractions
    assert np.isin(np.round(first.mesh.grid.fractions, 12), np.round(finer, 12)).all(), "old knots stay knots"
    widths = np.diff(finer)
    assert widths.max() / widths.min() > 1.9, "not uniform"
    spare = Room.of_replay(first.replay, asked.scenario).spare(asked.margin)
    middles = (finer[:-1] + finer[1:]) / 2
    inside = np.searchsorted(first.mesh.grid.fractions, middles) - 1
    cut = np.bincount(inside, minlength=spare.size) > 1
    assert cut[spare < 0].all()
    assert not cut[spare > 0.5].any()
    np.testing.assert_allclose(step.start.states, first.replay.at(step.start.t), atol=1e-12)
    second = run_round(asked, step, 1, lambda news: None, 30.0)
    assert second.certificate is not None
    assert second.certificate.certified
    assert second.report.iterations < 100
    timings = second.to_dict()["timings"]
    assert set(timings) == {"set_up", "solve", "judge"}
    assert second.to_dict()["seconds"] == sum(timings.values())


def test_a_guess_is_solved_at_the_knots_first_but_not_a_solution() -> None:
    asked, guess, outcome = solved_at_the_knots("parallel")
    step = next_step(asked, [outcome], guess)
    assert step is not None
    assert _starts(run_round(asked, replace(step, mesh=_whole(step.mesh)), 1, lambda news: None, 60.0))[0] == "given"
    cold = Step(_whole(step.mesh), guess, "guess", "from the guess")
    assert _starts(run_round(asked, cold, 1, lambda news: None, 60.0))[0] == "given, at the knots"


def _whole(mesh: Mesh) -> Mesh:
    return replace(mesh, formulation=SweptLine(), poses=(1,) * mesh.grid.steps)


def _starts(outcome: Round) -> list[str]:
    assert isinstance(outcome.report, StageReport)
    return [one.start for one in outcome.report.attempts]


def test_a_solution_whose_knots_jump_over_an_obstacle_is_no_start() -> None:
    asked, guess, first = solved_at_the_knots("parallel", steps=7)
    assert first.replay is not None
    assert Room.of_replay(first.replay, asked.scenario).deepest < -HOPELESS
    step = next_step(asked, [first], guess)
    assert step is not None
    assert step.kind == "guess"
    assert step.mesh.formulation is asked.formulation


def test_the_given_path_is_a_rough_guess() -> None:
    poses = [[0.0, 0.0, 0.0], [6.3, 3.0, 1.2], [6.3, -6.7, np.pi / 2]]
    assert not GivenPath(poses).collision_free


def test_astray_through_what_was_missing_the_same_step_is_solved_again_with_that() -> None:
    in_the_way = {
        "start": {"x": 0, "y": 0, "theta": 0},
        "goal": {"x": 14, "y": 0, "theta": 0},
        "obstacles": [{"vertices": [[6, -1], [8, -1], [8, 1], [6, 1]]}],
    }
    asked = replace(request(), scenario=Scenario.from_dict(in_the_way))
    guess = LinearInterpolation().make(asked.scenario, asked.vehicle, margin=0.05).trajectory
    assert guess is not None
    step = first_step(asked, guess)
    blind = replace(step, mesh=replace(step.mesh, active=np.zeros_like(step.mesh.active)))
    outcome = run_round(asked, blind, 0, lambda news: None, 10.0)
    assert outcome.solved
    assert outcome.certificate is not None
    assert outcome.certificate.clearance < -DEEP
    again = next_step(asked, [outcome], guess)
    assert again is not None
    assert again.start is blind.start
    assert again.mesh.grid is blind.mesh.grid
    assert again.mesh.formulation == blind.mesh.formulation
    assert outcome.replay is not None
    hit = Room.of_replay(outcome.replay, asked.scenario).obstacles < -DEEP
    assert again.mesh.active[hit].all()
    rounds = [replace(outcome, step=again) for _ in range(ASTRAY)]
    other = next_step(asked, rounds, guess)
    assert other is None or other.kind != again.kind
