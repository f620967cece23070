"""The objective of eq. (25) in both forms, as an expression and as a number."""

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.transcription import EnergyForm, Objective, TimeGrid


def test_the_printed_form_by_hand():
    t, inputs = [0.0, 1.0, 4.0], [[1.0, 2.0], [3.0, -1.0]]
    # 0.5 * 4 + 1 * (1 + 2 * 4) + 3 * (9 + 2 * 1)
    assert Objective(0.5, (1.0, 2.0), EnergyForm.TIME_SCALED).value(t, inputs) == pytest.approx(44.0)


def test_the_normalised_form_divides_the_energy_by_the_duration():
    t, inputs = [10.0, 11.0, 14.0], [[1.0, 2.0], [3.0, -1.0]]
    objective = Objective(0.5, (1.0, 2.0), EnergyForm.NORMALISED)
    assert objective.value(t, inputs) == pytest.approx(2.0 + 42.0 / 4)


def test_the_paper_s_recovered_settings_sum_over_the_intervals():
    objective = Objective(0.0095, (5.255 * 20, 2 * 5.255 * 20), EnergyForm.NORMALISED)
    inputs = np.random.default_rng(0).normal(size=(20, 2))
    expected = 0.0095 * 80 + 5.255 * (inputs[:, 0] ** 2 + 2 * inputs[:, 1] ** 2).sum()
    assert objective.value(np.linspace(0, 80, 21), inputs) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("form", list(EnergyForm))
def test_the_expression_equals_the_value(form):
    rng = np.random.default_rng(1)
    grid = TimeGrid(np.r_[0, np.sort(rng.random(4)), 1])
    objective = Objective(0.3, (2.0, 5.0), form)
    symbols = [ca.SX.sym(f"u{k}", 2) for k in range(grid.steps)]
    final_time, weight, weights = ca.SX.sym("t"), ca.SX.sym("r"), ca.SX.sym("P", 2)
    expression = objective.expression(symbols, final_time, grid, weight, weights)
    J = ca.Function("J", [ca.horzcat(*symbols), final_time, weight, weights], [expression])
    inputs = rng.normal(size=(grid.steps, 2))
    number = float(J(inputs.T, 7.0, 0.3, [2.0, 5.0]))
    assert number == pytest.approx(objective.value(7.0 * grid.fractions, inputs), rel=1e-13)


@pytest.mark.parametrize(
    ("arguments", "path"),
    [
        ({"time_weight": -1.0}, "objective.time_weight"),
        ({"time_weight": np.nan}, "objective.time_weight"),
        ({"input_weights": (1.0, np.inf)}, "objective.input_weights"),
        ({"input_weights": (1.0, -2.0)}, "objective.input_weights"),
        ({"time_weight": 0.0, "input_weights": (0.0, 0.0)}, "objective"),
    ],
)
def test_weights_without_sense_are_refused(arguments, path):
    with pytest.raises(InputError) as error:
        Objective(**arguments)
    assert [problem.path for problem in error.value.problems] == [path]
