"""Many cheap guesses of all kinds for one scene: searched, without a search, and bent."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tightspot.errors import InputError, Problem
from tightspot.guesses.base import GuessResult, as_single_track
from tightspot.guesses.bent import bent
from tightspot.guesses.perturbed import generator
from tightspot.guesses.reeds_shepp import ReedsShepp
from tightspot.guesses.several import variants
from tightspot.scenarios.scenario import Scenario
from tightspot.vehicles.base import VehicleModel

SEARCHED, WORDS = 1 / 2, 1 / 10
"""Shares of the guesses that are searched and that are Reeds-Shepp words; the others are bent."""
LEAST, MOST = 0.05, 0.5
"""How far positions are bent, in widths of the body."""


def assorted(
    scenario: Scenario,
    vehicle: VehicleModel,
    count: int,
    seed: int = 0,
    *,
    margin: float | None = None,
    threads: int = 1,
    seconds: float = math.inf,
    first: GuessResult | None = None,
) -> list[GuessResult]:
    """Up to ``count`` guesses, the cheapest searched one first; the same arguments give the same guesses.

    Half by hybrid A* (:func:`variants`: other gears at the ends, the other direction of search, other prices,
    other sides of things); a tenth Reeds-Shepp words that are nearly free (:meth:`ReedsShepp.least_blocked`); the rest
    bent versions of these, half of them of the first (:func:`bent_versions`). Only the searched ones are free of
    collisions. They take some ten milliseconds where the search is easy, and are meant for solvers that take one.

    Args:
        scenario: The scene, in its own (recentred) coordinates.
        vehicle: A single-track vehicle.
        count: Most guesses wanted.
        seed: Of what is drawn at random; 0 or more.
        margin: Clearance demanded, m; the scenario's by default.
        threads: Searches at a time.
        seconds: For the searches; the answer depends on the machine if that is too little.
        first: What :class:`HybridAStar` found for the scene, if that is known.

    Returns:
        Guesses; ``report["variant"]`` says how each was made. If there is no path and no word, one result without a
        trajectory, with the reason.

    Raises:
        InputError: If an argument is out of its range, or the vehicle is not of the single-track model.
    """
    car = as_single_track(vehicle, "assorted")
    if not (count >= 1 and count == int(count)):
        raise InputError(Problem("count", f"{count} must be a whole number, 1 or more"))
    margin = scenario.margin if margin is None else margin
    searched = variants(
        scenario, car, math.ceil(SEARCHED * count), seed, margin=margin, threads=threads, tries=1, seconds=seconds,
        first=first,
    )  # fmt: skip
    words = [
        replace(word, report=word.report | {"variant": f"Reeds-Shepp {word.report['word']}"})
        for word in ReedsShepp().least_blocked(scenario, car, int(WORDS * count), margin=margin)
    ]
    made = [result for result in (*searched, *words) if result.trajectory is not None]
    return [*made, *bent_versions(made, car, int(count) - len(made), seed)] if made else searched[:1]


def bent_versions(made: Sequence[GuessResult], vehicle: VehicleModel, count: int, seed: int) -> list[GuessResult]:
    """``count`` bent versions of guesses: every other one of the first, those between of the others in turn.

    Positions are bent by 0.05 to 0.5 widths of the body; see :func:`tightspot.guesses.bent.bent`.

    Args:
        made: At least one guess; each has a trajectory.
        vehicle: Its body gives the scale.
        count: How many.
        seed: The same guesses for the same seed.

    Raises:
        InputError: If the trajectories have no poses, or the seed makes no sense.
    """
    rng = generator(seed)
    corners = np.vstack([part.polygon.vertices for part in vehicle.parts])
    width, length = min(np.ptp(corners, axis=0)), max(np.ptp(corners, axis=0))
    result = []
    for number in range(count):
        origin = made[0] if number % 2 == 0 else made[(number // 2 + 1) % len(made)]
        amount = width * float(np.exp(rng.uniform(np.log(LEAST), np.log(MOST))))
        of = origin.report.get("variant", "the guess")
        if origin.trajectory is not None:
            trajectory = bent(origin.trajectory, amount, int(rng.integers(2**32)), length=length / 2)
            reason = f"{origin.reason} Bent at random by about {amount:.2f} m."
            report = {"variant": f"{of}, bent {number}", "amount": amount}
            result.append(GuessResult(trajectory, reason, report))
    return result
