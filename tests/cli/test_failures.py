"""Exceptions become sentences, exit codes and JSON."""

from __future__ import annotations

import errno

import pytest

from tightspot.cli.failures import failure_of
from tightspot.errors import BuildError, InputError, PlanningError, Problem, SceneError


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (InputError("bad"), 2, "error: bad"),
        (SceneError(Problem("start.x", "is odd")), 2, "error: start.x: is odd"),
        (PlanningError("blocked"), 1, "no plan: blocked"),
        (BuildError("no core"), 1, "error: no core"),
        (OSError(errno.EACCES, "Permission denied", "/x"), 2, "error: /x: permission denied"),
        (OSError("odd"), 2, "error: file: odd"),
        (MemoryError(), 1, "error: the memory does not suffice; try fewer steps"),
        (KeyboardInterrupt(), 130, "interrupted: nothing was written"),
    ],
)
def test_code_and_sentence(error, code, line):
    failure = failure_of(error)
    assert (failure.code, failure.lines) == (code, [line])


def test_every_problem_has_its_line():
    failure = failure_of(InputError([Problem("a", "one"), Problem("b[2]", "two")]))
    assert failure.lines == ["error: a: one", "error: b[2]: two"]
    assert failure.details["problems"][1] == {"path": "b[2]", "message": "two"}


def test_a_defect_is_one_line_whatever_its_message(monkeypatch):
    monkeypatch.delenv("TIGHTSPOT_DEBUG", raising=False)
    failure = failure_of(RuntimeError("first\nsecond " + "x" * 5000))
    assert failure.code == 3
    assert len(failure.lines) == 1
    assert "\n" not in failure.lines[0]
    assert len(failure.lines[0]) < 600


def test_the_witness_of_a_failed_plan_is_data():
    from tightspot.verification import Witness

    witness = Witness(1.5, "body", "wall/0", -0.2, (1.0, 2.0, 3.0), "collision")
    details = failure_of(PlanningError("hit", witness=witness, report={"rounds": []})).details
    assert details["witness"]["clearance"] == -0.2
    assert details["witness"]["obstacle"] == "wall/0"


def test_lines_cannot_smuggle_terminal_codes(capsys):
    code = failure_of(InputError("red \x1b[31m\nnew line")).report(as_json=False)
    assert code == 2
    assert capsys.readouterr().err == "error: red ?[31m new line\n"
