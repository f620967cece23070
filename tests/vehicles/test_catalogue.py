"""The catalogue's vehicles are plausible, sourced, and written and read back unchanged."""

import numpy as np
import pytest
import shapely

from tightspot.errors import VehicleError
from tightspot.vehicles import CATALOGUE, from_dict, vehicle

NAMES = list(CATALOGUE)


@pytest.mark.parametrize("name", NAMES)
def test_entries_are_plausible_and_have_a_source(name):
    car = vehicle(name)
    assert car.name == name
    assert len(car.source) > 10
    body = shapely.unary_union([part.polygon.to_shapely() for part in car.parts])
    assert body.geom_type == "Polygon"
    assert body.contains(shapely.Point(0, 0)), "the rear axle is under the body"
    fitted = name != "paper-recovered"  # its wheelbase is a number that fits a table, not a car
    assert body.contains(shapely.Point(car.wheelbase, 0)) == fitted, "so is the front axle"
    assert abs(body.centroid.y) < 1e-12
    assert 1 < body.area < 20
    assert 0.5 < car.min_turning_radius < 10
    assert len({part.name for part in car.parts}) == len(car.parts)


@pytest.mark.parametrize("name", NAMES)
def test_the_file_form_is_a_faithful_copy(name):
    car = vehicle(name)
    copy = from_dict(car.to_dict())
    assert copy.to_dict() == car.to_dict()
    assert [part.polygon for part in copy.parts] == [part.polygon for part in car.parts]
    assert copy.limits == car.limits


def test_the_paper_s_car_has_the_printed_numbers():
    car = vehicle("paper")
    (part,) = car.parts
    length, width = np.ptp(part.polygon.vertices, axis=0)
    np.testing.assert_allclose([car.wheelbase, length, width], [2.796, 4.628, 2.097], rtol=1e-14)
    assert car.limits.steering == pytest.approx(np.radians(40))
    assert car.limits.steering_rate == pytest.approx(np.radians(5))
    assert car.limits.speed[1] == pytest.approx(5 / 3.6)


def test_the_recovered_car_differs_in_its_wheelbase():
    recovered = vehicle("paper-recovered")
    assert recovered.wheelbase == 4.628
    assert recovered.limits == vehicle("paper").limits


def test_between_the_forklift_s_tines_is_free_space():
    inside = [part.polygon.contains([2.5, 0.0]) for part in vehicle("forklift").parts]
    assert not any(inside)


def test_each_call_gives_a_fresh_equal_vehicle():
    assert vehicle("obca") is not vehicle("obca")
    assert vehicle("obca").to_dict() == vehicle("obca").to_dict()


def test_an_unknown_name_lists_those_there_are():
    with pytest.raises(VehicleError) as error:
        vehicle("batmobile")
    (problem,) = error.value.problems
    assert "'batmobile' is not in the catalogue" in problem.message
    assert all(name in problem.message for name in NAMES)
