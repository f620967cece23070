"""The paper's programs solved from many guesses at once: which optima there are, and the best of them."""

from __future__ import annotations

from tightspot.campaigns.settings import SCENES, PaperSettings, paper_settings
from tightspot.errors import InputError, Problem
from tightspot.formulations import SeparatingLine
from tightspot.guesses import assorted
from tightspot.planner.optima import Optimum, find_optima
from tightspot.transcription import TimeGrid

GUESSES = 10


def best_of(
    scene: str,
    seed: int = 0,
    *,
    settings: PaperSettings | None = None,
    count: int = GUESSES,
    threads: int = 1,
) -> list[Optimum]:
    """The optima of one of the paper's programs (17) that ``count`` guesses lead to, the smallest J first.

    The guesses are :func:`tightspot.guesses.assorted`, the solver is the stagewise one, for which the same program is
    written as for IPOPT. It is the program of Table II: separation at the knots. The first stage of
    ``plan(effort="best")`` does the same; what it then certifies for all times has a larger J.

    Args:
        scene: ``vertical``, ``parallel`` or ``oblique``.
        seed: Of what is drawn at random.
        settings: By default the recovered ones, with which the paper's values come out.
        count: Guesses.
        threads: Searches and solves at a time; the answer does not depend on it.

    Raises:
        InputError: An argument is out of its range.

    >>> [round(optimum.objective, 3) for optimum in best_of("oblique", count=3)]
    [0.856]
    """
    if scene not in SCENES:
        raise InputError(Problem("scene", f"{scene!r} is not one of the paper's: {', '.join(SCENES)}"))
    settings = settings or paper_settings()
    scenario, car = settings.scenario(scene), settings.car()
    guesses = assorted(scenario, car, count, seed, margin=settings.gap, threads=threads)
    wanted, grid = settings.transcription(SeparatingLine()), TimeGrid.uniform(settings.steps)
    return find_optima(scenario, car, wanted, guesses, grid=grid, threads=threads)
