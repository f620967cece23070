"""CommonRoad files that are broken, huge or hostile: one clear error each, soon and in little memory."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tightspot.errors import InputError, Problem, SceneError, TightspotError
from tightspot.scenarios import Scenario, builtin
from tightspot.scenarios.readers.commonroad import read_commonroad, read_commonroad_solution, write_commonroad

from .commonroad_text import (
    circle,
    goal,
    interval,
    lanelet,
    point,
    polygon,
    problem,
    rectangle,
    scenario,
    state,
    static,
)
from .peak import PRINT_PEAK

LAUGHS = "<!DOCTYPE lolz [<!ENTITY a0 'lol'>{}]>".format(
    "".join(f"<!ENTITY a{i} '{f'&a{i - 1};' * 10}'>" for i in range(1, 10))
)
BOMBS = {
    "billion laughs": f"{LAUGHS}<commonRoad>&a9;</commonRoad>",
    "quadratic blow-up": f"<!DOCTYPE x [<!ENTITY a '{'a' * 100_000}'>]><commonRoad>{'&a;' * 50_000}</commonRoad>",
    "local file": "<!DOCTYPE x [<!ENTITY a SYSTEM 'file:///etc/passwd'>]><commonRoad>&a;</commonRoad>",
    "parameter entity": "<!DOCTYPE x [<!ENTITY % a SYSTEM 'http://localhost:1/a.dtd'>%a;]><commonRoad/>",
    "remote type": "<!DOCTYPE x SYSTEM 'http://localhost:1/a.dtd'><commonRoad/>",
    "unknown entity": "<commonRoad>&nbsp;</commonRoad>",
}
FLOODS = {
    "a million vertices": f"<commonRoad>{point(1.5, 2.5) * 1_000_000}</commonRoad>",
    "vertices within 10 MB": scenario(static(3, polygon(*[(i, i % 7) for i in range(200_000)]))),
    "60,000 vertices": scenario(*(static(i + 3, polygon(*[(j, j * j % 97) for j in range(30)])) for i in range(2_000))),
    "tags": f"<commonRoad>{'<a/>' * 2_000_000}</commonRoad>",
    "depth": "<a>" * 300_000,
    "closed depth": "<commonRoad>" + "<a>" * 150_000 + "</a>" * 150_000 + "</commonRoad>",
    "groups in groups": scenario(
        static(3, "<shapeGroup><shape>" * 5_000 + circle(1) + "</shape></shapeGroup>" * 5_000)
    ),
    "attributes": "<commonRoad " + " ".join(f'a{i}="1"' for i in range(300_000)) + "/>",
    "one attribute": f'<commonRoad commonRoadVersion="{"9" * 9_000_000}"/>',
    "one text": scenario(static(3, rectangle("1" * 9_000_000, 2))),
    "a name": f"<{'a' * 9_000_000}/>",
    "comments": f"<commonRoad>{'<!-- x -->' * 900_000}</commonRoad>",
    "a deep comment": f'<commonRoad><!-- {{"format": "tightspot-commonroad/1", "a": {"[" * 500_000}}} --></commonRoad>',
    "planning problems": scenario(problems=problem() * 3_000 + problem(goals="<goalState/>")),
}


def refusal(path: Path, text: str | bytes) -> TightspotError:
    """The exception, after it has been seen to be short, quick, and to say what can be done."""
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    begun = time.process_time()
    with pytest.raises(SceneError) as caught:
        read_commonroad(path, problem=6)
    assert time.process_time() - begun < 5
    assert all(len(str(problem)) < 400 for problem in caught.value.problems)
    assert all(str(problem).isprintable() for problem in caught.value.problems)
    return caught.value


@pytest.mark.parametrize("name", BOMBS)
def test_entities_are_neither_expanded_nor_fetched(name, tmp_path):
    error = refusal(tmp_path / "x.xml", BOMBS[name])
    (problem,) = error.problems
    assert "remove the <!DOCTYPE" in problem.message or "undefined entity" in problem.message


@pytest.mark.parametrize("name", FLOODS)
def test_floods_are_refused_in_time(name, tmp_path):
    refusal(tmp_path / "x.xml", FLOODS[name])


@pytest.mark.parametrize("name", ["vertices within 10 MB", "60,000 vertices", "closed depth"])
def test_a_flood_stays_within_one_gigabyte(name, tmp_path):
    path = tmp_path / "x.xml"
    path.write_text(FLOODS[name])
    code = (
        "import resource, sys\n"
        f"resource.setrlimit(resource.RLIMIT_AS, ({10**9 + 600 * 10**6},) * 2)\n"  # libraries map 600 MB
        "from tightspot.errors import SceneError\n"
        "from tightspot.scenarios.readers.commonroad import read_commonroad\n"
        "try:\n    read_commonroad(sys.argv[1], problem=6)\nexcept SceneError as error:\n    print(error)\n"
        f"{PRINT_PEAK}"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True, timeout=60, check=True
    )
    sentence, peak = done.stdout.rstrip().rsplit("\n", 1)
    assert sentence
    assert int(peak) < 700_000_000


def outcome(path: Path) -> Scenario | list[Problem]:
    """The scene, or what is wrong with the file; any other exception is the test's failure."""
    try:
        return read_commonroad(path)
    except InputError as error:
        return error.problems


def comb(turned: bool) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """A lanelet with 350 teeth; crossed with its likeness it has over 100,000 holes."""
    teeth = [point for i in range(350) for point in ((i * 0.1 - 20, -20.0), (i * 0.1 - 19.95, 20.0))]
    back = [(x, -30.0) for x, _ in teeth]
    return ([(y, x) for x, y in teeth], [(y, x) for x, y in back]) if turned else (teeth, back)


@pytest.mark.parametrize(
    ("lanelets", "words"),
    [
        ([comb(False), comb(True)], "cross each other or themselves at some"),
        ([([(i * 0.01, 2) for i in range(2000)], [(i * 0.01, -2) for i in range(2000)])], "have 4000 border points"),
        ([([(0, 0), (0, 0)], [(0, 0), (0, 0)])], None),
    ],
)
def test_roads_that_take_too_long_are_refused(lanelets, words, tmp_path):
    path = tmp_path / "x.xml"
    path.write_text(scenario(*(lanelet(i + 1, *borders) for i, borders in enumerate(lanelets))))
    begun = time.process_time()
    if words is None:
        assert read_commonroad(path, lanelets="boundary").obstacles is not None
    else:
        with pytest.raises(SceneError, match=words):
            read_commonroad(path, lanelets="boundary")
    assert time.process_time() - begun < 5


ODD = {
    "empty": b"",
    "blanks": b" \n",
    "binary": bytes(range(256)),
    "latin-1": '<commonRoad author="é"/>'.encode("latin-1"),
    "utf-16": scenario().encode("utf-16"),
    "json": b'{"a": 1}',
    "nul": b"<commonRoad>\0</commonRoad>",
    "two roots": b"<commonRoad/><commonRoad/>",
    "a wrong end": b"<commonRoad></commonroad>",
}


@pytest.mark.parametrize("name", ODD)
def test_what_is_no_xml_is_said_so(name, tmp_path):
    refusal(tmp_path / "x.xml", ODD[name])


NUMBERS = ["1e999", "nan", "inf", "-inf", "1_000", "0x10", "1,5", "١", "", "9" * 500, "--1", "1e", "true", "1 2"]


@pytest.mark.parametrize("number", NUMBERS)
def test_what_is_no_number_is_named(number, tmp_path):
    text = scenario(static(12, rectangle(number, 2)), problems=problem(6))
    (found,) = refusal(tmp_path / "x.xml", text).problems
    assert found.path == "staticObstacle[12].shape.rectangle.length"


HUGE = [
    scenario(problems=problem(6, start=state("1e300", 0, 0))),
    scenario(problems=problem(6, start=state(0, 0, "1e300"))),
    scenario(problems=problem(6, start=state(0, 0, 0, more=interval("velocity", 0, 1)))),
    scenario(problems=problem(6, goals=goal(circle("1e200", ("1e200", 0))))),
    scenario(static(3, circle("1e300")), problems=problem(6)),
    scenario(static(3, rectangle("1e-300", "1e-300")), problems=problem(6)),
    scenario(static(3, circle(1), state(0, 0, "1e300")), problems=problem(6)),
    scenario(problems=problem(6), dt="1e400"),
    scenario(problems=problem("6" * 400)),
    scenario(static("-3", circle(1)), problems=problem(6)),
    scenario(static(3, polygon(("1e308", 0), ("-1e308", 0), (0, "1e308"))), problems=problem(6)),
]


@pytest.mark.parametrize("text", HUGE, ids=range(len(HUGE)))
def test_numbers_beyond_all_measure_are_refused(text, tmp_path):
    assert refusal(tmp_path / "x.xml", text).problems


def test_a_file_cut_off_anywhere_is_refused(tmp_path):
    path = tmp_path / "x.xml"
    write_commonroad(builtin("garage"), path)
    data = path.read_bytes()
    for cut in range(0, len(data) - 15, 101):
        refusal(path, data[:cut])


@pytest.mark.parametrize("seed", range(6))
def test_random_damage_is_read_or_refused(seed, tmp_path):
    path = tmp_path / "x.xml"
    write_commonroad(builtin("garage"), path)
    data = path.read_bytes()
    source = random.Random(seed)
    for _ in range(60):
        damaged = bytearray(data)
        for _ in range(source.randint(1, 6)):
            where = source.randrange(len(damaged))
            kind = source.randrange(4)
            if kind == 0:
                damaged[where] = source.randrange(256)
            elif kind == 1:
                del damaged[where : where + source.randint(1, 400)]
            elif kind == 2:
                damaged[where:where] = bytes(source.choice([b"<", b">", b"-", b"9", b"e9", b"\n", b"&", b'"', b"--"]))
            else:
                damaged[where:where] = damaged[source.randrange(len(damaged)) :][: source.randint(1, 400)]
        path.write_bytes(bytes(damaged))
        assert outcome(path)


def test_a_comment_full_of_nonsense_is_never_a_traceback(tmp_path):
    path = tmp_path / "x.xml"
    write_commonroad(builtin("garage"), path)
    text = path.read_text()
    begin, end = text.index("<!--") + 4, text.index("-->")
    known = json.loads(text[begin:end])
    for key in known:
        for nonsense in (None, -1.5, "/etc/passwd", [], {}, [[]], [{}], {"x": {}}, [["a"]], True):
            path.write_text(f"{text[:begin]} {json.dumps(known | {key: nonsense})} {text[end:]}")
            assert outcome(path), (key, nonsense)


def test_a_comment_reads_no_other_file(tmp_path):
    path = tmp_path / "x.xml"
    write_commonroad(builtin("garage"), path)
    car = tmp_path / "car.yaml"
    car.write_text("name: stolen")
    path.write_text(path.read_text().replace('"vehicle": "', f'"vehicle": "{car}', 1))
    with pytest.raises(SceneError, match="not in the catalogue"):
        read_commonroad(path)


SOLUTIONS = [
    "<CommonRoadSolution/>",
    '<CommonRoadSolution benchmark_id="KS2:JB1:DEU_Muc-1_1_T-1:2020a"/>',
    '<CommonRoadSolution benchmark_id="x"><ksTrajectory planningProblem="1"/></CommonRoadSolution>',
    '<CommonRoadSolution benchmark_id="PM1:JB1:A-1:2020a"><ksTrajectory planningProblem="1"/></CommonRoadSolution>',
    '<CommonRoadSolution benchmark_id="KS2:JB1:A-1:2020a"><pmTrajectory planningProblem="1"/></CommonRoadSolution>',
    '<CommonRoadSolution benchmark_id="KS2:JB1:A-1:2020a"><ksTrajectory planningProblem="1"/></CommonRoadSolution>',
    '<CommonRoadSolution benchmark_id="KS2:JB1:A-1:2020a"><ksTrajectory planningProblem="x"/></CommonRoadSolution>',
    scenario(),
    BOMBS["billion laughs"],
]


@pytest.mark.parametrize("text", SOLUTIONS, ids=range(len(SOLUTIONS)))
def test_what_is_no_solution_says_why(text, tmp_path):
    path = tmp_path / "solution.xml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_commonroad_solution(path, dt=0.1)
    assert len(caught.value.problems) == 1


def test_without_defusedxml_one_sentence_says_what_to_install(tmp_path, monkeypatch):
    path = tmp_path / "x.xml"
    write_commonroad(builtin("garage"), path)
    monkeypatch.setitem(sys.modules, "defusedxml.common", None)
    with pytest.raises(TightspotError, match=r'pip install "tightspot\[readers\]"'):
        read_commonroad(path)
