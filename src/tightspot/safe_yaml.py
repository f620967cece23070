"""YAML and JSON from strangers: bounded in depth and size before anything is built, no key silently lost.

Both formats let the last of two equal keys win, which could drop all obstacles of a file without a word; here
it is an error. YAML's aliases are allowed as long as what they stand for stays small when written out.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import yaml

from tightspot.problems import shown

MAX_DEPTH = 32
MAX_NODES = 400_000
"""Values of a scene of 50,000 vertices: three a vertex, a few more an obstacle."""

_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class UnreadableError(Exception):
    """The text is not what it should be; the message is a sentence without its subject."""


def load_yaml(text: str) -> Any:
    """The plain data in a YAML text of one document; raises :class:`UnreadableError`."""
    try:
        _guard(yaml.parse(text, Loader=_Loader))
        return yaml.load(text, Loader=_Loader)  # a safe loader
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = f" (line {mark.line + 1}, column {mark.column + 1})" if mark else ""
        reason = ": ".join(text for text in (error.context, error.problem) if text)
        raise UnreadableError(f"is not readable as YAML: {reason}{where}") from None
    except (yaml.YAMLError, ValueError, OverflowError, TypeError, RecursionError) as error:
        raise UnreadableError(f"is not readable as YAML: {_first_line(error)}") from None


def load_json(text: str) -> Any:
    """The plain data in a JSON text; raises :class:`UnreadableError`."""
    try:
        data = json.loads(text, object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        raise UnreadableError(
            f"is not readable as JSON: {error.msg} (line {error.lineno}, column {error.colno})"
        ) from None
    except RecursionError:
        raise UnreadableError(_too_deep()) from None
    except ValueError as error:
        raise UnreadableError(f"is not readable as JSON: {_first_line(error)}") from None
    _measure(data)
    return data


@dataclass
class _Collection:
    """A list or mapping that is being read: its size when written out, its anchor, its keys so far."""

    anchor: str | None
    is_mapping: bool
    size: int = 1
    children: int = 0
    keys: set[str] = field(default_factory=set)


def _guard(events: Iterable[Any]) -> None:
    """Walk the events of a YAML stream without building anything, see the module."""
    stack = [_Collection(None, False)]
    sizes: dict[str, int] = {}
    for event in events:
        if isinstance(event, yaml.CollectionStartEvent):
            _check_key(stack[-1], None, event)
            stack.append(_Collection(event.anchor, isinstance(event, yaml.MappingStartEvent)))
            if len(stack) > MAX_DEPTH:
                raise UnreadableError(_too_deep())
        elif isinstance(event, yaml.CollectionEndEvent):
            closed = stack.pop()
            if closed.anchor:
                sizes[closed.anchor] = closed.size
            stack[-1].size += closed.size
        elif isinstance(event, yaml.ScalarEvent):
            _check_key(stack[-1], event.value, event)
            if event.anchor:
                sizes[event.anchor] = 1
            stack[-1].size += 1
        elif isinstance(event, yaml.AliasEvent):
            _check_key(stack[-1], None, event)
            if event.anchor not in sizes:
                raise UnreadableError(
                    f"has an alias of {shown(event.anchor)}, which is not complete before it{_where(event)}"
                )
            stack[-1].size += sizes[event.anchor]
        if stack[-1].size > MAX_NODES:
            raise UnreadableError(_too_many())


def _check_key(collection: _Collection, key: str | None, event: Any) -> None:
    """Count a child; every other child of a mapping is a key, ``key`` its text if it is a scalar."""
    is_key = collection.is_mapping and collection.children % 2 == 0
    collection.children += 1
    if not is_key or key is None or key == "<<":
        return
    if key in collection.keys:
        raise UnreadableError(f"has the key {shown(key)} twice in one object{_where(event)}; remove one of them")
    collection.keys.add(key)


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(pairs)
    if len(data) < len(pairs):
        seen: set[str] = set()
        twice = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        raise ValueError(f"the key {shown(twice)} stands twice in one object; remove one of them")
    return data


def _measure(data: Any) -> None:
    """Bound depth and number of values of plain data."""
    level, count, depth = [data], 0, 0
    while level:
        count += len(level)
        depth += 1
        if depth > MAX_DEPTH:
            raise UnreadableError(_too_deep())
        if count > MAX_NODES:
            raise UnreadableError(_too_many())
        below: list[Any] = []
        for item in level:
            if isinstance(item, dict):
                below += item.values()
            elif isinstance(item, list):
                below += item
        level = below


def _where(event: Any) -> str:
    return f" (line {event.start_mark.line + 1})" if event.start_mark else ""


def _too_deep() -> str:
    return f"is nested more than {MAX_DEPTH} levels deep; our files are flat"


def _too_many() -> str:
    return f"holds more than {MAX_NODES} values (aliases written out); a scene has fewer"


def _first_line(error: Exception) -> str:
    lines = str(error).splitlines()
    return lines[0][:200] if lines else type(error).__name__
