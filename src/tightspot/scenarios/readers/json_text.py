"""JSON for people: the object's keys and the entries of its lists in one line each."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any


def json_lines(data: Mapping[str, Any]) -> str:
    """JSON text in which each key of the object, and each object in a list under a key, stands in a line of its own."""
    return "{\n" + ",\n".join(f" {_plain(key)}: {_value(value)}" for key, value in data.items()) + "\n}\n"


def _value(value: Any) -> str:
    if isinstance(value, list) and value and all(isinstance(item, Mapping) for item in value):
        return "[\n" + ",\n".join(f"  {_plain(item)}" for item in value) + "\n ]"
    return _plain(value)


def _plain(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
