"""``pip install .`` builds the core and leaves nothing out."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = ("src", "cpp", "pyproject.toml", "CMakeLists.txt", "README.md", "LICENSE")

PROGRAM = """
import tightspot
from tightspot import _core, scenarios
from tightspot.guesses import HybridAStar
scene = tightspot.load("vertical")
found = HybridAStar().make(scene, scene.vehicle_model(), margin=0.05)
print(tightspot.__file__, _core.__file__, found.trajectory is not None, len(scenarios.names()))
"""


@pytest.mark.slow
def test_wheel_is_complete_and_works(tmp_path):
    tree = tmp_path / "tree"
    tree.mkdir()
    for name in SOURCES:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, tree / name, ignore=shutil.ignore_patterns("*.so", "__pycache__"))
        else:
            shutil.copy(ROOT / name, tree / name)
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--quiet", "--no-deps", "-w", str(tmp_path), str(tree)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr

    wheel = next(tmp_path.glob("tightspot-*.whl"))
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        archive.extractall(tmp_path / "installed")
    package = tree / "src"
    assert {str(path.relative_to(package)) for path in package.rglob("*") if path.is_file()} <= names
    assert any(name.startswith("tightspot/_core.") and name.endswith((".so", ".pyd")) for name in names)
    assert any(name.endswith("LICENSE") for name in names)

    # -S keeps an editable installation out; the dependencies are named by hand.
    dependencies = [path for path in sys.path if path.endswith("site-packages")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path / "installed"), *dependencies])}
    run = [sys.executable, "-S", "-c", PROGRAM]
    done = subprocess.run(run, capture_output=True, text=True, cwd=tmp_path, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    init, core, found, _ = done.stdout.split()
    assert str(tmp_path) in init
    assert str(tmp_path) in core
    assert found == "True"
