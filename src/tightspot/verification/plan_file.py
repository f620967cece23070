"""Plan files: a plan with everything needed to judge it again, in the format ``tightspot-plan/1``."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from pydantic import BaseModel, ConfigDict, ValidationError

from tightspot import vehicles
from tightspot.errors import InputError, PlanFileError, Problem
from tightspot.files import atomic_write
from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack, VehicleModel
from tightspot.verification.certificate import Certificate
from tightspot.verification.certificate_file import problem_of
from tightspot.verification.checker import CheckResult, check_certificate
from tightspot.verification.driven import Array, DrivenTrajectory
from tightspot.verification.file_exact import file_exact
from tightspot.verification.judge import JudgeSettings, verify
from tightspot.verification.replay import Replay

FORMAT = "tightspot-plan/1"
MAX_BYTES = 50_000_000
MOST_TIMES = 1_000_000

_T = TypeVar("_T")


class _TrajectoryFile(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)

    t: list[float]
    states: dict[str, list[float]]
    inputs: dict[str, list[float]]


@dataclass(frozen=True, eq=False)
class Plan:
    """A trajectory, what it was planned for, and the proof that it is safe.

    Attributes:
        scenario: In recentred coordinates, rounded to what the file can say (:func:`file_exact`).
        vehicle: Whose trajectory it is.
        trajectory: In the scenario's recentred coordinates, rounded likewise. It knows its vehicle, so it can be
            asked for any time: :class:`DrivenTrajectory`.
        certificate: The judge's finding.
        report: How it was found: plain data for JSON. Not covered by the certificate's digest.
    """

    scenario: Scenario
    vehicle: VehicleModel
    trajectory: Trajectory
    certificate: Certificate
    report: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        scenario, trajectory = file_exact(self.scenario, self.trajectory)
        object.__setattr__(self, "scenario", scenario)
        object.__setattr__(self, "trajectory", DrivenTrajectory.of(trajectory, self.vehicle))

    def sample(self, times: ArrayLike) -> Array:
        """States at ``times`` (...) in s, shape (..., n_x), in the scenario's *original* coordinates.

        That is what the written files hold; ``plan.trajectory.sample`` gives the same in recentred coordinates, see
        :meth:`DrivenTrajectory.sample`.

        Raises:
            InputError: A time before the first or after the last knot, or the trajectory cannot be integrated.
        """
        states = self._driven.sample(times)
        names = self.trajectory.state_names
        states[..., [names.index("x"), names.index("y")]] += self.scenario.offset
        return states

    def sample_inputs(self, times: ArrayLike) -> Array:
        """Inputs at ``times`` (...) in s, shape (..., n_u), see :meth:`DrivenTrajectory.sample_inputs`."""
        return self._driven.sample_inputs(times)

    def times(self, dt: float) -> Array:
        """Times at most ``dt`` apart that include every knot, s.

        Raises:
            InputError: ``dt`` is not a positive time or would give more than a million times, or the trajectory cannot
                be integrated.
        """
        if not (np.isfinite(dt) and dt > 0):
            raise InputError(Problem("dt", f"{dt} s must be a positive time"))
        if self.trajectory.duration / dt > MOST_TIMES:
            raise InputError(Problem("dt", f"{dt:g} s would give more than {MOST_TIMES} rows; take a longer one"))
        return self.replay.dense(dt)

    @property
    def replay(self) -> Replay:
        """The continuous motion, in recentred coordinates; raises :class:`InputError` if it cannot be integrated."""
        return self._driven.replay

    @property
    def _driven(self) -> DrivenTrajectory:
        return DrivenTrajectory.of(self.trajectory, self.vehicle)

    def to_dict(self) -> dict[str, Any]:
        """The plan file's object, in the scenario's original coordinates."""
        return {
            "format": FORMAT,
            "scenario": self.scenario.to_dict(),
            "vehicle": self.vehicle.to_dict(),
            "trajectory": self.trajectory.shifted(self.scenario.offset).to_dict(),
            "certificate": self.certificate.to_dict(),
            "report": self.report,
        }

    @classmethod
    def from_dict(cls, data: Any) -> Plan:
        """Inverse of :meth:`to_dict`. The certificate is read, not believed: see :func:`verify_plan`.

        Raises:
            PlanFileError: With every problem and its path in the file.
        """
        _check_keys(data)
        problems: list[Problem] = []
        scenario = _read("scenario", data, Scenario.from_dict, problems)
        vehicle = _read("vehicle", data, _vehicle, problems)
        trajectory = _read("trajectory", data, _trajectory, problems)
        certificate = _read("certificate", data, Certificate.from_dict, problems)
        if not isinstance(data["report"], dict):
            problems.append(Problem("report", "must be an object"))
        if problems or not (scenario and vehicle and trajectory and certificate):
            raise PlanFileError(problems)
        for key in ("state_names", "input_names"):
            have, need = getattr(trajectory, key), getattr(vehicle, key)
            if set(have) != set(need):
                raise PlanFileError(Problem(f"trajectory.{key.split('_')[0]}s", f"are {have}; the vehicle has {need}"))
        ordered = Trajectory.from_dict(trajectory.to_dict(), vehicle.state_names, vehicle.input_names)
        recentred = ordered.shifted(-np.asarray(scenario.offset))
        return cls(scenario, vehicle, recentred, certificate, data["report"])


@dataclass(frozen=True)
class Verdict:
    """What a second judgement of a stored plan says.

    Attributes:
        upheld: Whether the plan is certified anew *and* its stored certificate proves its claim.
        certificate: The new finding, for the margin of the stored one.
        stored: The checker's answer about the stored certificate.
    """

    upheld: bool
    certificate: Certificate
    stored: CheckResult

    def summary(self) -> list[str]:
        """Lines for people."""
        head = "the plan is upheld" if self.upheld else "the plan is NOT upheld"
        stored = "the stored certificate proves its claim" if self.stored.ok else "the stored certificate is rejected"
        reasons = [f"  because {reason}" for reason in self.stored.reasons]
        return [head, *self.certificate.summary(), stored, *reasons]


def save_plan(plan: Plan, path: str | Path) -> None:
    """Write a plan file, completely or not at all.

    Raises:
        PlanFileError: The report holds something that JSON cannot, or the vehicle's class moves otherwise than the
            single-track model that the file would name.
        OSError: The file cannot be written.
    """
    vehicle = plan.vehicle
    if isinstance(vehicle, SingleTrack) and not vehicle.moves_as_stated:
        sentence = (
            f"class {type(vehicle).__name__} has a motion of its own, but a file holds single-track vehicles only"
        )
        raise PlanFileError(Problem("vehicle", f"{sentence}; write the trajectory as a table (write_trajectory_csv)"))
    try:
        lines = [f"{json.dumps(key)}: {json.dumps(value, allow_nan=False)}" for key, value in plan.to_dict().items()]
    except (TypeError, ValueError, RecursionError) as error:
        raise PlanFileError(Problem("report", f"cannot be written as JSON: {error}")) from None
    atomic_write(path, "{\n" + ",\n".join(lines) + "\n}\n")


def load_plan(path: str | Path) -> Plan:
    """Read a plan file.

    Raises:
        PlanFileError: The file cannot be read, is too large, is no JSON or no plan; all problems with their
            paths.
    """
    try:
        with Path(path).open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise PlanFileError(Problem(str(path), f"cannot be read: {reason}")) from None
    if len(content) > MAX_BYTES:
        raise PlanFileError(Problem(str(path), f"is larger than {MAX_BYTES // 1_000_000} MB, too large for a plan"))
    try:
        data = json.loads(content.decode(), parse_constant=_no_constant, object_pairs_hook=_without_repeats)
    except (ValueError, RecursionError) as error:
        raise PlanFileError(Problem(str(path), f"is no JSON file: {error}")) from None
    return Plan.from_dict(data)


def verify_plan(plan: Plan, *, settings: JudgeSettings | None = None) -> Verdict:
    """Judge a stored plan from scratch and check its stored certificate.

    Unless ``settings`` say otherwise the judge works in NumPy, so that no compiled code is to be trusted.

    Raises:
        InputError: The trajectory cannot be integrated at all.
    """
    settings = settings or JudgeSettings(in_core=False)
    arguments = plan.scenario, plan.vehicle, plan.trajectory
    margin = max(0.0, plan.certificate.margin)
    certificate = verify(*arguments, margin=margin, settings=settings)
    stored = check_certificate(*arguments, plan.certificate)
    return Verdict(certificate.certified and stored.ok, certificate, stored)


def write_trajectory_csv(plan: Plan, path: str | Path, dt: float = 0.05) -> None:
    """Write the replayed motion as CSV: t, the states and the inputs, at times at most ``dt`` (s) apart and
    the knots.

    Coordinates are the scenario's original ones. The inputs are those from the row's time on; the last row
    repeats the last interval's.

    Raises:
        InputError: ``dt`` is not a positive time, or the trajectory cannot be integrated.
        OSError: The file cannot be written.
    """
    times = plan.times(dt)
    rows = np.column_stack([times, plan.sample(times), plan.sample_inputs(times)])
    header = ",".join(("t", *plan.vehicle.state_names, *plan.vehicle.input_names))
    lines = [",".join(repr(value) for value in row) for row in rows.tolist()]
    atomic_write(path, "\n".join([header, *lines]) + "\n")


def _check_keys(data: Any) -> None:
    if not isinstance(data, Mapping):
        raise PlanFileError(Problem("", f"a plan file holds one object in the format {FORMAT!r}"))
    if data.get("format") != FORMAT:
        shown = repr(data["format"])[:80] if "format" in data else "missing"
        raise PlanFileError(Problem("format", f"is {shown}, it must be {FORMAT!r}"))
    keys = ("format", "scenario", "vehicle", "trajectory", "certificate", "report")
    problems = [Problem(key, "is missing") for key in keys if key not in data]
    problems += [Problem(str(key)[:80], "is not a key of a plan file") for key in data if key not in keys]
    if problems:
        raise PlanFileError(problems)


def _read(key: str, data: Mapping[str, Any], read: Callable[[Any], _T], problems: list[Problem]) -> _T | None:
    if not isinstance(data[key], dict):
        problems.append(Problem(key, "must be an object"))
        return None
    try:
        return read(data[key])
    except InputError as error:
        problems += [
            Problem(key + (p.path if p.path.startswith("[") or not p.path else f".{p.path}"), p.message)
            for p in error.problems
        ]
    return None


def _vehicle(data: Any) -> VehicleModel:
    return vehicles.from_dict(data)


def _trajectory(data: Any) -> Trajectory:
    try:
        file = _TrajectoryFile.model_validate(data)
    except ValidationError as error:
        raise PlanFileError([problem_of(detail) for detail in error.errors()]) from None
    return Trajectory.from_dict(file.model_dump())


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a number in JSON")


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(pairs)
    if len(data) != len(pairs):
        raise ValueError("an object has the same key twice")
    return data
