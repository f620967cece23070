"""Sums taken apart: which terms of an expression belong to which stage."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import casadi as ca


def terms_of(expression: Any, owner: Mapping[int, int]) -> Iterator[tuple[Any, frozenset[int]]]:
    """Terms whose sum is the expression, each with the owners of the symbols in it.

    Sums are split, and products and quotients of sums are multiplied out, as long as a term has several owners.

    Args:
        expression: SX scalar.
        owner: By the symbol's ``element_hash()``; symbols without an owner belong to everybody.
    """
    waiting = [expression]
    while waiting:
        term = waiting.pop()
        owners = frozenset(owner[symbol.element_hash()] for symbol in ca.symvar(term) if symbol.element_hash() in owner)
        parts = _split(term) if len(owners) > 1 else []
        if parts:
            waiting += parts
        else:
            yield term, owners


def _split(term: Any) -> list[Any]:
    """Two terms with the same sum; none if there is no sum in it to take apart."""
    if term.is_op(ca.OP_ADD):
        return [term.dep(0), term.dep(1)]
    if term.is_op(ca.OP_SUB):
        return [term.dep(0), -term.dep(1)]
    if term.is_op(ca.OP_NEG):
        return [-part for part in _split(term.dep(0))]
    if term.is_op(ca.OP_DIV):
        return [part / term.dep(1) for part in _split(term.dep(0))]
    if term.is_op(ca.OP_MUL):
        left, right = term.dep(0), term.dep(1)
        return [part * right for part in _split(left)] or [left * part for part in _split(right)]
    return []
