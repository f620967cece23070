"""The arguments of :func:`tightspot.plan`, resolved and checked once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tightspot.errors import InputError, Problem, is_number, is_whole, shown
from tightspot.formulations import Formulation, SweptLine, formulation, with_unit_normal
from tightspot.guesses import Guess, HybridAStar, guess
from tightspot.scenarios import Scenario, check, load
from tightspot.scenarios.states import STATE
from tightspot.solvers import BACKENDS, Fatrop, Ipopt, Solver, Stagewise
from tightspot.transcription import Objective, fits_stages
from tightspot.vehicles import CATALOGUE, SingleTrack, VehicleModel, from_dict, load_vehicle

MOST_STEPS = 500
LARGEST_MARGIN = 10.0
PREFERRED = (Stagewise.name, Fatrop.name)
FALLBACK_SECONDS = 25.0
FATROP_SECONDS = 6.0
"""It is done within one second or, as a rule, not at all; from some starts it hangs until it is stopped."""


@dataclass(frozen=True)
class Request:
    """Everything :func:`tightspot.plan` was asked for, with the defaults filled in.

    ``fallbacks`` are tried, in order, when ``solver`` fails. ``unusable`` are the names of those that would have come
    before, but cannot solve this.
    """

    scenario: Scenario
    vehicle: VehicleModel
    objective: Objective
    formulation: Formulation
    guess: Guess
    solver: Solver
    fallbacks: tuple[Solver, ...]
    steps: int | None
    margin: float
    refinements: int
    time_limit: float
    unusable: tuple[str, ...] = ()


def resolve(
    scenario: Scenario | str | Path,
    vehicle: VehicleModel | str | Path | None,
    objective: Objective | None,
    formulation_: Formulation | str | None,
    guess_: Guess | str | None,
    solver: Solver | str | None,
    steps: int | None,
    margin: float | None,
    refinements: int,
    time_limit: float,
) -> Request:
    """Names become objects, ``None`` becomes the default; then the scene is checked for this vehicle and margin.

    Raises:
        InputError: With everything that is wrong.
    """
    scene = scenario if isinstance(scenario, Scenario) else load(scenario)
    car = resolve_vehicle(scene, vehicle)
    margin = scene.margin if margin is None else margin
    problems = []
    if not (is_number(margin) and 0 <= margin <= LARGEST_MARGIN):
        problems.append(Problem("margin", f"{shown(margin)} m must be a number between 0 and {LARGEST_MARGIN:g} m"))
    if steps is not None and not (is_whole(steps) and 2 <= steps <= MOST_STEPS):
        problems.append(Problem("steps", f"{shown(steps)} must be a whole number and lie between 2 and {MOST_STEPS}"))
    if not (is_whole(refinements) and refinements >= 0):
        problems.append(Problem("refinements", f"{shown(refinements)} must be a whole number and not be negative"))
    if not (is_number(time_limit) and time_limit > 0):
        problems.append(Problem("time_limit", f"{shown(time_limit)} s must be a positive number"))
    if len(car.state_names) != len(STATE):
        states = f"model {type(car).__name__} has the {len(car.state_names)} states ({', '.join(car.state_names)})"
        wanted = f"but a scene gives start and goal as ({', '.join(STATE)}): choose a model with {len(STATE)} states"
        problems.append(Problem("vehicle", f"{states}, {wanted}; motions of others can be judged, not planned"))
    if problems:
        raise InputError(problems)
    member = formulation(formulation_) if isinstance(formulation_, str) else formulation_ or SweptLine()
    backend, fallbacks = solvers_for(solver, car, member)
    used = {usable.name for usable in (backend, *fallbacks)}
    unusable = () if solver is not None else tuple(name for name in PREFERRED if name not in used)
    check(scene, car, margin)
    return Request(
        scene,
        car,
        objective or Objective(),
        member,
        guess(guess_) if isinstance(guess_, str) else guess_ or HybridAStar(),
        backend,
        fallbacks,
        steps,
        margin,
        refinements,
        time_limit,
        unusable,
    )


def resolve_vehicle(scenario: Scenario, vehicle: VehicleModel | str | Path | None) -> VehicleModel:
    """The given vehicle, by object, name or file; otherwise the scenario's own."""
    wanted = scenario.vehicle if vehicle is None else vehicle
    if isinstance(wanted, VehicleModel):
        return wanted
    if isinstance(wanted, str) and wanted in CATALOGUE:
        return _of_catalogue(wanted)
    car: SingleTrack = load_vehicle(wanted) if isinstance(wanted, str | Path) else from_dict(wanted)
    return car


@cache
def _of_catalogue(name: str) -> VehicleModel:
    """Vehicles are values, so that one of each is enough."""
    return load_vehicle(name)


def resolve_solver(solver: Solver | str | None) -> Solver:
    """The given solver, by object or name; otherwise IPOPT, which solves everything."""
    if isinstance(solver, Solver):
        return solver
    if solver is None:
        return Ipopt(time_limit=FALLBACK_SECONDS)
    if solver.lower() in BACKENDS:
        return BACKENDS[solver.lower()]()
    raise InputError(Problem("solver", f"{solver!r} is not known; choose one of {', '.join(BACKENDS)}"))


def solvers_for(
    solver: Solver | str | None, vehicle: VehicleModel, formulation: Formulation
) -> tuple[Solver, tuple[Solver, ...]]:
    """The solver and its fall-backs: the stagewise one, fatrop and IPOPT, unless one is asked for by itself.

    Each only where it can be used: the stagewise solver for models that are compiled in, it and fatrop for lines.

    Raises:
        InputError: The stagewise solver is asked for and cannot solve this; or the name is not known.
    """
    fits = fits_stages(vehicle, formulation)
    if solver is None:
        chain: list[Solver] = [Stagewise()] if fits else []
        if with_unit_normal(formulation) is not None:
            chain.append(Fatrop(time_limit=FATROP_SECONDS))
        first, *others = [*chain, resolve_solver(None)]
        return first, tuple(others)
    chosen = resolve_solver(solver)
    if isinstance(chosen, Stagewise) and not fits:
        sentence = f"stagewise cannot solve {type(vehicle).__name__} with {formulation.name}"
        raise InputError(
            Problem("solver", f"{sentence}; choose ipopt, or a single-track vehicle with a line formulation")
        )
    return chosen, ()
