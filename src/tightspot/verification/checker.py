"""The checker: does the certificate prove what it claims? It trusts nothing in the file and shares no code
with the judge.

It integrates the motion by its own method, moves the vertices by its own arithmetic and evaluates each
interval's lemma from the lines alone. All it does with geometry is to multiply, add and compare, and
everything that rounding or integration may have changed is counted against the certificate.

What the mathematics cannot see (a line moved within its gap still proves the claim; a sentence was reworded)
the SHA-256 digest does. A forger who computes the digest anew is left with alterations that leave the claim
true.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification.certificate import Certificate, PairProof, WorkspaceProof, digest
from tightspot.verification.file_exact import file_exact
from tightspot.verification.lemma import Lemma
from tightspot.verification.quadrature import IntegrationError
from tightspot.verification.recheck import reevaluate

Array = NDArray[np.float64]

WORKSPACE_LIMIT = -1e-6
_UNIT = 1e-12


@dataclass(frozen=True)
class CheckResult:
    """The checker's answer.

    Attributes:
        ok: Whether the certificate proves its claim for this scenario, vehicle and trajectory.
        reasons: If not, why: one sentence each.
    """

    ok: bool
    reasons: tuple[str, ...]


def check_certificate(
    scenario: Scenario, vehicle: VehicleModel, trajectory: Trajectory, certificate: Certificate
) -> CheckResult:
    """Check a certificate against what it speaks of.

    Args:
        scenario: In recentred coordinates, as all arguments; what the plan file holds.
        vehicle: What the plan file holds.
        trajectory: What the plan file holds.
        certificate: To be checked.

    Returns:
        ``ok``, or the reasons why not. A certificate that says "not certified" is not ok.
    """
    scenario, trajectory = file_exact(scenario, trajectory)
    odd = _digest(scenario, vehicle, trajectory, certificate)
    reasons = (*odd, *_claim(scenario, trajectory, vehicle, certificate))
    return CheckResult(not reasons, reasons)


def prove(scenario: Scenario, vehicle: VehicleModel, trajectory: Trajectory, certificate: Certificate) -> CheckResult:
    """The same without the digest: whether what is written proves the claim, whoever wrote it."""
    reasons = _claim(*file_exact(scenario, trajectory), vehicle, certificate)
    return CheckResult(not reasons, reasons)


def _claim(
    scenario: Scenario, trajectory: Trajectory, vehicle: VehicleModel, certificate: Certificate
) -> tuple[str, ...]:
    reasons = tuple(_form(scenario, certificate))
    if reasons:
        return reasons
    with np.errstate(over="ignore", invalid="ignore"):  # what overflows fails its comparison
        return tuple(_mathematics(scenario, vehicle, trajectory, certificate))


def _form(scenario: Scenario, certificate: Certificate) -> Iterator[str]:
    if not certificate.certified:
        yield "the certificate itself says that the plan is not certified"
    if certificate.witnesses:
        yield "the certificate lists a witness, so it cannot be one"
    if not (np.isfinite(certificate.margin) and certificate.margin >= 0):
        yield f"the demanded clearance {certificate.margin} m is not a length"
    if tuple(certificate.offset) != tuple(float(value) for value in scenario.offset):
        yield f"the certificate's offset is {certificate.offset}, the scenario's {tuple(scenario.offset)}"
    integration = certificate.integration
    if not (0 <= integration.position_error < 1e-3 and 0 <= integration.heading_error < 1e-3):
        yield "the judge's integration error is not small"
    if integration.substeps < 1:
        yield "the judge's replay has no step"


def _digest(
    scenario: Scenario, vehicle: VehicleModel, trajectory: Trajectory, certificate: Certificate
) -> Iterator[str]:
    written = trajectory.shifted(scenario.offset)
    if certificate.digest != digest(scenario.to_dict(), vehicle.to_dict(), written.to_dict(), certificate.to_dict()):
        yield "the digest does not belong to this scenario, vehicle, trajectory and certificate"


def _mathematics(
    scenario: Scenario, vehicle: VehicleModel, trajectory: Trajectory, certificate: Certificate
) -> Iterator[str]:
    proofs: list[PairProof | WorkspaceProof] = [*certificate.pairs, *certificate.workspace]
    odd = [reason for proof in proofs for reason in _cuts(proof.t, proof.clearance, trajectory, proof.part)]
    if odd:
        yield from odd
        return
    try:
        lemma = Lemma.of(vehicle, trajectory, np.concatenate([trajectory.t, *(proof.t for proof in proofs)]))
        yield from _obstacles(scenario, certificate)
        yield from _pairs(scenario, vehicle, certificate, lemma)
        yield from _workspace(scenario, vehicle, certificate, lemma)
        yield from _claims(certificate)
        yield from reevaluate(scenario, vehicle, trajectory, certificate, lemma.motion)
    except IntegrationError as error:
        yield f"the motion cannot be checked: {error}"


def _cuts(t: Array, clearance: Array, trajectory: Trajectory, name: str) -> Iterator[str]:
    if t.ndim != 1 or t.size < 2 or clearance.shape != (t.size - 1,):
        yield f"a proof of {name} has no intervals, or not one number for each"
    elif not (np.isfinite(t).all() and (np.diff(t) > 0).all()):
        yield f"the intervals of a proof of {name} do not follow one another"
    elif t[0] != trajectory.t[0] or t[-1] != trajectory.t[-1]:
        yield f"a proof of {name} covers [{t[0]:g}, {t[-1]:g}] s, not the whole horizon"


def _obstacles(scenario: Scenario, certificate: Certificate) -> Iterator[str]:
    """The parts listed must be those that the scenario's obstacles decompose into: they cover the obstacles."""
    parts = scenario.obstacle_parts
    if [part.name for part in certificate.obstacles] != [name for name, _ in parts]:
        yield "the obstacle parts are not the scenario's, in order"
        return
    for part, (_, polygon) in zip(certificate.obstacles, parts, strict=True):
        if not np.array_equal(part.vertices, polygon.vertices):
            yield f"{part.name} is not the scenario's"


def _pairs(scenario: Scenario, vehicle: VehicleModel, certificate: Certificate, lemma: Lemma) -> Iterator[str]:
    obstacles = scenario.obstacle_parts
    expected = [(part.name, name) for part in vehicle.parts for name, _ in obstacles]
    if [(proof.part, proof.obstacle) for proof in certificate.pairs] != expected:
        yield "the proofs are not those of every body part with every obstacle part, in order"
        return
    for index, proof in enumerate(certificate.pairs):
        part, obstacle = divmod(index, len(obstacles))
        name = f"{proof.part} and {proof.obstacle}"
        shape = proof.clearance.shape
        if not proof.nx.shape == proof.ny.shape == proof.c.shape == shape:
            yield f"the lines of {name} are incomplete"
            continue
        normal = np.stack([proof.nx, proof.ny], axis=1)
        if not (np.abs(proof.nx**2 + proof.ny**2 - 1) <= _UNIT).all():
            yield f"a normal of {name} is not a unit vector"
            continue
        reach, rounding = _highest(normal, obstacles[obstacle][1].vertices)
        below = proof.c - reach - rounding
        above = lemma.lowest(part, proof.t, normal) - proof.c - _UNIT
        if not (below >= 0).all():
            yield f"the line of {name} at t = {_first(proof.t, below >= 0):g} s cuts the obstacle"
        elif not (above >= 0).all():
            yield f"the line of {name} at t = {_first(proof.t, above >= 0):g} s may cut the body"
        elif not (proof.clearance <= (below + above) * (1 - _UNIT)).all():
            at = _first(proof.t, proof.clearance <= (below + above) * (1 - _UNIT))
            yield f"the clearance claimed for {name} from t = {at:g} s on does not follow from its line"
        if not (proof.clearance >= certificate.margin).all():
            yield f"the clearance claimed for {name} is below the demanded one"


def _workspace(scenario: Scenario, vehicle: VehicleModel, certificate: Certificate, lemma: Lemma) -> Iterator[str]:
    E, f = scenario.workspace.A, scenario.workspace.b
    expected = [(part.name, edge) for part in vehicle.parts for edge in range(f.size)]
    if [(proof.part, proof.edge) for proof in certificate.workspace] != expected:
        yield "the proofs are not those of every body part with every edge of the workspace, in order"
        return
    for index, proof in enumerate(certificate.workspace):
        part, edge = divmod(index, f.size)
        normal = np.broadcast_to(-E[edge], (proof.clearance.size, 2))
        inside = lemma.lowest(part, proof.t, normal) + f[edge] - 16 * np.finfo(float).eps * abs(f[edge])
        if not (proof.clearance <= inside).all():
            at = _first(proof.t, proof.clearance <= inside)
            yield f"the claim for {proof.part} and workspace edge {edge} from t = {at:g} s on does not follow"
        if not (proof.clearance >= WORKSPACE_LIMIT).all():
            yield f"{proof.part} leaves the workspace at edge {edge}"


def _claims(certificate: Certificate) -> Iterator[str]:
    """The two numbers at the top against the proofs: they may claim less, not more."""
    clearance = min((float(proof.clearance.min()) for proof in certificate.pairs), default=np.inf)
    if not certificate.clearance <= clearance:
        yield f"the clearance of {certificate.clearance:g} m is more than the {clearance:g} m of its proofs"
    if not certificate.clearance >= certificate.margin:
        yield f"the clearance of {certificate.clearance:g} m is below the {certificate.margin:g} m demanded"


def _highest(normal: Array, vertices: Array) -> tuple[Array, Array]:
    """``max n.o`` for normals (M, 2), and a bound of its rounding error."""
    products = normal[:, :1] * vertices[:, 0] + normal[:, 1:] * vertices[:, 1]
    rounding = 8 * np.finfo(float).eps * np.abs(vertices).sum(axis=1).max()
    return products.max(axis=1), np.full(len(normal), rounding)


def _first(t: Array, good: NDArray[np.bool_]) -> float:
    return float(t[:-1][~good][0])
