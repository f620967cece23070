"""WKT: lines and tables, roles, values, and what is refused."""

from __future__ import annotations

import math

import pytest

from tightspot.errors import SceneError
from tightspot.scenarios import load

ENDS = "start; POINT (0 0); theta=0\ngoal; POINT (9 1) 0.5\n"
SQUARE = "POLYGON ((4 4, 6 4, 6 6, 4 6, 4 4))"
CORNERS = [[4, 4], [6, 4], [6, 6], [4, 6]]


@pytest.fixture
def read(tmp_path):
    def read(text, name="plan.wkt", **given):
        path = tmp_path / name
        path.write_text(text)
        return load(path, **given)

    return read


@pytest.mark.parametrize(
    "line",
    [
        f"obstacle; {SQUARE}",
        f"obstacle: {SQUARE}",
        f"obstacle,{SQUARE}",
        f"obstacle\t{SQUARE}",
        f"OBSTACLE {SQUARE.lower()}",
        f"{SQUARE}; obstacle",
        f"{SQUARE}",
        f"  obstacle ; {SQUARE} ;  ",
        f"SRID=25832; obstacle; {SQUARE}",
        "obstacle; POLYGON Z ((4 4 1, 6 4 1, 6 6 1, 4 6 1, 4 4 1))",
        f"GEOMETRYCOLLECTION ({SQUARE})",
    ],
)
def test_ways_to_write_a_line(read, line):
    (obstacle,) = read(ENDS + "\n# a comment\n" + line).obstacles
    assert obstacle.exterior.tolist() == CORNERS


def test_values_are_words_numbers_or_json(read):
    scenario = read(
        'scene; vehicle=tpcap; margin=0.1; name="a; \\"b\\""; tolerance={"position": 0.05}\n'
        "start; POINT (0 0); theta=1e-1; v=free\ngoal; LINESTRING (9 1, 9 2); delta=null\n"
        f"obstacle; name=hut; {SQUARE}\n"
        "boundary; POLYGON ((-9 -9, 19 -9, 19 9, -9 9, -9 -9))\nobstacle; width=0.5; LINESTRING (4 -4, 9 -4)"
    )
    assert (scenario.vehicle, scenario.margin, scenario.name) == ("tpcap", 0.1, 'a; "b"')
    assert scenario.tolerance.position == 0.05
    assert scenario.start[2] == 0.1
    assert math.isnan(scenario.start[3])
    assert math.isnan(scenario.goal[4])
    assert scenario.goal[2] == math.pi / 2
    assert [o.name for o in scenario.obstacles] == ["hut", "obstacle-1"]
    assert scenario.obstacles[1].polygons[0].area == pytest.approx(0.5 * 5.5)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("name", ["plan.csv", "plan.wkt", "plan.txt"])
def test_tables_with_a_column_of_geometries(read, separator, name):
    rows = [
        ["WKT", "role", "theta", "name"],
        ['"POINT (0 0)"', "start", "0", ""],
        ['"POINT (9 1)"', "goal", "0.5", ""],
        [f'"{SQUARE}"', "", "", "hut"],
    ]
    scenario = read("\n".join(separator.join(row) for row in rows), name)
    assert scenario.goal[2] == 0.5
    assert [(o.name, o.exterior.tolist()) for o in scenario.obstacles] == [("hut", CORNERS)]


MISTAKES = [
    ("hello", "line 3", "'hello' is neither a role"),
    ("obstacle", "line 3", "has no geometry such as POLYGON"),
    ("obstacle; POLYGON ((4 4, 6 4, 6 6", "line 3", "not readable as WKT"),
    ("obstacle; POLYGON ((4 4, 6 4, 6 6))", "line 3", "a ring is not closed"),
    ("obstacle; POLYGON ((4 4, 4 4))", "line 3", "too few points"),
    ("obstacle; POLYGON ((4 4, nan 4, 6 6, 4 4))", "line 3", "not a finite number"),
    ("obstacle; POLYGON ((4 4, 1e999 4, 6 6, 4 4))", "line 3", "not a finite number"),
    ("obstacle; POLYGON ((4 4, 1e200 4, 6 6, 4 4))", "line 3 (obstacles[0].vertices[1])", "farther than"),
    ("obstacle; CURVEPOLYGON ((4 4, 6 4, 6 6, 4 4))", "line 3", "is neither a role"),
    (f"obstacle; {SQUARE} {SQUARE}", "line 3", "not readable as WKT"),
    (f"obstacle; {SQUARE}; {SQUARE}", "line 3", "two geometries"),
    (f"obstacle; {SQUARE} north", "line 3", "'north' after the geometry is not a heading"),
    (f"obstacle; name=a; name=b; {SQUARE}", "line 3", "says name twice"),
    (f'obstacle; name="a; {SQUARE}', "line 3", "not readable as JSON"),
    ("obstacle; width=thick; LINESTRING (4 4, 9 4)", "line 3.width", "between 0 and 1000"),
    (f"SRID=4326; {SQUARE}", "line 3", "degrees of longitude"),
    ("scene; margn=1", "line 3.margn", "did you mean 'margin'"),
    ("scene; margin=-1", "scene (margin)", "at least 0"),
    ("scene; unit=ft", "line 3", "unit 'ft' is not known"),
    ("obstacle; " + "GEOMETRYCOLLECTION (" * 1000 + "POINT (1 1)" + ")" * 1000, "line 3", "16 levels deep"),
    ("POINT (5 5)", "line 3", "a point without a role"),
]


@pytest.mark.parametrize(("line", "path", "words"), MISTAKES, ids=range(len(MISTAKES)))
def test_mistakes_are_named_with_their_line(read, line, path, words):
    with pytest.raises(SceneError) as caught:
        read(ENDS + line)
    found = {problem.path: problem.message for problem in caught.value.problems}
    assert path in found
    assert words in found[path]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("role,wkt\nstart,POINT (0 0)\nobstacle,POLYGON ((4 4, 6 4, 6 6, 4 4))", "quote the geometry"),
        ("role,wkt\nobstacle,SRID=4326;POINT (0 0)", "degrees of longitude"),
        ('role,wkt\nobstacle,"' + "1" * 200_000 + '"', "not in a table"),
        ("role,wkt\nobstacle,nothing", "not readable as WKT"),
    ],
)
def test_mistakes_in_a_table(read, text, words):
    with pytest.raises(SceneError, match=words):
        read(text)


def test_a_file_of_obstacles_takes_its_ends_from_the_caller(read):
    scenario = read(SQUARE, start=(0, 0, 0), goal=(9, 0, 0), vehicle="tpcap", margin=0.2)
    assert (scenario.vehicle, scenario.margin) == ("tpcap", 0.2)
    with pytest.raises(SceneError, match=r"a line `goal; POINT \(x y\); theta=\.\.\.`"):
        read(SQUARE, start=(0, 0, 0))


def test_a_drawing_with_too_many_points_is_refused(read):
    with pytest.raises(SceneError, match="more than 50000 points"):
        read(ENDS + f"obstacle; MULTIPOINT ({', '.join(['1 1'] * 50_000)})")
