"""Symbols are kept for programs of the same structure; the numbers are always the scene's own."""

from dataclasses import replace

import numpy as np
import pytest

from tightspot.formulations import SeparatingLine, SweptLine, UnitNormalLine
from tightspot.geometry import ConvexPolygon
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import Ipopt
from tightspot.transcription import EnergyForm, Objective, Settings, TimeGrid, transcribe
from tightspot.transcription.structures import forget
from tightspot.vehicles import SingleTrack, vehicle

SCENE = Scenario(
    name="one",
    workspace=ConvexPolygon.rectangle(-6, 14, -6, 6),
    obstacles=(Obstacle("block", np.array([(3, -3), (5, -3), (5, -1.3), (3, -1.3)])),),
    start=[0, 0, 0, 0, 0],
    goal=[8, 0.5, 0.2, 0, 0],
)
OTHER = replace(
    SCENE,
    name="other",
    workspace=ConvexPolygon.rectangle(-7, 15, -5, 7),
    obstacles=(Obstacle("stone", np.array([(3, -3), (6, -3), (6, -1.6), (4, -1.2)])),),
    start=np.array([0.5, 0.1, 0.1, 0, 0]),
)


def make(scene=SCENE, car=None, *, steps=5, grid=None, **settings):
    car = car or vehicle("paper")
    guess = LinearInterpolation().make(scene, car, margin=0.0).trajectory
    settings = Settings(**{"formulation": SeparatingLine(), "margin": 0.05} | settings)
    return transcribe(scene, car, guess, settings, grid=grid or TimeGrid.uniform(steps))


@pytest.fixture(autouse=True)
def nothing_kept():
    forget()


def test_another_scene_of_the_same_structure_has_the_same_symbols():
    one, other = make(), make(OTHER, margin=0.1, objective=Objective(0.3))
    assert other.nlp.g is one.nlp.g
    assert other.nlp.f is one.nlp.f
    assert {block.detail for block in other.nlp.blocks if block.kind == "separation"} == {"body against stone/0"}
    assert {block.detail for block in one.nlp.blocks if block.kind == "separation"} == {"body against block/0"}


@pytest.mark.parametrize("formulation", [SeparatingLine(), SweptLine()], ids=lambda member: member.name)
def test_its_solution_is_that_of_a_program_built_for_it(formulation):
    make(formulation=formulation)
    kept = make(OTHER, formulation=formulation)
    forget()
    fresh = make(OTHER, formulation=formulation)
    assert kept.nlp.g is not fresh.nlp.g
    for name in ("lbx", "ubx", "lbg", "ubg", "x0", "p0"):
        np.testing.assert_array_equal(getattr(kept.nlp, name), getattr(fresh.nlp, name))
    one, other = Ipopt().solve(kept.nlp), Ipopt().solve(fresh.nlp)
    assert one.status.success
    np.testing.assert_allclose(one.x, other.x, atol=1e-9)
    assert one.timings["build"] >= 0


def test_what_changes_the_structure_has_symbols_of_its_own():
    grid = TimeGrid(np.array([0.0, 0.1, 0.3, 0.5, 0.8, 1.0]))
    leaning = replace(SCENE, workspace=ConvexPolygon([(-6, -6), (14, -5), (14, 6), (-6, 6)]))
    triangle = replace(SCENE, obstacles=(Obstacle("block", np.array([(3, -3), (5, -3), (4, -1.3)])),))
    programs = [
        make(),
        make(steps=6),
        make(grid=grid),
        make(formulation=UnitNormalLine()),
        make(substeps=2),
        make(car=vehicle("tpcap")),
        make(objective=Objective(energy=EnergyForm.NORMALISED)),
        make(leaning),
        make(triangle),
    ]
    assert len({id(program.nlp.g) for program in programs}) == len(programs)


def test_a_class_that_was_defined_again_under_its_name_is_another():
    def car(sign):
        class Mine(SingleTrack):
            def dynamics(self, state, control, ns):
                return [sign * value for value in super().dynamics(state, control, ns)]

        Mine.__qualname__ = "Mine"
        base = vehicle("paper")
        return Mine(base.name, base.wheelbase, base.body, base.limits)

    one, other = make(car=car(1.0)), make(car=car(-1.0))
    assert one.nlp.g is not other.nlp.g
