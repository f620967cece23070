"""What ``tightspot plan`` shall minimise, from the command line's options."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tightspot.errors import InputError, Problem
from tightspot.problems import shown

if TYPE_CHECKING:
    from tightspot.transcription import Objective

_OPTION = "energy-weights"


def objective_of(time_weight: float | None, energy_weights: str | None) -> Objective | None:
    """The objective with what was given in place of the paper's weights; ``None`` if nothing was.

    Raises:
        InputError: Weights that are no numbers, or negative, or all 0.
    """
    from tightspot.transcription import Objective

    if time_weight is None and energy_weights is None:
        return None
    usual = Objective()
    return Objective(
        usual.time_weight if time_weight is None else time_weight,
        usual.input_weights if energy_weights is None else _weights(energy_weights),
    )


def _weights(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(item) for item in text.split(","))
    except ValueError:
        sentence = f"{shown(text)} must be one number for each input, such as 0.01,0.01"
        raise InputError(Problem(_OPTION, sentence)) from None
