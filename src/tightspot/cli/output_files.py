"""A plan's files in a directory: all of them or none, whatever happens meanwhile."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from tightspot.errors import InputError, Problem

if TYPE_CHECKING:
    from tightspot.planner import Explanation
    from tightspot.verification import Plan

PLAN, TRAJECTORY, PICTURE, FAILURE = "plan.json", "trajectory.csv", "plan.png", "failure.png"
OPTION = "--output"


def default_directory(scene_name: str) -> Path:
    """``<scene>-plan`` in the working directory, with what is awkward in file names replaced."""
    slug = re.sub(r"[^\w.-]+", "-", scene_name).strip("-.")[:80]
    return Path(f"{slug or 'scene'}-plan")


def check_directory(directory: Path) -> None:
    """Refuse a directory that cannot be written before anything is computed.

    Raises:
        InputError: It is or lies in a file, is not writable, or holds a directory named like a file.
    """
    existing = next(path for path in (directory, *directory.absolute().parents) if path.exists())
    if not existing.is_dir():
        raise InputError(Problem(OPTION, f"{existing} is a file; give a directory for the plan's files"))
    if not os.access(existing, os.W_OK | os.X_OK):
        raise InputError(Problem(OPTION, f"{existing} may not be written by you; choose another directory"))
    for name in (PLAN, TRAJECTORY, PICTURE, FAILURE):
        if (directory / name).is_dir():
            raise InputError(Problem(OPTION, f"{directory / name} is a directory, not a file; choose another"))


def write_plan(plan: Plan, directory: Path, *, picture: bool) -> dict[str, str]:
    """Write the plan's files, replacing an older plan's.

    Everything is written under temporary names first; then the complete set takes its place. On any failure
    the directory is as it was, and one that did not exist does not exist.

    Args:
        plan: A certified plan.
        directory: Created if need be, with its parents.
        picture: Whether to draw it, too.

    Returns:
        Paths by kind: ``plan``, ``trajectory`` and, if drawn, ``picture``.

    Raises:
        InputError: It cannot be written: not permitted, disk full.
    """
    try:
        with _staged(directory) as stage:
            _write(plan, stage, picture=picture)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(Problem(OPTION, f"{directory} cannot be written: {reason}")) from None
    files = {"plan": PLAN, "trajectory": TRAJECTORY} | ({"picture": PICTURE} if picture else {})
    return {kind: str(directory / name) for kind, name in files.items()}


def write_failure(explanation: Explanation, directory: Path) -> dict[str, str]:
    """Draw why there is no plan; whatever else is in the directory stays as it is.

    Args:
        explanation: What is drawn.
        directory: Created if need be, with its parents.

    Returns:
        Paths by kind: ``picture``.

    Raises:
        InputError: It cannot be written: not permitted, disk full.
    """
    from tightspot import plotting

    try:
        with _created(directory):
            plotting.save(plotting.figure_explanation(explanation), directory / FAILURE)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(Problem(OPTION, f"{directory} cannot be written: {reason}")) from None
    return {"picture": str(directory / FAILURE)}


def _write(plan: Plan, directory: Path, *, picture: bool) -> None:
    from tightspot.verification import save_plan, write_trajectory_csv

    save_plan(plan, directory / PLAN)
    write_trajectory_csv(plan, directory / TRAJECTORY)
    if picture:
        from tightspot import plotting

        plotting.show_plan(plan, directory / PICTURE)


@contextlib.contextmanager
def _staged(directory: Path) -> Iterator[Path]:
    """A temporary directory whose files take their place in ``directory`` when the context ends well."""
    target = directory.resolve()
    parent = target if target.exists() else target.parent
    with _created(parent):
        stage = Path(tempfile.mkdtemp(dir=parent, prefix=".tightspot-"))
        try:
            yield stage
            with _uninterrupted():
                _publish(stage, target)
        finally:
            shutil.rmtree(stage, ignore_errors=True)


def _publish(stage: Path, target: Path) -> None:
    if target.exists():
        for name in (PLAN, TRAJECTORY, PICTURE, FAILURE):
            if (stage / name).exists():
                os.replace(stage / name, target / name)
            else:  # an older picture would show another motion, or a failure that is none any more
                (target / name).unlink(missing_ok=True)
    else:
        stage.chmod(0o777 & ~_umask())
        stage.rename(target)


@contextlib.contextmanager
def _created(directory: Path) -> Iterator[None]:
    """The directory exists inside the context; what had to be created is removed again on failure."""
    missing = [path for path in (directory, *directory.parents) if not path.exists()]
    try:
        directory.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException:
        for path in missing:
            with contextlib.suppress(OSError):  # not empty: someone else uses it
                path.rmdir()
        raise


@contextlib.contextmanager
def _uninterrupted() -> Iterator[None]:
    """Ctrl-C is ignored for the moment in which the files take their places."""
    if threading.current_thread() is not threading.main_thread():  # signals reach the main thread only
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
