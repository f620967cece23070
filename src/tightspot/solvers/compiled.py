"""Functions of programs as machine code, compiled once by the user's compiler and kept in the user's cache directory.

An entry is a folder ``<key>`` with the library and a description that holds its checksum. The key says all that the
library depends on: the program's text, the backend, and the versions of tightspot, CasADi and the compiler. Folders are
made under another name and renamed, so that nobody finds half of one; one that is damaged is made again.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import casadi as ca
import platformdirs

import tightspot
from tightspot.errors import InputError, Problem

FLAGS = ("-O1", "-fPIC", "-shared")
"""More optimisation takes minutes to compile and gains nothing: the code is one long list of assignments."""

COMPILERS = ("cc", "gcc", "clang")
SECONDS = 900.0
ABANDONED = 2 * SECONDS
"""A folder that is still being made after so many seconds is no longer being made."""

BEING_MADE = ".making-"
_OURS = re.compile(r"[0-9a-f]{40}\Z|\.making-")
SOURCE, DESCRIPTION = "nlp.c", "entry.json"
LIBRARY = "nlp.dll" if sys.platform == "win32" else "nlp.so"
DIRECTORY_VARIABLE = "TIGHTSPOT_CACHE_DIR"


@dataclass(frozen=True)
class Entry:
    """A compiled library in the cache.

    Attributes:
        key: Its folder's name.
        directory: The folder.
        size: Bytes.
        made: When, seconds since 1970.
        about: The backend, versions and sizes it was made for; empty if the entry is damaged.
    """

    key: str
    directory: Path
    size: int
    made: float
    about: dict[str, Any]


@dataclass(frozen=True)
class Library:
    """The outcome of asking for a library.

    Attributes:
        path: The library; ``None`` if there is none.
        note: Why not, in a sentence; empty if there is one.
        seconds: Time spent compiling; 0 if it was there.
    """

    path: Path | None
    note: str = ""
    seconds: float = 0.0


def cache_directory() -> Path:
    """Where compiled functions are kept: $TIGHTSPOT_CACHE_DIR, or the system's folder for the user's caches."""
    given = os.environ.get(DIRECTORY_VARIABLE)
    return (Path(given) if given else Path(platformdirs.user_cache_dir("tightspot", appauthor=False))) / "compiled"


def entries() -> list[Entry]:
    """What is in the cache, the newest first.

    Raises:
        InputError: The folder cannot be read.
    """
    try:
        folders = [folder for folder in cache_directory().iterdir() if folder.is_dir() and _OURS.match(folder.name)]
    except FileNotFoundError:
        return []
    except OSError as error:
        raise _unusable(error) from None
    found = [_entry(folder) for folder in folders]
    old = time.time() - ABANDONED
    kept = [entry for entry in found if entry.made < old or not entry.key.startswith(BEING_MADE)]
    return sorted(kept, key=lambda entry: -entry.made)


def clear() -> list[Entry]:
    """Remove everything from the cache and say what it was.

    Raises:
        InputError: A file cannot be removed.
    """
    removed = entries()
    for entry in removed:
        try:
            shutil.rmtree(entry.directory)
        except FileNotFoundError:
            continue
        except OSError as error:
            raise _unusable(error) from None
    return removed


def library(text: str, backend: str, sizes: dict[str, int], write_source: Callable[[Path], None]) -> Library:
    """The compiled functions of a program, from the cache or made now.

    Args:
        text: All that the functions depend on: the program, serialised.
        backend: Which backend's functions.
        sizes: For the entry's description.
        write_source: Writes the C code to a path; only called if the library is not there.
    """
    compiler = find_compiler()
    if compiler is None:
        names = ", ".join(COMPILERS)
        return Library(None, f"not compiled: there is no C compiler ({names}, or $CC); CasADi evaluates the functions")
    about = {"backend": backend, "compiler": _version(compiler), "flags": list(FLAGS), **_versions()}
    key = hashlib.sha256(json.dumps([about, text], sort_keys=True).encode()).hexdigest()[:40]
    folder = cache_directory() / key
    if _is_whole(folder):
        return Library(folder / LIBRARY)
    started = time.perf_counter()
    try:
        _make(folder, compiler, about | sizes, write_source)
    except (OSError, subprocess.SubprocessError) as error:
        return Library(None, f"not compiled: {_reason(error)}; CasADi evaluates the functions")
    return Library(folder / LIBRARY, "", time.perf_counter() - started)


def write_functions(solver: Any, path: Path) -> None:
    """C code of the functions that a CasADi solver calls, and of the program that they were derived from."""
    generator = ca.CodeGenerator(path.name)
    generator.add(solver.oracle())
    for name in solver.get_function():
        generator.add(solver.get_function(name))
    path.write_text(generator.dump(), encoding="utf-8")


def find_compiler() -> tuple[str, ...] | None:
    """The command of the C compiler: $CC, or the first of :data:`COMPILERS` that is there; ``None`` without one."""
    given = shlex.split(os.environ.get("CC", ""))
    if given:
        return (*given,) if shutil.which(given[0]) else None
    found = next((path for name in COMPILERS if (path := shutil.which(name))), None)
    return None if found is None else (found,)


def _make(folder: Path, compiler: tuple[str, ...], about: dict[str, Any], write_source: Callable[[Path], None]) -> None:
    folder.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=BEING_MADE) as name:
        work = Path(name)
        write_source(work / SOURCE)
        command = [*compiler, *FLAGS, SOURCE, "-o", LIBRARY, "-lm"]
        subprocess.run(command, cwd=work, check=True, capture_output=True, stdin=subprocess.DEVNULL, timeout=SECONDS)
        (work / SOURCE).unlink()
        description = about | {"checksum": _checksum(work / LIBRARY), "made": time.time()}
        (work / DESCRIPTION).write_text(json.dumps(description, indent=2) + "\n", encoding="utf-8")
        finished = work / "finished"
        finished.mkdir()
        for file in (LIBRARY, DESCRIPTION):
            (work / file).rename(finished / file)
        if folder.exists() and not _is_whole(folder):
            shutil.rmtree(folder, ignore_errors=True)
        try:
            finished.rename(folder)
        except OSError:
            if not _is_whole(folder):  # otherwise another process was as far a moment earlier
                raise


def _is_whole(folder: Path) -> bool:
    about = _description(folder)
    try:
        return bool(about) and about.get("checksum") == _checksum(folder / LIBRARY)
    except OSError:
        return False


def _description(folder: Path) -> dict[str, Any]:
    try:
        about = json.loads((folder / DESCRIPTION).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return about if isinstance(about, dict) else {}


def _entry(folder: Path) -> Entry:
    size = 0
    made = 0.0
    for file in folder.rglob("*"):
        try:
            facts = file.stat()
        except OSError:
            continue
        size += facts.st_size
        made = max(made, facts.st_mtime)
    about = _description(folder) if _is_whole(folder) else {}
    return Entry(folder.name, folder, size, made, about)


def _checksum(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _versions() -> dict[str, str]:
    versions = {"tightspot": tightspot.__version__, "casadi": metadata.version("casadi")}
    return versions | {"system": platform.system(), "machine": platform.machine()}


@cache
def _version(compiler: tuple[str, ...]) -> str:
    try:
        answer = subprocess.run(
            [*compiler, "--version"], capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL, timeout=30
        )
    except (OSError, subprocess.SubprocessError):
        return shlex.join(compiler)
    first = (answer.stdout or answer.stderr).strip().splitlines()
    return f"{shlex.join(compiler)}: {first[0] if first else 'unknown version'}"


def _reason(error: Exception) -> str:
    if isinstance(error, subprocess.CalledProcessError):
        lines = error.stderr.decode(errors="replace").strip().splitlines()
        return f"the C compiler failed ({lines[0] if lines else f'exit code {error.returncode}'})"
    if isinstance(error, subprocess.TimeoutExpired):
        return f"the C compiler took longer than {SECONDS:g} s"
    if isinstance(error, OSError):
        return f"the cache {cache_directory()} cannot be written ({error.strerror or error})"
    return str(error)


def _unusable(error: OSError) -> InputError:
    sentence = f"{cache_directory()} cannot be used ({error.strerror or error}); set ${DIRECTORY_VARIABLE} to another"
    return InputError(Problem("cache", sentence))
