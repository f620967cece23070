"""Running the command line inside the test's process, and one plan that many tests share."""

from __future__ import annotations

import contextlib
import io
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tightspot.cli import main


@dataclass(frozen=True)
class Result:
    """What a run left behind."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


def run(*arguments: object) -> Result:
    """Run ``tightspot ARGUMENTS``."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main([str(argument) for argument in arguments])
    return Result(code, out.getvalue(), err.getvalue())


@pytest.fixture
def cli(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Result]:
    """``run`` with the working directory in ``tmp_path / "work"``, which is empty."""
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    return run


@pytest.fixture(scope="session")
def planned(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Result]:
    """A directory with a certified plan's three files, and the run that wrote them."""
    directory = tmp_path_factory.mktemp("planned") / "oblique"
    result = run("plan", "oblique", "--output", directory, "--json")
    assert result.code == 0, result.err
    return directory, result


@pytest.fixture
def plan_file(planned: tuple[Path, Result], tmp_path: Path) -> Path:
    """A copy of the plan file, for tests that change it."""
    copy = tmp_path / "plan.json"
    copy.write_bytes((planned[0] / "plan.json").read_bytes())
    return copy


@pytest.fixture
def quick_planner(planned: tuple[Path, Result], monkeypatch: pytest.MonkeyPatch) -> None:
    """``tightspot.planner.plan`` answers with the shared plan, at once."""
    from tightspot import planner
    from tightspot.verification import load_plan

    monkeypatch.setattr(planner, "plan", lambda scenario, **options: load_plan(planned[0] / "plan.json"))
