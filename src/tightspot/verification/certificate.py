"""The certificate: what was judged, the proof as data, and what was found if there is no proof."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from importlib import metadata
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import PlanFileError, Problem

Array = NDArray[np.float64]

FORMAT = "tightspot-certificate/1"
WORKSPACE = "workspace"
_SMALL = 1e-3
"""Below this, m, sentences say lengths by their leading digits."""


@dataclass(frozen=True)
class Witness:
    """The worst moment of one body part and one obstacle part: why there is no certificate.

    Attributes:
        time: s.
        part: Name of the body part.
        obstacle: Name of the obstacle part, or ``workspace`` where the body leaves W.
        clearance: Signed distance at that time, m; negative is minus the penetration depth.
        pose: (x, y, theta) of the rear-axle midpoint, m and rad, in the scenario's recentred coordinates.
        kind: ``collision`` (they overlap), ``margin`` (closer than demanded) or ``undecided`` (closer to the
            demanded clearance than the integration error can tell).
    """

    time: float
    part: str
    obstacle: str
    clearance: float
    pose: tuple[float, float, float]
    kind: str

    @property
    def penetration(self) -> float:
        """How deep they overlap, m, 0 if they do not."""
        return max(0.0, -self.clearance)

    def __str__(self) -> str:
        where = f"at t = {self.time:.3f} s"
        if self.obstacle == WORKSPACE:
            return f"{self.part} leaves the workspace by {metres(self.penetration)} m {where}"
        if self.kind == "collision":
            return f"{self.part} overlaps {self.obstacle} by {metres(self.penetration)} m {where}"
        if self.kind == "margin":
            return f"{self.part} is only {metres(self.clearance)} m from {self.obstacle} {where}"
        return f"{self.part} is {self.clearance:.9f} m from {self.obstacle} {where}: too near to decide"


class _Text:
    """A field of a record: the text, or what computes it when it is first asked for; empty if not given."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, record: Any, owner: type) -> str:
        if record is None:  # how a dataclass asks for the default
            return ""
        value = record.__dict__[self._name]
        if not isinstance(value, str):
            value = record.__dict__[self._name] = value()
        return str(value)

    def __set__(self, record: Any, value: str | Callable[[], str]) -> None:
        record.__dict__[self._name] = value


@dataclass(frozen=True)
class Check:
    """One thing that was checked.

    Attributes:
        name: For example ``goal position``.
        passed: Whether ``value`` keeps to ``limit``.
        value: What was found.
        limit: What is allowed: a lower limit for ``obstacles`` and ``workspace``, an upper limit for all
            others.
        sentence: The same for people, with units. It may be given as a function that is called when it is first asked
            for.
    """

    name: str
    passed: bool
    value: float
    limit: float
    sentence: _Text = _Text()

    @classmethod
    def of(cls, name: str, passed: bool, value: float, limit: float, sentence: Callable[[], str]) -> Check:
        """As the constructor, in less time."""
        made = object.__new__(cls)
        made.__dict__.update(name=name, passed=passed, value=value, limit=limit, sentence=sentence)
        return made


@dataclass(frozen=True, eq=False)
class ObstaclePart:
    """A convex part of an obstacle, as the proofs speak of it. The parts of an obstacle cover it.

    Attributes:
        name: The obstacle's name and the part's number, for example ``wall/0``.
        vertices: Counter-clockwise, m, recentred coordinates, shape (n, 2).
    """

    name: str
    vertices: Array


@dataclass(frozen=True, eq=False)
class PairProof:
    """Why one body part never comes near one obstacle part.

    During ``[t[i], t[i+1]]`` the obstacle part lies in ``nx[i] x + ny[i] y <= c[i]``, the body part beyond
    the line, and the two are at least ``clearance[i]`` apart.

    Attributes:
        part: Name of the body part.
        obstacle: Name of the obstacle part.
        t: Cuts of the horizon, s, shape (M+1,).
        nx: x of the lines' unit normals, which point to the body, shape (M,).
        ny: y of the normals, shape (M,).
        c: Offsets of the lines, m, recentred coordinates, shape (M,).
        clearance: Proved lower bound on each interval, m, shape (M,).
    """

    part: str
    obstacle: str
    t: Array
    nx: Array
    ny: Array
    c: Array
    clearance: Array


@dataclass(frozen=True, eq=False)
class WorkspaceProof:
    """Why one body part never crosses one edge ``E[edge] q <= f[edge]`` of the workspace.

    Attributes:
        part: Name of the body part.
        edge: Index of the half-plane.
        t: Cuts of the horizon, s, shape (M+1,).
        clearance: Proved lower bound of ``f - E q`` over the part on each interval, m, shape (M,).
    """

    part: str
    edge: int
    t: Array
    clearance: Array


@dataclass(frozen=True)
class Integration:
    """How the judge replayed the motion, for information; the proof's checker integrates by itself.

    Attributes:
        method: In words.
        substeps: Steps over the whole horizon.
        position_error: Estimated bound over the horizon, m; counted against every clearance.
        heading_error: The same for the heading, rad.
    """

    method: str
    substeps: int
    position_error: float
    heading_error: float


@dataclass(frozen=True, eq=False)
class Certificate:
    """The judge's finding. It is a certificate only if ``certified``.

    Attributes:
        certified: Whether every check passed.
        margin: Demanded clearance, m.
        clearance: Proved lower bound of the clearance over all pairs and times, m; infinite without
            obstacles.
        witnesses: Worst moment of every pair without proof, the worst first; empty if certified.
        checks: Everything that was checked, in a fixed order.
        obstacles: The obstacles' convex parts, in order.
        pairs: The proof for obstacles, body parts in order, and for each the obstacle parts in order.
        workspace: The proof for W, body parts in order, and for each the edges in order.
        integration: How the motion was replayed.
        offset: What the file's coordinates have more than the certificate's, (m, m).
        version: Of tightspot.
        digest: SHA-256 over scenario, vehicle, trajectory and certificate, see :func:`digest`. It may be given as a
            function that is called when it is first asked for.
    """

    certified: bool
    margin: float
    clearance: float
    witnesses: tuple[Witness, ...]
    checks: tuple[Check, ...]
    obstacles: Sequence[ObstaclePart]
    pairs: Sequence[PairProof]
    workspace: Sequence[WorkspaceProof]
    integration: Integration
    offset: tuple[float, float]
    version: str
    digest: _Text = _Text()

    @property
    def witness(self) -> Witness | None:
        """The worst moment found, or ``None``."""
        return self.witnesses[0] if self.witnesses else None

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that did not pass."""
        return tuple(check for check in self.checks if not check.passed)

    @property
    def intervals(self) -> int:
        """Number of lines in the proof, those of the workspace included."""
        return sum(proof.t.size - 1 for proof in self.pairs) + sum(proof.t.size - 1 for proof in self.workspace)

    def check(self, name: str) -> Check:
        """The check of that name; raises ``KeyError`` if it was not made (a free goal speed, for example)."""
        for check in self.checks:
            if check.name == name:
                return check
        raise KeyError(name)

    def summary(self) -> list[str]:
        """Lines for people."""
        if self.certified:
            shown = (
                "there is nothing to touch"
                if math.isinf(self.clearance)
                else f"clearance >= {rounded_down(self.clearance)} m"
            )
            head = f"certified for all times: {shown} (demanded {self.margin:.4f} m)"
        else:
            head = f"NOT certified (demanded clearance {self.margin:.4f} m)"
        lines = [
            head,
            *(f"{'ok' if check.passed else 'FAILED':6s} {check.sentence}" for check in self.checks),
        ]
        lines += [f"witness: {witness}" for witness in self.witnesses[:5]]
        if len(self.witnesses) > 5:
            lines.append(f"and {len(self.witnesses) - 5} more pairs")
        if self.certified:
            lines.append(f"proof: {self.intervals} lines for {len(self.pairs)} pairs, digest {self.digest[:16]}")
        return lines

    def to_dict(self) -> dict[str, Any]:
        """The plan file's ``certificate``: plain data, infinities as ``null``."""
        return {
            "format": FORMAT,
            "version": self.version,
            "certified": self.certified,
            "margin": self.margin,
            "clearance": _finite(self.clearance),
            "offset": list(self.offset),
            "witnesses": [{**_plain(witness), "pose": list(witness.pose)} for witness in self.witnesses],
            "checks": [{**_plain(check), "value": _finite(check.value)} for check in self.checks],
            "obstacles": [_plain(part) for part in self.obstacles],
            "pairs": [_plain(proof) for proof in self.pairs],
            "workspace": [_plain(proof) for proof in self.workspace],
            "integration": _plain(self.integration),
            "digest": self.digest,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Certificate:
        """Inverse of :meth:`to_dict`.

        Only the form is checked here; whether it proves anything is for :func:`check_certificate`.

        Raises:
            PlanFileError: With every problem and its path.
        """
        from tightspot.verification.certificate_file import read_certificate  # which imports this module

        return read_certificate(data)


def digest(
    scenario: Mapping[str, Any],
    vehicle: Mapping[str, Any],
    trajectory: Mapping[str, Any],
    certificate: Mapping[str, Any],
) -> str:
    """SHA-256 in hexadecimal over the four objects of a plan file, the certificate without its ``digest``.

    They are written as one JSON object with keys ``scenario``, ``vehicle``, ``trajectory``, ``certificate``:
    all keys sorted, no spaces, non-ASCII characters escaped, every number as a double in Python's ``repr``,
    the shortest decimal that reads back as the same double, with ``.0`` if it is whole (3 is 3.0).

    Raises:
        PlanFileError: Something is not plain, finite data.
    """
    bare = {key: value for key, value in certificate.items() if key != "digest"}
    whole = {"scenario": scenario, "vehicle": vehicle, "trajectory": trajectory, "certificate": bare}
    try:
        text = json.dumps(_doubles(whole), sort_keys=True, separators=(",", ":"), allow_nan=False)
    except (TypeError, ValueError, OverflowError) as error:
        raise PlanFileError(Problem("", f"cannot be written as JSON: {error}")) from None
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def _doubles(data: Any) -> Any:
    """The same plain data with every number as a double."""
    if type(data) is list:  # most of the data: lists of doubles
        return [item + 0.0 if type(item) is float else _doubles(item) for item in data]
    if isinstance(data, Mapping):
        return {key: _doubles(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_doubles(value) for value in data]
    return float(data) + 0.0 if isinstance(data, int | float) and not isinstance(data, bool) else data


@cache
def package_version() -> str:
    """Version of the installed tightspot, ``0+unknown`` if it is run from a bare directory."""
    try:
        return metadata.version("tightspot")
    except metadata.PackageNotFoundError:
        return "0+unknown"


def rounded_down(length: float) -> str:
    """A length (m) like :func:`metres`, but never larger than it is: what is promised must hold."""
    if not 0 < length < _SMALL:
        return f"{math.floor(length * 1e4) / 1e4:.4f}"
    unit = 10.0 ** (math.floor(math.log10(length)) - 1)
    return f"{math.floor(length / unit) * unit:.1e}"


def metres(length: float) -> str:
    """A length (m) to 0.1 mm for sentences, a small one to two digits, so that what overlaps never does so by 0."""
    return f"{length:.1e}" if 0 < abs(length) < _SMALL else f"{length:.4f}"


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _plain(record: Any) -> dict[str, Any]:
    values = {field.name: getattr(record, field.name) for field in fields(record)}
    return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in values.items()}
