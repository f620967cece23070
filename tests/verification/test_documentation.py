"""The program in docs/certification.md checks plan files, as it says, and notices what it can notice."""

import copy
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

DOCUMENT = Path(__file__).parents[2] / "docs" / "certification.md"


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    [code] = re.findall(r"```python\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL)
    path = tmp_path_factory.mktemp("docs") / "check.py"
    path.write_text(code, encoding="utf-8")
    return path


def run(program, data):
    file = program.parent / "plan.json"
    file.write_text(json.dumps(data))
    return subprocess.run([sys.executable, "-I", program, file], capture_output=True, text=True, check=False)


def test_the_printed_program_accepts_a_plan(program, plan):
    result = run(program, plan.to_dict())
    assert result.returncode == 0, result.stderr
    assert str(plan.certificate.clearance) in result.stdout


@pytest.mark.parametrize(
    "path",
    [
        ("certificate", "pairs", 2, "clearance", 5),
        ("certificate", "pairs", 2, "ny", 5),
        ("certificate", "obstacles", 2, "vertices", 2, 1),
        ("certificate", "margin"),
        ("trajectory", "inputs", "omega", 1),
        ("trajectory", "states", "theta", 0),
        ("vehicle", "body", 0, "vertices", 0, 0),
    ],
)
def test_the_printed_program_rejects_lies(program, plan, path):
    data = copy.deepcopy(plan.to_dict())
    owner = data
    for key in path[:-1]:
        owner = owner[key]
    owner[path[-1]] += -0.5 if path[0] == "vehicle" else 0.5
    result = run(program, data)
    assert result.returncode == 1
    assert "AssertionError" in result.stderr
