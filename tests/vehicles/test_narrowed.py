"""Narrower bodies of the same vehicle."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tightspot.errors import VehicleError
from tightspot.vehicles import CATALOGUE, body_width, narrowed, vehicle


@pytest.mark.parametrize("name", sorted(CATALOGUE))
def test_width_scales_and_everything_else_stays(name: str) -> None:
    model = vehicle(name)
    thin = narrowed(model, 0.8)
    assert body_width(thin) == pytest.approx(0.8 * body_width(model))
    assert [part.name for part in thin.parts] == [part.name for part in model.parts]
    for before, after in zip(model.parts, thin.parts, strict=True):
        np.testing.assert_allclose(after.polygon.vertices, before.polygon.vertices * [1.0, 0.8])
        assert after.frame == before.frame
    assert thin.min_turning_radius == model.min_turning_radius
    assert type(thin) is type(model)


def test_a_body_about_its_axis_contains_the_narrower_one() -> None:
    model = vehicle("paper")
    thin = narrowed(model, 0.9)
    assert shapely.Polygon(model.parts[0].polygon.vertices).covers(shapely.Polygon(thin.parts[0].polygon.vertices))


@pytest.mark.parametrize("factor", [0.0, -1.0, np.nan, np.inf])
def test_a_width_of_nothing_is_refused(factor: float) -> None:
    with pytest.raises(VehicleError, match="factor"):
        narrowed(vehicle("paper"), factor)
