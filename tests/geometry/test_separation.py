"""Closed-form separation: hand-made cases, contact, batching, precision."""

import tracemalloc

import numpy as np
import pytest

from tightspot.errors import GeometryError
from tightspot.geometry import ConvexPolygon, best_line, clearance, penetration_depth, transform

CAR = ConvexPolygon.rectangle(-1, 3, -1, 1).vertices
UNIT = ConvexPolygon.rectangle(-0.5, 0.5, -0.5, 0.5).vertices
DIAMOND = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])


def at(shape, x, y):
    return shape + np.array([x, y])


@pytest.mark.parametrize(
    ("V", "O", "expected", "normal"),
    [
        (at(UNIT, 3, 0), UNIT, 2.0, (1, 0)),
        (at(UNIT, 4, 5), UNIT, 5.0, (0.6, 0.8)),
        (at(DIAMOND, 3, 0), UNIT, 1.5, (1, 0)),
        (at(DIAMOND, 2, 2), UNIT, 2 / np.sqrt(2), (1, 1)),
        (at(UNIT, 0.9, 0.2), UNIT, -0.1, (1, 0)),
        (at(UNIT, 0.1, -0.3), UNIT, -0.7, (0, -1)),
        (at(DIAMOND, 1.2, 0.0), DIAMOND, -0.8 / np.sqrt(2), None),
        (at(0.1 * UNIT, 0.2, 0), UNIT, -0.35, (1, 0)),
        (4 * UNIT, at(UNIT, 0.3, 0), -2.2, (-1, 0)),
    ],
    ids=[
        "face",
        "corner",
        "corner to face",
        "face to corner",
        "overlap x",
        "overlap y",
        "oblique",
        "inside",
        "around",
    ],
)
def test_known_clearances_and_normals(V, O, expected, normal):
    line = best_line(V, O)
    assert line.clearance == pytest.approx(expected, abs=1e-14)
    if normal is not None:
        np.testing.assert_allclose(line.normal, np.divide(normal, np.hypot(*normal)), atol=1e-14)
    assert clearance(V, O) == line.clearance
    assert penetration_depth(V, O) == max(0.0, -line.clearance)


def test_a_plus_of_two_bars_overlaps_without_any_vertex_inside_the_other():
    bar = ConvexPolygon.rectangle(-3, 3, -0.5, 0.5)
    assert clearance(bar.vertices, bar.transformed(0, 0, np.pi / 2).vertices) == pytest.approx(-3.5)


@pytest.mark.parametrize("gap", [0.0, 5e-324, 1e-300, 1e-17, 1e-15, -1e-15, 1e-12, -1e-12, 1e-8, -1e-8])
@pytest.mark.parametrize("shape", [UNIT, 0.5 * DIAMOND], ids=["face to face", "corner to corner"])
def test_contact_has_a_unit_normal_and_a_consistent_clearance(shape, gap):
    V = at(shape, 1.0 + gap, 0.0)
    line = best_line(V, shape)
    assert np.isfinite(line.normal).all()
    assert np.hypot(*line.normal) == pytest.approx(1.0, abs=4e-16)
    assert abs(line.clearance - gap) <= max(4e-16, 0.3 * abs(gap))
    assert (V @ line.normal).min() - (shape @ line.normal).max() == pytest.approx(line.clearance, abs=1e-15)


def test_identical_polygons_and_a_shared_corner():
    assert clearance(UNIT, UNIT) == -1.0
    line = best_line(UNIT + 1.0, UNIT)
    assert line.clearance == 0.0
    assert np.hypot(*line.normal) == pytest.approx(1.0)


@pytest.mark.parametrize("shift", [1e3, 1e6])
def test_far_from_the_origin_only_the_coordinates_rounding_is_lost(shift):
    rng = np.random.default_rng(0)
    V = transform(CAR, rng.uniform([-6, -6, -4], [6, 6, 4], (500, 3)))
    near, far = best_line(V, DIAMOND), best_line(V + shift, DIAMOND + shift)
    np.testing.assert_allclose(far.clearance, near.clearance, atol=8 * np.finfo(float).eps * shift)


def test_repeated_vertices_are_padding():
    O = np.array([DIAMOND, ConvexPolygon.from_vertices([(0, 0), (3, 0), (0, 2), (0, 2)]).vertices[[0, 1, 2, 2]]])
    V = at(UNIT, 2.5, 1.5)
    plain = [best_line(V, DIAMOND), best_line(V, O[1, :3])]
    padded = best_line(V, O)
    np.testing.assert_array_equal(padded.clearance, [line.clearance for line in plain])
    np.testing.assert_array_equal(padded.normal, [line.normal for line in plain])


@pytest.mark.parametrize(
    ("v", "o"),
    [((), ()), ((5,), ()), ((), (5,)), ((5,), (5,)), ((4, 1), (3,)), ((2, 1, 3), (4, 1)), ((1,), (1,))],
)
def test_batched_equals_one_by_one(v, o):
    rng = np.random.default_rng(1)
    V = transform(CAR, rng.uniform([-6, -6, -4], [6, 6, 4], (*v, 3)))
    O = transform(DIAMOND, rng.uniform([-2, -2, -4], [2, 2, 4], (*o, 3)))
    batch = np.broadcast_shapes(v, o)
    lines = best_line(V, O)
    assert lines.normal.shape == (*batch, 2)
    assert lines.offset.shape == lines.clearance.shape == batch
    V, O = np.broadcast_to(V, (*batch, 4, 2)), np.broadcast_to(O, (*batch, 4, 2))
    for index in np.ndindex(*batch):
        one = best_line(V[index], O[index])
        np.testing.assert_allclose(lines.clearance[index], one.clearance, atol=1e-14)
        np.testing.assert_allclose(lines.normal[index], one.normal, atol=1e-14)
        np.testing.assert_allclose(lines.offset[index], one.offset, atol=1e-14)


@pytest.mark.parametrize("batch", [(0,), (3, 0)])
def test_an_empty_batch_gives_empty_arrays(batch):
    line = best_line(np.empty((*batch, 4, 2)), UNIT)
    assert line.normal.shape == (*batch, 2)
    assert line.clearance.shape == batch


def test_blocks_of_a_large_batch_join_and_memory_stays_bounded():
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    O = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    poses = np.random.default_rng(2).uniform([-6, -6, -4], [6, 6, 4], (30_000, 3))
    V = transform(CAR, poses)
    tracemalloc.start()
    lines = best_line(V, O)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 16e6  # all pairs at once would take 30,000 * 60 * 4 * 2 * 8 bytes = 115 MB
    sample = slice(None, None, 997)
    np.testing.assert_allclose(lines.clearance[sample], best_line(V[sample], O).clearance, atol=1e-14)
    np.testing.assert_allclose(
        lines.clearance, (V @ lines.normal[..., None]).min((1, 2)) - (lines.normal @ O.T).max(1), atol=1e-13
    )


@pytest.mark.parametrize(
    ("V", "O", "path", "words"),
    [
        (np.zeros((4, 3)), UNIT, "V", "shape"),
        (UNIT, np.zeros(2), "O", "shape"),
        (UNIT, UNIT[:1], "O", "at least 2"),
        (np.zeros((3, 4, 2)), np.zeros((2, 4, 2)), "O", "broadcast"),
        (UNIT * np.nan, UNIT, "V", "finite"),
        (UNIT, UNIT + np.inf, "O", "finite"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(V, O, path, words):
    with pytest.raises(GeometryError, match=words) as caught:
        best_line(V, O)
    assert caught.value.problems[0].path == path
