"""Reading a file that someone else wrote: what it is, how large it is, and that it is text."""

from __future__ import annotations

import stat
from pathlib import Path

from tightspot.errors import Problem, SceneError
from tightspot.problems import near

MAX_BYTES = 10_000_000


def read_text(path: Path) -> str:
    """The file's text.

    Raises:
        SceneError: Missing, a directory, no regular file, not permitted, over 10 MB, empty, or not UTF-8.
    """
    data = read_bytes(path)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise refuse(path, f"is not UTF-8 text (byte {error.start}); save it as UTF-8") from None
    if not text.strip():
        raise refuse(path, "is empty")
    return text


def exists(path: Path) -> bool:
    """Whether there is anything of that name; a name that cannot be one names nothing."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def refuse(path: Path, sentence: str) -> SceneError:
    """The exception for a file that cannot be used as a whole."""
    return SceneError(Problem(str(path), sentence))


def read_bytes(path: Path, most: int = MAX_BYTES) -> bytes:
    """The file's content; raises :class:`SceneError` if it is none or has more than ``most`` bytes."""
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise refuse(path, "is a directory; give the file in it")
        if not stat.S_ISREG(status.st_mode):
            raise refuse(path, "is not a regular file")
        if status.st_size > most:
            size = status.st_size / 1e6
            raise refuse(path, f"has {size:.0f} MB; at most {most / 1e6:.0f} MB are read")
        with path.open("rb") as file:
            return file.read(most + 1)
    except SceneError:  # a ValueError too, so it must not reach the clause below
        raise
    except FileNotFoundError:
        raise refuse(path, f"does not exist{_alternatives(path)}") from None
    except OSError as error:
        raise refuse(path, f"cannot be read: {error.strerror or error}") from None
    except ValueError:  # a null byte in the name
        raise refuse(path, "is not a file name") from None


def _alternatives(path: Path) -> str:
    try:
        names = [entry.name for entry in path.parent.iterdir()] if path.parent.is_dir() else None
    except OSError:
        return ""
    if names is None:
        return f"; there is no directory {path.parent}"
    matches = near(path.name, names)
    return f"; did you mean {path.with_name(matches[0])}?" if matches else ""
