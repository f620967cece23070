"""``tightspot verify``: upheld, not upheld, not a plan; and never an optimiser."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest


def test_a_fresh_plan_is_upheld(cli, plan_file):
    result = cli("verify", plan_file)
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith("the plan is upheld\n")
    answer = cli("verify", plan_file, "--json")
    assert answer.code == 0
    assert answer.json["status"] == "upheld"
    assert answer.json["certificate"]["certified"] is True
    assert answer.json["reasons"] == []


def _claim_more(plan):
    plan["certificate"]["clearance"] += 0.05


def _demand_more(plan):
    plan["certificate"]["margin"] += 0.2


def _move_obstacle(plan):
    for point in plan["scenario"]["obstacles"][0]["vertices"]:
        point[1] += 0.3


def _move_goal(plan):
    plan["scenario"]["goal"]["x"] += 0.05


def _steer_more(plan):
    plan["trajectory"]["inputs"]["omega"][3] += 0.02


def _exceed_a_limit(plan):
    plan["trajectory"]["inputs"]["a"][0] = 3.0


def _widen_the_car(plan):
    for point in plan["vehicle"]["body"][0]["vertices"]:
        point[1] *= 1.15


def _forget_a_pair(plan):
    del plan["certificate"]["pairs"][0]


def _shift_a_line(plan):
    plan["certificate"]["pairs"][0]["c"][0] += 5.0


TAMPERINGS = [
    _claim_more,
    _demand_more,
    _move_obstacle,
    _move_goal,
    _steer_more,
    _exceed_a_limit,
    _widen_the_car,
    _forget_a_pair,
    _shift_a_line,
]


@pytest.mark.parametrize("tamper", TAMPERINGS)
def test_tampered_plans_are_not_upheld(tamper, cli, plan_file):
    plan = json.loads(plan_file.read_text())
    tamper(plan)
    plan_file.write_text(json.dumps(plan))
    result = cli("verify", plan_file)
    assert result.code == 1
    assert "NOT upheld" in result.out
    answer = cli("verify", plan_file, "--json")
    assert answer.code == 1
    assert answer.json["status"] == "not-upheld"


UNREADABLE = {
    "empty": b"",
    "no JSON": b"plan",
    "cut off": b'{"format": "tightspot-plan/1", ',
    "a list": b"[]",
    "another format": b'{"format": "tightspot-plan/99"}',
    "nothing but the format": b'{"format": "tightspot-plan/1"}',
    "NaN": b'{"format": NaN}',
    "nested without end": b"[" * 100_000,
    "binary": bytes(range(256)),
}


@pytest.mark.parametrize("kind", UNREADABLE)
@pytest.mark.parametrize("command", ["verify", "show"])
def test_what_is_no_plan_is_bad_input(command, kind, cli, plan_file):
    plan_file.write_bytes(UNREADABLE[kind])
    before = set(plan_file.parent.iterdir())
    result = cli(command, plan_file)
    assert result.code == 2
    assert result.out == ""
    assert all(line.startswith("error: ") for line in result.err.splitlines())
    assert set(plan_file.parent.iterdir()) == before
    assert cli(command, plan_file, "--json").json["status"] == "bad-input"


@pytest.mark.parametrize("name", ["missing.json", ".", "a" * 5000])
def test_missing_files_and_directories(name, cli):
    result = cli("verify", name)
    assert result.code == 2
    assert result.err.startswith("error: ")


def test_every_wrong_field_is_named(cli, plan_file):
    plan = json.loads(plan_file.read_text())
    plan["trajectory"]["t"][1] = "soon"
    plan["certificate"]["certified"] = "yes"
    plan_file.write_text(json.dumps(plan))
    result = cli("verify", plan_file)
    assert result.code == 2
    assert "trajectory.t[1]" in result.err
    assert "certificate.certified" in result.err


def test_verify_loads_no_optimiser_and_no_core(plan_file):
    program = (
        "import sys; from tightspot.cli import main; code = main(sys.argv[1:]);"
        "print(sorted(set(sys.modules) & {'casadi', 'matplotlib', 'tightspot._core', 'tightspot.planner'}));"
        "sys.exit(code)"
    )
    command = [sys.executable, "-c", program, "verify", str(plan_file)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "[]"
