"""Scenes from files, one module a format; :func:`load` chooses by the file's extension."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from tightspot.errors import Problem, SceneError
from tightspot.problems import near, shown
from tightspot.scenarios import library
from tightspot.scenarios.readers.files import refuse
from tightspot.scenarios.readers.native import read_json, read_yaml
from tightspot.scenarios.readers.tpcap import read_tpcap
from tightspot.scenarios.scenario import Scenario

READERS: dict[str, Callable[[Path], Scenario]] = {
    ".yaml": read_yaml,
    ".yml": read_yaml,
    ".json": read_json,
    ".csv": read_tpcap,
}


def load(name_or_path: str | Path) -> Scenario:
    """A built-in scene by name, or a scene from a file.

    Files: ``.yaml``, ``.yml``, ``.json`` (scenes, and plan files, which hold their scene), ``.csv`` (TPCAP).

    A built-in name goes before a file of that name; write ``./vertical`` for the file.

    Raises:
        SceneError: With all problems, each with its path in the file, or the file's name if it is unreadable.
    """
    if not isinstance(name_or_path, str | Path) or not str(name_or_path):
        raise SceneError(f"{shown(name_or_path)} is neither the name of a scene nor a file")
    text = str(name_or_path)
    if text in library.names():
        return library.builtin(text)
    path = Path(text)
    suffix = path.suffix.lower()
    if suffix in READERS:
        return READERS[suffix](path)
    if suffix == ".xml":
        raise refuse(path, f"XML scenes are not read; convert it to one of {', '.join(READERS)}")
    if _exists(path):
        kind = "is a directory; give the file in it" if path.is_dir() else f"has an unknown extension {suffix!r}"
        raise refuse(path, f"{kind}; scenes are read from {', '.join(READERS)}")
    raise SceneError(Problem(shown(text).strip("'"), _unknown(text)))


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def _unknown(text: str) -> str:
    guesses = near(text, library.names(), count=3)
    advice = f"did you mean {' or '.join(guesses)}? " if guesses else ""
    return f"is neither a built-in scene nor a file; {advice}`tightspot scenes` lists the built-in ones"
