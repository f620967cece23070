"""Reading a certificate's plain data back, with every problem and its path."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from tightspot.errors import PlanFileError, Problem
from tightspot.verification.certificate import (
    FORMAT,
    Certificate,
    Check,
    Integration,
    ObstaclePart,
    PairProof,
    Witness,
    WorkspaceProof,
)

Numbers = Annotated[list[float], Field(max_length=2_000_000)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class _WitnessFile(_Strict):
    time: float
    part: str
    obstacle: str
    clearance: float
    pose: Annotated[list[float], Field(min_length=3, max_length=3)]
    kind: Literal["collision", "margin", "undecided"]


class _CheckFile(_Strict):
    name: str
    passed: bool
    value: float | None
    limit: float
    sentence: str


class _ObstacleFile(_Strict):
    name: str
    vertices: Annotated[list[Annotated[list[float], Field(min_length=2, max_length=2)]], Field(min_length=3)]


class _PairFile(_Strict):
    part: str
    obstacle: str
    t: Numbers
    nx: Numbers
    ny: Numbers
    c: Numbers
    clearance: Numbers


class _WorkspaceFile(_Strict):
    part: str
    edge: int
    t: Numbers
    clearance: Numbers


class _IntegrationFile(_Strict):
    method: str
    substeps: int
    position_error: float
    heading_error: float


class _CertificateFile(_Strict):
    format: Literal["tightspot-certificate/1"]
    version: str
    certified: bool
    margin: float
    clearance: float | None
    offset: Annotated[list[float], Field(min_length=2, max_length=2)]
    witnesses: list[_WitnessFile]
    checks: list[_CheckFile]
    obstacles: list[_ObstacleFile]
    pairs: list[_PairFile]
    workspace: list[_WorkspaceFile]
    integration: _IntegrationFile
    digest: str


def read_certificate(data: Mapping[str, Any]) -> Certificate:
    """See :meth:`Certificate.from_dict`."""
    if not isinstance(data, Mapping):
        raise PlanFileError(Problem("", f"must be an object in the format {FORMAT!r}"))
    try:
        file = _CertificateFile.model_validate(dict(data))
    except ValidationError as error:
        raise PlanFileError([problem_of(detail) for detail in error.errors()]) from None
    return Certificate(
        certified=file.certified,
        margin=file.margin,
        clearance=_bound(file.clearance, file.certified),
        witnesses=tuple(_witness(item) for item in file.witnesses),
        checks=tuple(
            Check(item.name, item.passed, _bound(item.value, item.passed), item.limit, item.sentence)
            for item in file.checks
        ),
        obstacles=tuple(ObstaclePart(item.name, np.array(item.vertices)) for item in file.obstacles),
        pairs=tuple(PairProof(**_arrays(item)) for item in file.pairs),
        workspace=tuple(WorkspaceProof(**_arrays(item)) for item in file.workspace),
        integration=Integration(**dict(file.integration)),
        offset=(file.offset[0], file.offset[1]),
        version=file.version,
        digest=file.digest,
    )


def problem_of(detail: Any) -> Problem:
    """One of pydantic's error details as a problem with its path in the file."""
    path = "".join(f"[{item}]" if isinstance(item, int) else f".{item}" for item in detail["loc"]).lstrip(".")
    value = detail.get("input")
    shown = "" if isinstance(value, Mapping | list) else f" (given: {str(value)[:80]!r})"
    return Problem(path, f"{detail['msg']}{shown}")


def _bound(value: float | None, good: bool) -> float:
    if value is not None:
        return value
    return math.inf if good else -math.inf


def _witness(item: _WitnessFile) -> Witness:
    x, y, theta = item.pose
    return Witness(item.time, item.part, item.obstacle, item.clearance, (x, y, theta), item.kind)


def _arrays(item: _PairFile | _WorkspaceFile) -> dict[str, Any]:
    return {name: np.array(value) if isinstance(value, list) else value for name, value in dict(item).items()}
