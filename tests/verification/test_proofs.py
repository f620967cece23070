"""Proofs kept in arrays are complete, and the same as they are in a plan file."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import vehicle
from tightspot.verification import Certificate, sampled, verify
from tightspot.verification.dense import clearance_series


def a_street(count: int, nearest: float = 3.0) -> Scenario:
    """Boxes in rows beside a straight road, the first ``nearest`` m from its middle."""
    rows = [
        Obstacle(f"box {i}", [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)])
        for i in range(count)
        for x, y in [(4.0 * (i % 25) - 20, nearest + 4.0 * (i // 25))]
    ]
    return Scenario(
        name="street",
        workspace=ConvexPolygon.rectangle(-30, 100, -10, 60),
        obstacles=tuple(rows),
        start=np.zeros(5),
        goal=np.array([10.0, 0, 0, 0, 0]),
    )


def straight() -> Trajectory:
    """10 m in 10 s, with constant acceleration, then constant deceleration."""
    t = np.linspace(0, 10, 21)
    a = np.where(t[:-1] < 5, 0.4, -0.4)
    v = np.concatenate([[0.0], np.cumsum(a * np.diff(t))])
    x = np.concatenate([[0.0], np.cumsum((v[:-1] + v[1:]) / 2 * np.diff(t))])
    zero = np.zeros_like(t)
    return Trajectory(t, np.c_[x, zero, zero, v, zero], np.c_[a, zero[:-1]])


@pytest.mark.parametrize("count", [1, 60])
def test_every_pair_has_its_proof_and_every_part_is_listed(count):
    scene, car = a_street(count), vehicle("paper")
    certificate = verify(scene, car, straight(), margin=0.05)
    assert certificate.check("obstacles").passed
    assert [proof.obstacle for proof in certificate.pairs] == [name for name, _ in scene.obstacle_parts]
    assert [part.name for part in certificate.obstacles] == [name for name, _ in scene.obstacle_parts]
    for proof, (_, polygon) in zip(certificate.pairs, scene.obstacle_parts, strict=True):
        assert (proof.t[0], proof.t[-1]) == (0.0, 10.0)
        assert proof.nx.shape == proof.ny.shape == proof.c.shape == proof.clearance.shape == (proof.t.size - 1,)
        assert (np.diff(proof.t) > 0).all()
        assert (np.c_[proof.nx, proof.ny] @ polygon.vertices.T <= proof.c[:, None]).all()
    assert certificate.pairs[-1].obstacle == certificate.pairs[count - 1].obstacle
    assert [proof.obstacle for proof in certificate.pairs[:2]] == [name for name, _ in scene.obstacle_parts[:2]]
    with pytest.raises(IndexError):
        certificate.pairs[count]


def test_a_pair_without_proof_is_left_out_and_the_others_stay_in_order():
    scene, car = a_street(60, nearest=0.5), vehicle("paper")
    certificate = verify(scene, car, straight(), margin=0.05)
    assert not certificate.check("obstacles").passed
    failed = {witness.obstacle for witness in certificate.witnesses}
    assert failed
    assert [proof.obstacle for proof in certificate.pairs] == [
        name for name, _ in scene.obstacle_parts if name not in failed
    ]


def test_files_and_processes_get_the_same_proofs():
    certificate = verify(a_street(30), vehicle("paper"), straight(), margin=0.05)
    data = certificate.to_dict()
    assert Certificate.from_dict(data).to_dict() == data
    assert pickle.loads(pickle.dumps(certificate)).to_dict() == data


@pytest.mark.parametrize("compiled", [True, False])
def test_far_obstacles_count_with_a_bound_and_near_ones_exactly(compiled, monkeypatch):
    if not compiled:
        monkeypatch.setattr(sampled.compiled, "is_there", lambda: False)
    scene, car, states = a_street(150), vehicle("paper"), straight().states
    few, exact = (sampled.sampled_clearance(states, scene, car, far=far) for far in (4.0, np.inf))
    assert few.shape == exact.shape == (21, 1, 150)
    assert (few <= exact + 1e-12).all()
    near = exact < 3.9
    assert near.any()
    assert not near.all()
    assert np.allclose(few[near], exact[near])
    assert (few[~near] >= 2.0).all()


def test_dense_samples_leave_out_only_obstacles_that_are_never_nearest():
    scene, car, states = a_street(150), vehicle("paper"), straight().states
    series = clearance_series(scene, car, states, np.arange(21.0))
    exact = sampled.sampled_clearance(states, scene, car, far=np.inf)[:, 0]
    assert np.allclose(series.clearance, exact.min(axis=1))
    names = [name for name, _ in scene.obstacle_parts]
    for row, name in zip(exact, series.obstacle, strict=True):
        assert row[names.index(name)] == pytest.approx(row.min())
