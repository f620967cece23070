"""What a solution on one mesh is worth as a start on another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tightspot.formulations import SeparatingLine, SweptLine, SweptUnitNormalLine
from tightspot.guesses import HybridAStar
from tightspot.scenarios import builtin
from tightspot.solvers import Ipopt, Stagewise, WarmStart
from tightspot.trajectory import Trajectory
from tightspot.transcription import (
    Settings,
    TimeGrid,
    carry_lines,
    carry_over,
    moved_ends,
    parents,
    resample,
    stage_problem,
    transcribe,
)

SCENE = builtin("oblique")
CAR = SCENE.vehicle_model()
GUESS = HybridAStar().make(SCENE, CAR, margin=0.05).trajectory
COARSE = TimeGrid.uniform(20)


def settings(member=None, poses=1):
    return Settings(formulation=member or SweptLine(), margin=0.05, poses=poses, substeps=2)


def program(grid, guess=GUESS, member=None, **masks):
    return transcribe(SCENE, CAR, guess, settings(member), grid=grid, **masks)


@pytest.fixture(scope="module")
def solved():
    coarse = program(COARSE)
    return coarse, Ipopt().solve(coarse.nlp)


def test_parents_hold_the_middle_of_their_children():
    fine = COARSE.cut(np.arange(20) % 3 + 1)
    parent = parents(COARSE, fine)
    assert parent.tolist() == np.repeat(np.arange(20), np.arange(20) % 3 + 1).tolist()
    for k, p in enumerate(parent):
        assert (
            COARSE.fractions[p] - 1e-12 <= fine.fractions[k] < fine.fractions[k + 1] <= COARSE.fractions[p + 1] + 1e-12
        )


def test_on_the_same_mesh_everything_is_carried_over_and_the_solution_stays(solved):
    coarse, report = solved
    same = program(COARSE, coarse.trajectory(report.x))
    warm = carry_over(coarse, report, same)
    np.testing.assert_allclose(warm.x, report.x, atol=1e-9)
    np.testing.assert_allclose(warm.lam_g, report.lam_g, atol=1e-12)
    np.testing.assert_allclose(warm.lam_x, report.lam_x, atol=1e-12)
    again = Ipopt().solve(same.nlp, warm=replace(warm, push=1e-8))
    assert again.objective == pytest.approx(report.objective, rel=1e-6)
    assert again.iterations <= report.iterations / 2


def test_a_cut_interval_shares_its_multipliers_by_width_and_keeps_its_costate(solved):
    coarse, report = solved
    pieces = np.where(np.arange(20) % 4 == 3, 2, 1)
    fine = program(COARSE.cut(pieces), coarse.trajectory(report.x))
    warm = carry_over(coarse, report, fine)
    parent = parents(COARSE, fine.grid)
    old = {(block.kind, block.knot, block.key): report.lam_g[block.rows] for block in coarse.nlp.blocks}
    checked = set()
    for block in fine.nlp.blocks:
        k = block.knot - 1
        share = 1.0 if block.kind == "dynamics" else fine.grid.widths[k] / COARSE.widths[parent[k]]
        expected = share * old[block.kind, parent[k] + 1, block.key]
        np.testing.assert_allclose(warm.lam_g[block.rows], expected, atol=1e-14)
        checked.add(block.kind)
    assert checked == {"dynamics", "workspace", "separation"}
    total = sum(np.abs(warm.lam_g[b.rows]).sum() for b in fine.nlp.blocks if b.kind == "separation")
    before = sum(np.abs(report.lam_g[b.rows]).sum() for b in coarse.nlp.blocks if b.kind == "separation")
    assert total == pytest.approx(before), "an integral over time does not change when intervals are cut"


def test_a_pair_that_was_not_there_keeps_its_closed_form_line():
    active = np.ones((20, 1, 2), bool)
    active[:, 0, 1] = False
    less = program(COARSE, active=active)
    sparse = Ipopt().solve(less.nlp)
    full = program(COARSE, less.trajectory(sparse.x))
    warm = carry_over(less, sparse, full)
    for (k, part, obstacle), place in full.lines.items():
        expected = sparse.x[less.lines[k, part, obstacle]] if obstacle == 0 else full.nlp.x0[place]
        np.testing.assert_array_equal(warm.x[place], expected)


def test_lines_of_another_size_are_not_carried_over(solved):
    coarse, report = solved
    unit = program(COARSE, coarse.trajectory(report.x), SweptUnitNormalLine())
    warm = carry_over(coarse, report, unit)
    for place in unit.lines.values():
        np.testing.assert_array_equal(warm.x[place], unit.nlp.x0[place])
    at_knots = program(COARSE, coarse.trajectory(report.x), SeparatingLine())
    carried = carry_over(coarse, report, at_knots)
    for key, place in at_knots.lines.items():
        np.testing.assert_array_equal(carried.x[place], report.x[coarse.lines[key]])


def test_the_stagewise_solver_s_lines_are_carried_over_to_a_finer_mesh():
    problem = stage_problem(SCENE, CAR, GUESS, settings(), grid=COARSE)
    report = Stagewise().solve_stages(problem)
    assert report.status.success
    fine = COARSE.cut(np.full(20, 2))
    guess = resample(program(COARSE).trajectory(report.x), fine)
    closed = stage_problem(SCENE, CAR, guess, settings(), grid=fine)
    carried = carry_lines(COARSE, report, closed)
    where = {tuple(pair): line for pair, line in zip(report.pairs.tolist(), report.lines, strict=True)}
    for (k, part, obstacle), line in zip(carried.pairs.tolist(), carried.lines, strict=True):
        np.testing.assert_array_equal(line, where[k // 2, part, obstacle])
    assert not np.allclose(carried.lines, closed.lines)
    finer = Stagewise().solve_stages(carried)
    assert finer.status.success
    assert finer.objective == pytest.approx(Stagewise().solve_stages(closed).objective, rel=1e-5)


def test_pairs_that_had_no_line_keep_their_closed_form():
    masks = np.random.default_rng(0).random((2, 20, 1, len(SCENE.obstacle_polygons))) < 0.5
    old = stage_problem(SCENE, CAR, GUESS, settings(), grid=COARSE, active=masks[0])
    report = Stagewise().solve_stages(old)
    new = stage_problem(SCENE, CAR, GUESS, settings(), grid=COARSE, active=masks[1])
    carried = carry_lines(COARSE, report, new)
    where = {tuple(pair): line for pair, line in zip(report.pairs.tolist(), report.lines, strict=True)}
    assert where.keys() & set(map(tuple, new.pairs.tolist()))
    for pair, line, closed in zip(new.pairs.tolist(), carried.lines, new.lines, strict=True):
        np.testing.assert_array_equal(line, where.get(tuple(pair), closed))
    nothing = stage_problem(SCENE, CAR, GUESS, settings(), grid=COARSE, active=np.zeros_like(masks[0]))
    free = Stagewise().solve_stages(nothing)
    np.testing.assert_array_equal(carry_lines(COARSE, free, new).lines, new.lines)
    assert carry_lines(COARSE, report, nothing).lines.shape == (0, 2)


def test_a_point_of_one_backend_starts_another():
    """The stagewise report's vectors are those of the Nlp, so that IPOPT can go on where it stopped."""
    problem = stage_problem(SCENE, CAR, GUESS, settings(), grid=COARSE)
    report = Stagewise().solve_stages(problem)
    nlp = program(COARSE).nlp
    cold = Ipopt().solve(nlp)
    warm = Ipopt().solve(nlp, warm=WarmStart(report.x, report.lam_x, report.lam_g))
    assert warm.objective == pytest.approx(report.objective, rel=1e-6)
    assert warm.iterations < cold.iterations


def test_moved_ends_make_the_same_problem_as_transcribing_anew():
    report = Stagewise().solve_stages(stage_problem(SCENE, CAR, GUESS, settings(), grid=COARSE))
    assert report.status.success
    shift = np.array([0.1, -0.05, 0.03 + 2 * np.pi, 0.0, 0.0])
    scene = SCENE.with_(start=SCENE.start + shift, goal=SCENE.goal + 0.01)
    moved = moved_ends(report, scene)
    names = CAR.state_names, CAR.input_names
    at = Trajectory(report.final_time * COARSE.fractions, report.states, report.inputs, *names)
    anew = stage_problem(scene, CAR, at, settings(), grid=COARSE)
    for name in ("start", "goal", "widths", "pairs", "pair_demands", "pair_sides", "walls", "wall_lines"):
        np.testing.assert_allclose(getattr(moved, name), getattr(anew, name), atol=1e-12, err_msg=name)
    np.testing.assert_allclose(moved.states, anew.states, atol=1e-9)
    np.testing.assert_array_equal(moved.lines, report.lines)
    again = replace(Stagewise(), initial_barrier=1e-4).solve_stages(
        moved, warm=replace(report.point, v=moved.starting_point())
    )
    assert again.status.success
    assert again.objective == pytest.approx(Stagewise().solve_stages(anew).objective, rel=1e-3)


def test_other_obstacles_need_another_problem():
    report = Stagewise().solve_stages(stage_problem(SCENE, CAR, GUESS, settings(), grid=COARSE))
    others = [SCENE.obstacles[0].shifted([0.0, -0.1]), *SCENE.obstacles[1:]]
    assert moved_ends(report, SCENE.with_(obstacles=others)) is None
