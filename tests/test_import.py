"""``import tightspot`` costs next to nothing, and every public name can be had."""

from __future__ import annotations

import subprocess
import sys

import pytest

import tightspot


def python(program: str) -> str:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_import_loads_nothing_heavy():
    """Its time is measured by `make bench`; this is what keeps it small."""
    heavy = {"casadi", "matplotlib", "numpy", "shapely", "pydantic", "rich", "typer", "tightspot._core"}
    assert python(f"import sys, tightspot; print(sorted(set(sys.modules) & {heavy}))") == "[]"


def test_judging_loads_no_optimiser():
    program = (
        "import sys, tightspot; tightspot.verify, tightspot.load_plan, tightspot.load, tightspot.vehicle;"
        "print(sorted(set(sys.modules) & {'casadi', 'matplotlib', 'tightspot._core'}))"
    )
    assert python(program) == "[]"


@pytest.mark.parametrize("name", tightspot.__all__)
def test_every_public_name_can_be_had(name):
    assert getattr(tightspot, name) is not None
    assert name in dir(tightspot)


def test_lazy_names_are_those_of_the_rooms():
    from tightspot.planner import plan
    from tightspot.scenarios import Scenario

    assert tightspot.plan is plan
    assert tightspot.Scenario is Scenario
    assert {name for names in tightspot._ROOMS.values() for name in names} | {"__version__"} == set(tightspot.__all__)


def test_unknown_names_are_attribute_errors():
    with pytest.raises(AttributeError, match="'tightspot' has no attribute 'plam'"):
        tightspot.plam  # noqa: B018
