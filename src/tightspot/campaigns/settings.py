"""The paper's settings as data: those that reproduce its Table II, and those that it prints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from tightspot.errors import InputError, Problem
from tightspot.formulations import Formulation
from tightspot.guesses import CollisionFreeModel, Guess, HybridAStar, SimplifiedModel
from tightspot.scenarios import Obstacle, Scenario
from tightspot.scenarios.library import builtin
from tightspot.solvers import Ipopt
from tightspot.transcription import EnergyForm, Objective, Settings
from tightspot.vehicles import VehicleModel, vehicle

SCENES = ("vertical", "parallel", "oblique")
GUESS_NAMES = ("simplified", "collision-free", "hybrid-astar")


@dataclass(frozen=True)
class PaperSettings:
    """Everything that decides what Table II's programs are.

    Attributes:
        name: ``recovered`` or ``printed``.
        vehicle: In the catalogue.
        objective: J.
        steps: k_f, intervals with constant inputs.
        substeps: RK4 steps an interval.
        gap: Demanded separation at the knots, m.
        heading_limit: Bound of |theta|, rad.
        final_time: Bounds of t_f, s.
        guess_weights: p and r of eq. (26) and (27), which the paper does not print.
        corners: Obstacles whose vertices differ from the built-in scene's: (scene, obstacle) to vertices, m.
        evidence: For each recovered or chosen value why it is what it is.
    """

    name: str
    vehicle: str
    objective: Objective
    steps: int
    substeps: int
    gap: float
    heading_limit: float
    final_time: tuple[float, float]
    guess_weights: tuple[float, float]
    corners: Mapping[tuple[str, str], tuple[tuple[float, float], ...]]
    evidence: Mapping[str, str]

    def car(self) -> VehicleModel:
        """The vehicle's model."""
        return vehicle(self.vehicle)

    def scenario(self, name: str) -> Scenario:
        """One of the paper's three scenes with these settings' obstacles."""
        scene = builtin(name)
        changed = {obstacle: corners for (where, obstacle), corners in self.corners.items() if where == name}
        obstacles = [
            Obstacle(obstacle.name, np.array(changed.get(obstacle.name, obstacle.exterior), float))
            for obstacle in scene.obstacles
        ]
        return scene.with_(obstacles=tuple(obstacles), vehicle=self.vehicle)

    def transcription(self, formulation: Formulation) -> Settings:
        """What :func:`tightspot.transcription.transcribe` is told."""
        return Settings(
            self.objective,
            formulation,
            margin=self.gap,
            end_margin=self.gap,
            substeps=self.substeps,
            final_time=self.final_time,
            heading_limit=self.heading_limit,
        )

    def guess(self, name: str) -> Guess:
        """One of the paper's three guesses with its settings."""
        p, r = self.guess_weights
        options: dict[str, Any] = {
            "steps": self.steps,
            "speed_weight": p,
            "time_weight": r,
            "substeps": self.substeps,
            "heading_limit": self.heading_limit,
        }
        if name == SimplifiedModel.name:
            return SimplifiedModel(**options)
        if name == CollisionFreeModel.name:
            return CollisionFreeModel(**options)
        if name == HybridAStar.name:
            return HybridAStar()
        raise InputError(Problem("guess", f"{name!r} is not one of the paper's: {', '.join(GUESS_NAMES)}"))

    def solver(self, time_limit: float) -> Ipopt:
        """IPOPT with its own default barrier strategy, as the paper used it."""
        return Ipopt(max_iterations=3000, time_limit=time_limit, options={"mu_strategy": "monotone"})


_RECOVERED = {
    "objective": "Printed: J = t_f (r + integral), r = 1, P = diag(1, 2), which forces J >= t_f; the table has "
    "J = 1.012 at t_f = 80.3 s. J = 0.0095 t_f + 5.255 sum (a_k^2 + 2 omega_k^2) over the 20 intervals, so that t_f "
    "does not multiply the sum, gives J, t_f and TS of 8 of the 11 distinct rows within 0.1 % of J.",
    "wheelbase": "Printed: 2.796 m. With 4.628 m, the car's length, the rows come out; with 2.796 m they do not.",
    "rear overhang": "Not printed. 0.928 m together with the length 4.628 m and the width 2.097 m.",
    "substeps": "Printed: explicit RK4. 4 steps an interval reproduce the rows; intervals last 3.5 to 8.5 s.",
    "units": "Printed: |v| <= 5/3.6 m/s^2, |omega| <= 5 deg/s^2. Read as m/s and deg/s (erratum 6).",
    "gap": 'Not printed (d_safe, "> 0"). Any gap up to 2 mm reproduces the rows; 2 mm is taken.',
    "vertical, right obstacle": "Printed: x <= 0 against x >= 7.5, which is empty. 7.5 <= x <= 15, the "
    "workspace's edge.",
    "parallel, front obstacle": "Printed: x - y <= -12, x >= -20. 11.98 <= x <= 20 reproduces the rows.",
    "guess weights": "Not printed. With p = 10, r = 1 the collision-free guess leads all six formulations to J = 1.221 "
    "in the parallel scene, as in the table; with p = 1, r = 1 none of them. The other cells do not tell.",
    "k_f": 'Printed: "k_f + 1 parts", k_f = 20. VN = 146 + ... = 5*21 + 2*20 + 1 shows 20 intervals and 21 knots.',
}
_PRINTED = {
    "objective": "J = t_f (r + integral), r = 1, P = diag(1, 2), eq. (25).",
    "wheelbase": "2.796 m, section 7.1.",
    "rear overhang": "Not printed. 0.929 m.",
    "substeps": "RK4, section 7.2; one step an interval.",
    "units": "As in the recovered settings.",
    "gap": "Not printed. 2 mm.",
    "vertical, right obstacle": "As in the recovered settings.",
    "parallel, front obstacle": "12 <= x <= 20: the printed -12 with its sign mended.",
    "guess weights": "Not printed. p = 10, r = 1, as in the recovered settings.",
    "k_f": "20.",
}


def paper_settings(which: Literal["recovered", "printed"] | str = "recovered") -> PaperSettings:
    """The paper's settings: ``recovered`` from its Table II, or as ``printed``.

    Raises:
        InputError: For any other name.
    """
    common: dict[str, Any] = {"steps": 20, "gap": 2e-3, "heading_limit": np.pi, "final_time": (0.1, 1000.0)}
    common["guess_weights"] = (10.0, 1.0)
    if which == "recovered":
        # The objective's integral has the intervals' fractions 1/20 as weights, the recovered sum has not.
        weights = (5.255 * 20, 2 * 5.255 * 20)
        return PaperSettings(
            "recovered",
            "paper-recovered",
            Objective(0.0095, weights, EnergyForm.NORMALISED),
            substeps=4,
            corners=MappingProxyType({}),
            evidence=MappingProxyType(_RECOVERED),
            **common,
        )
    if which == "printed":
        front = ((12.0, -6.0), (20.0, -6.0), (20.0, -3.0), (12.0, -3.0))
        return PaperSettings(
            "printed",
            "paper",
            Objective(1.0, (1.0, 2.0), EnergyForm.TIME_SCALED),
            substeps=1,
            corners=MappingProxyType({("parallel", "front"): front}),
            evidence=MappingProxyType(_PRINTED),
            **common,
        )
    raise InputError(Problem("settings", f"{which!r} is not known; choose recovered or printed"))
