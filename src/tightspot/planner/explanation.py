"""Why there is no plan, as data and as sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.planner.passing import Deeper
from tightspot.planner.penetration import Contact, Penetration
from tightspot.planner.reach import Reach
from tightspot.planner.solver_stop import SolverStop
from tightspot.scenarios import Blocked, Scenario
from tightspot.scenarios.bottleneck import Bottleneck
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification import Certificate, Witness

Array = NDArray[np.float64]


class FailureKind(Enum):
    """Why there is no plan: the first of these that applies. The value is the sentence that says so."""

    START_BLOCKED = "The vehicle cannot stand at the start."
    GOAL_BLOCKED = "The vehicle cannot stand at the goal."
    NO_PATH = "The search found no path."
    SOLVER_STOPPED = "The solver stopped before it had a trajectory."
    ONLY_PENETRATING = "Only trajectories that come too near were found."
    NOT_CERTIFIED = "The judge did not certify the trajectory that was found."

    @property
    def sentence(self) -> str:
        """The value, for people."""
        return self.value

    @property
    def word(self) -> str:
        """For programs, for example ``no-path``."""
        return self.name.lower().replace("_", "-")


@dataclass(frozen=True, eq=False)
class Explanation:
    """Why there is no plan and what to change.

    Positions in the attributes are in the scenario's coordinates; those in sentences and in :meth:`to_dict` are in the
    scene file's, which differ by the scenario's offset.

    Attributes:
        kind: The first cause that applies.
        sentence: What was found.
        remedy: What to change.
        scenario: Where it was tried.
        vehicle: With what.
        margin: Demanded clearance, m.
        blocked: Start and goal, if blocked: by what, how deep, and what would free them.
        reach: How far the search came, if it found no path.
        bottleneck: The place where the vehicle cannot pass, if that is proved.
        solver: How the last solve ended, if it failed.
        penetration: The trajectory that penetrates least, if one was looked for.
        certificate: The judge's last word, if there was a trajectory to judge.
        trajectory: The last iterate or the trajectory that penetrates least: never a plan.
        witness: When it collides or comes too near, and with what.
        deeper: What would pass, if that was asked for (``explain=True``, ``--explain``).
    """

    kind: FailureKind
    sentence: str
    remedy: str
    scenario: Scenario
    vehicle: VehicleModel
    margin: float
    blocked: tuple[Blocked, ...] = ()
    reach: Reach | None = None
    bottleneck: Bottleneck | None = None
    solver: SolverStop | None = None
    penetration: Penetration | None = None
    certificate: Certificate | None = None
    trajectory: Trajectory | None = None
    witness: Witness | None = None
    deeper: Deeper | None = None

    def __str__(self) -> str:
        return " ".join([self.sentence, self.remedy, *self.findings])

    @property
    def findings(self) -> list[str]:
        """What the deeper analysis found, one sentence each."""
        return [] if self.deeper is None else self.deeper.sentences

    def pose_in_file(self, pose: Sequence[float]) -> list[float]:
        """(x, y, theta) in the scene file's coordinates."""
        x, y = pose[:2] + self.scenario.offset
        return [float(x), float(y), float(pose[2])]

    def to_dict(self) -> dict[str, Any]:
        """Plain data in the scene file's coordinates."""
        return {"kind": self.kind.word, "sentence": self.sentence, "remedy": self.remedy, **dict(self._parts())}

    def _parts(self) -> Iterator[tuple[str, Any]]:
        """What is known, by name."""
        offset = self.scenario.offset
        if self.blocked:
            yield "blocked", [end.to_dict() for end in self.blocked]
        if self.reach is not None:
            yield "search", self.reach.to_dict(offset)
        if self.bottleneck is not None:
            yield "bottleneck", self.bottleneck.to_dict(offset)
        if self.solver is not None:
            yield "solver", self.solver.to_dict()
        if self.penetration is not None:
            yield "penetration", self._penetration(self.penetration)
        if self.certificate is not None:
            yield "failed_checks", [check.sentence for check in self.certificate.failed]
        if self.witness is not None:
            yield "witness", {**vars(self.witness), "pose": self.pose_in_file(self.witness.pose)}
        if self.deeper is not None:
            yield "deeper", self.deeper.to_dict()

    def _penetration(self, found: Penetration) -> dict[str, Any]:
        return {
            "depth": found.depth,
            "contacts": [self._contact(contact) for contact in found.contacts],
            "nearest": None if found.nearest is None else self._contact(found.nearest),
        }

    def _contact(self, contact: Contact) -> dict[str, Any]:
        place = [float(value) for value in contact.place + self.scenario.offset]
        return {**vars(contact), "pose": self.pose_in_file(contact.pose), "place": place}
