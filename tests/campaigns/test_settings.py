"""The paper's settings and tables as data, against the paper's own sums."""

import dataclasses

import numpy as np
import pytest

from tightspot.campaigns import METHODS, paper_settings
from tightspot.campaigns.settings import GUESS_NAMES, SCENES
from tightspot.campaigns.table import BETTER, KNOWN, SIZES, TABLE_II
from tightspot.errors import InputError
from tightspot.formulations import SeparatingLine
from tightspot.guesses import CollisionFreeModel, HybridAStar, SimplifiedModel


def test_recovered_settings_are_those_of_the_notes():
    settings = paper_settings("recovered")
    car = settings.car()
    assert (settings.steps, settings.substeps, settings.gap) == (20, 4, 2e-3)
    assert car.wheelbase == 4.628
    assert settings.heading_limit == np.pi
    inputs = np.random.default_rng(0).normal(size=(20, 2))
    expected = 0.0095 * 70 + 5.255 * (inputs[:, 0] ** 2 + 2 * inputs[:, 1] ** 2).sum()
    assert settings.objective.value(np.linspace(0, 70, 21), inputs) == pytest.approx(expected, rel=1e-12)


def test_printed_settings_are_those_of_the_paper():
    settings = paper_settings("printed")
    assert settings.car().wheelbase == 2.796
    inputs = np.full((20, 2), [0.5, 0.1])
    assert settings.objective.value(np.linspace(0, 30, 21), inputs) == pytest.approx(30 * (1 + 0.25 + 2 * 0.01))
    _, front = settings.scenario("parallel").obstacle_parts
    np.testing.assert_allclose(front[1].vertices[:, 0].min(), 12.0)
    np.testing.assert_allclose(paper_settings().scenario("parallel").obstacle_parts[1][1].vertices[:, 0].min(), 11.98)


@pytest.mark.parametrize("name", ["recovered", "printed"])
def test_every_value_has_its_evidence_and_nothing_can_be_changed(name):
    settings = paper_settings(name)
    for value in ("objective", "wheelbase", "rear overhang", "substeps", "gap", "units", "guess weights", "k_f"):
        assert len(settings.evidence[value]) > 2
    p, r = settings.guess_weights
    assert f"p = {p:g}, r = {r:g}" in settings.evidence["guess weights"]
    with pytest.raises(dataclasses.FrozenInstanceError):
        settings.gap = 0.0
    with pytest.raises(TypeError):
        settings.evidence["gap"] = ""


def test_the_three_guesses_have_the_settings():
    settings = paper_settings()
    simplified, seeing, search = (settings.guess(name) for name in GUESS_NAMES)
    assert type(simplified) is SimplifiedModel
    assert type(seeing) is CollisionFreeModel
    assert isinstance(search, HybridAStar)
    assert (seeing.steps, seeing.heading_limit, seeing.substeps) == (20, np.pi, 4)
    with pytest.raises(InputError, match="linear"):
        settings.guess("linear")


def test_unknown_settings_are_named():
    with pytest.raises(InputError, match="recovered or printed"):
        paper_settings("guessed")


def test_transcription_settings_demand_the_gap_everywhere():
    wanted = paper_settings().transcription(SeparatingLine())
    assert (wanted.margin, wanted.end_margin, wanted.substeps) == (2e-3, 2e-3, 4)


def test_the_table_is_whole_and_the_recovered_objective_explains_it():
    """J is nearly 0.0095 t_f + 5.255 (between 1 and 2 times TS) in every cell, which no printed form is."""
    assert set(TABLE_II) == {(scene, key, guess) for scene in SCENES for key in SIZES for guess in GUESS_NAMES}
    for cell in TABLE_II.values():
        energy = cell.objective - 0.0095 * cell.final_time
        assert 5.255 * (cell.effort - 1e-3) <= energy <= 2 * 5.255 * (cell.effort + 1e-3)
        assert cell.objective < cell.final_time, "which J = t_f (1 + ...) could not be"


def test_known_optima_are_the_table_s_distinct_rows_or_better():
    printed = {(scene, cell.objective) for (scene, _, _), cell in TABLE_II.items()}
    assert {(known.scene, known.printed) for known in KNOWN} <= printed
    for known in KNOWN:
        assert known.objective == pytest.approx(known.printed, rel=1e-3)
    for better in BETTER:
        assert better.objective < min(value for scene, value in printed if scene == better.scene)


def test_each_equation_has_one_paper_variant():
    assert sorted(method.equation for method in METHODS.values() if method.paper_variant) == sorted(SIZES)
