"""The search's path driven as it is: certified, though not optimised, where no solver gets further.

Arcs that are driven from rest to rest, with the wheels turned at standstill in between, sweep exactly what the path
sweeps. So if the path keeps the margin, the trajectory does; the judge says whether it does.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from tightspot.formulations import SweptLine
from tightspot.guesses import GuessResult
from tightspot.guesses.lifting import lift_path
from tightspot.planner.request import Request
from tightspot.planner.rounds import Mesh, Round, Step
from tightspot.search import SearchResult
from tightspot.solvers import SolveReport, SolveStatus
from tightspot.transcription import Settings, TimeGrid, Transcription, transcribe
from tightspot.vehicles import SingleTrack
from tightspot.verification import verify
from tightspot.verification.replay import replay

NOTE = "not optimised: the searched path as it is, driven arc by arc"


def driven_as_found(request: Request, found: GuessResult) -> Round | None:
    """A certified round without a solve; ``None`` if there is no path, or the judge does not certify it.

    Start and goal must be at rest: the path is driven from rest to rest. Who asks for a solver, a formulation or a
    number of intervals wants that solved, and nothing else.
    """
    result, car, scenario = found.details, request.vehicle, request.scenario
    if not (isinstance(result, SearchResult) and result.path is not None and isinstance(car, SingleTrack)):
        return None
    if not (request.fallbacks and request.formulation == SweptLine() and request.steps is None):
        return None
    began = time.perf_counter()
    start = lift_path(result.path, scenario, car, "standing")
    motion = replay(car, start)
    trajectory = replace(start, states=motion.knots)
    certificate = verify(scenario, car, trajectory, margin=request.margin)
    if not certificate.certified:
        return None
    N, parts = trajectory.steps, len(car.parts)
    mesh = Mesh(
        formulation=request.formulation,
        grid=TimeGrid(np.r_[start.t[:-1] / start.t[-1], 1.0]),
        poses=(1,) * N,
        extra=0.0,
        active=np.ones((N, parts, len(scenario.obstacle_parts)), bool),
        walls=np.ones((N, parts, len(scenario.workspace.b)), bool),
    )

    def program() -> Transcription:
        settings = Settings(objective=request.objective, formulation=mesh.formulation, margin=request.margin)
        return transcribe(scenario, car, start, settings, grid=mesh.grid, active=mesh.active, walls=mesh.walls)

    timings = {"set_up": 0.0, "solve": 0.0, "judge": time.perf_counter() - began}
    step = Step(mesh, start, "as found", f"no solver got further; {NOTE}")
    report = NotSolved.of(request.objective.value(trajectory.t, trajectory.inputs))
    return Round(step, program, report, (), trajectory, motion, certificate, None, "", timings)


class NotSolved(SolveReport):
    """Says that nothing was solved."""

    @classmethod
    def of(cls, objective: float) -> NotSolved:
        """Of a trajectory with this J."""
        nothing = np.zeros(0)
        status, never = SolveStatus.STOPPED, np.inf
        return cls(status, "none", nothing, objective, nothing, nothing, nothing, 0, 0.0, never, "", note=NOTE)

    def to_dict(self) -> dict[str, Any]:
        return super().to_dict() | {"status": "NOT_SOLVED", "sentence": NOTE, "stationarity": None}
