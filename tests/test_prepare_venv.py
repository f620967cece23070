"""What ``make`` says on a machine that lacks something: one sentence each, before anything is installed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def prepare(python: str, venv: Path, path: Path | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    variables = {**os.environ, **environment}
    if path is not None:
        variables["PATH"] = str(path)
        variables.pop("CXX", None)
    command = ["/bin/sh", str(ROOT / "scripts" / "prepare_venv.sh"), python, str(venv)]
    return subprocess.run(command, capture_output=True, text=True, env=variables, check=False)


def fake_python(directory: Path, *, version: str, refuses: str) -> str:
    """A stand-in that says it is ``version`` and fails what ``refuses`` occurs in."""
    script = directory / "python"
    script.write_text(f'#!/bin/sh\ncase "$2" in *{refuses}*) exit 1;; *platform*) echo {version};; esac\n')
    script.chmod(0o755)
    return str(script)


def refused(done: subprocess.CompletedProcess[str], *words: str) -> None:
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1
    assert done.stderr.startswith("tightspot: ")
    for word in words:
        assert word in done.stderr


def test_no_python(tmp_path):
    refused(prepare("python9", tmp_path / "venv"), "'python9' was not found", "PYTHON=")


@pytest.mark.parametrize(
    ("version", "refuses", "words"),
    [
        ("3.9.2", "version_info", ["3.11", "3.9.2", "PYTHON="]),
        ("3.12.1", "ensurepip", ["virtual environments", "python3-venv"]),
        ("3.12.1", "Python.h", ["C headers", "python3-dev"]),
    ],
)
def test_unfit_python(version, refuses, words, tmp_path):
    python = fake_python(tmp_path, version=version, refuses=refuses)
    refused(prepare(python, tmp_path / "venv"), *words)
    assert not (tmp_path / "venv").exists()


def test_no_compiler(tmp_path):
    python = fake_python(tmp_path, version="3.12.1", refuses="nothing")
    (tmp_path / "bin").mkdir()
    refused(prepare(python, tmp_path / "venv", path=tmp_path / "bin"), "C++17 compiler", "apt install g++")


def test_half_made_environment_is_made_anew(tmp_path):
    venv = tmp_path / "venv"
    (venv / "bin").mkdir(parents=True)
    (venv / "bin" / "python").symlink_to(tmp_path / "gone")
    done = prepare(sys.executable, venv)
    assert done.returncode == 0, done.stderr
    usable = subprocess.run([venv / "bin" / "python", "-c", "import pip"], capture_output=True, check=False)
    assert usable.returncode == 0
    (venv / "mine").write_text("")
    assert prepare(sys.executable, venv).returncode == 0
    assert (venv / "mine").exists(), "a usable environment is kept"
