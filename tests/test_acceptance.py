"""What the tool promises, judged from outside: the command line plans, the independent replay looks."""

from __future__ import annotations

from pathlib import Path

import pytest
from benchmarks.replay import replay_file
from benchmarks.run import run_tightspot
from benchmarks.scenes import CASES, PROMISED_MARGIN, TPCAP, builtin_scenes

from tightspot import scenarios
from tightspot.guesses import HybridAStar

pytestmark = pytest.mark.slow

MEMORY = 1000.0


def plan_and_replay(scene: str | Path, promised: float, directory: Path) -> None:
    """The scene is planned within the memory, certified, and the replay sees nothing wrong. Times: `make bench`."""
    run = run_tightspot(["plan", str(scene), "--output", str(directory), "--no-picture", "--quiet"])
    assert run.code == 0, run.errors
    certificate = run.answer["certificate"]
    assert certificate["certified"]
    assert certificate["margin"] >= promised
    seen = replay_file(directory / "plan.json")
    assert seen.problems(margin=max(promised, certificate["clearance"])) == []
    assert seen.frames >= 1000 * run.answer["duration"]
    assert run.megabytes < MEMORY


@pytest.mark.parametrize("scene", builtin_scenes())
def test_builtin_scenes(scene, tmp_path):
    plan_and_replay(scene, PROMISED_MARGIN["builtin"], tmp_path / "plan")


@pytest.mark.parametrize("case", CASES)
def test_competition_scenes(case, tmp_path):
    path = TPCAP / f"{case}.csv"
    if not path.exists():
        pytest.skip(f"the competition's data is not beside the project: {TPCAP}")
    plan_and_replay(path, PROMISED_MARGIN["tpcap"], tmp_path / "plan")


@pytest.mark.parametrize("name", builtin_scenes())
def test_hybrid_astar_looks_at_few_poses(name):
    """Its times are measured by `make bench`; what costs the time is counted here."""
    scene = scenarios.builtin(name)
    found = HybridAStar().make(scene, scene.vehicle_model(), margin=scene.margin)
    assert found.trajectory is not None
    assert found.report["expansions"] < 20_000
