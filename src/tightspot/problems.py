"""Sentences for people: what pydantic found wrong, with the value, the remedy and the path in the file."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from tightspot.errors import Problem

MOST_PROBLEMS = 100
"""So many problems of one file are listed; a file with more is not meant for us."""

_SYNONYMS = {
    "yaw": "theta",
    "heading": "theta",
    "psi": "theta",
    "phi": "theta",
    "angle": "theta",
    "speed": "v",
    "velocity": "v",
    "steering": "delta",
    "polygon": "vertices",
    "points": "vertices",
    "corners": "vertices",
    "exterior": "vertices",
    "interiors": "holes",
    "bounds": "workspace",
    "environment": "workspace",
    "world": "workspace",
    "car": "vehicle",
    "clearance": "margin",
    "tolerances": "tolerance",
    "title": "name",
    "id": "name",
}


def refusal(sentence: str) -> PydanticCustomError:
    """The exception a pydantic validator raises to have ``sentence`` reported as it is."""
    return PydanticCustomError("refused", "{sentence}", {"sentence": sentence})


def shown(value: Any) -> str:
    """A value as a message shows it: short, printable, containers only by their kind."""
    if isinstance(value, Mapping):
        return "an object"
    if isinstance(value, list | tuple | set):
        return f"a list of {len(value)}"
    if value is None:
        return "nothing (null)"
    try:
        text = ascii(value[:60]) if isinstance(value, str) else ascii(value)
    except (ValueError, RecursionError):  # integers of thousands of digits have no decimal text
        text = f"a {type(value).__name__}"
    return text if len(text) <= 40 else f"{text[:37]}..."


def join(prefix: str, path: str) -> str:
    """``join("obstacles[2]", "vertices") == "obstacles[2].vertices"``."""
    if not prefix or not path:
        return prefix or path
    return f"{prefix}{path}" if path.startswith("[") else f"{prefix}.{path}"


def prefixed(prefix: str, problems: Iterable[Problem]) -> list[Problem]:
    """The problems of a part, with the part's own path put before theirs."""
    return [Problem(join(prefix, problem.path), problem.message) for problem in problems]


def near(word: str, known: Iterable[str], count: int = 1) -> list[str]:
    """The known words closest to ``word``, best first; empty if none is close."""
    lowered: dict[str, str] = {name.lower(): name for name in known}
    matches = difflib.get_close_matches(word.lower()[:100], list(lowered), n=count, cutoff=0.65)
    return [lowered[match] for match in matches]


def unknown_key(path: str, key: Any, known: Sequence[str]) -> Problem:
    """A key nobody reads is most likely a misspelt one, so it is refused with the nearest that is read."""
    if not isinstance(key, str):
        return Problem(path, f"the key {shown(key)} must be a word; known are {', '.join(known)}")
    synonym = _SYNONYMS.get(key.lower())
    guesses = [synonym] if synonym in known else near(key, known)
    advice = f"did you mean {guesses[0]!r}?" if guesses else f"known are {', '.join(known)}"
    return Problem(join(path, _word(key)), f"is not a known key; {advice}")


def shortened(problems: Sequence[Problem]) -> list[Problem]:
    """At most :data:`MOST_PROBLEMS`, the last of which says that there are more."""
    if len(problems) <= MOST_PROBLEMS:
        return list(problems)
    return [*problems[: MOST_PROBLEMS - 1], Problem("", "and more problems, which are not listed")]


def from_pydantic(error: ValidationError, prefix: str, known: Sequence[str]) -> list[Problem]:
    """The errors as problems, not more than one beyond :data:`MOST_PROBLEMS`.

    Args:
        error: What pydantic raised.
        prefix: Path of the validated object in the file.
        known: Keys of the model in which unknown keys may have been found.
    """
    details = error.errors(include_url=False)[: MOST_PROBLEMS + 1]
    return [_problem(detail, prefix, known) for detail in details]


def _problem(detail: ErrorDetails, prefix: str, known: Sequence[str]) -> Problem:
    loc = detail["loc"]
    if detail["type"] in ("extra_forbidden", "invalid_key") and loc:
        return unknown_key(join(prefix, _path(loc[:-1])), loc[-1], known)
    return Problem(join(prefix, _path(loc)), _sentence(detail))


def _path(loc: Sequence[int | str]) -> str:
    path = ""
    for item in loc:
        path = join(path, f"[{item}]" if isinstance(item, int) else _word(item))
    return path


def _word(key: str) -> str:
    return key if key.isidentifier() and len(key) <= 40 else shown(key)


def _sentence(detail: ErrorDetails) -> str:
    kind, given, ctx = detail["type"], shown(detail.get("input")), detail.get("ctx", {})
    bounds = {"greater_than": "gt", "greater_than_equal": "ge", "less_than": "lt", "less_than_equal": "le"}
    words = {"gt": "more than", "ge": "at least", "lt": "less than", "le": "at most"}
    if kind == "refused":
        return str(ctx["sentence"])
    if kind in bounds:
        return f"{given} must be {words[bounds[kind]]} {ctx[bounds[kind]]:g}"
    if kind == "missing":
        return "is missing; add it"
    if kind == "string_too_short":
        return "is empty; write something or leave the key out"
    if kind == "literal_error":
        return f"{given} is not known to this version; it must be {ctx['expected']}"
    if kind in ("too_long", "string_too_long"):
        return f"is too long: at most {ctx['max_length']} are read"
    if kind == "too_short":
        return f"needs at least {ctx['min_length']} entries, {ctx['actual_length']} given"
    for start, wanted in (("list", "a list"), ("string", "text"), ("model", "an object with keys")):
        if kind.startswith(start):
            return f"must be {wanted}, but is {given}"
    return f"{detail['msg']} (given: {given})"
