"""From exceptions to what a person reads, what a program reads, and the exit code."""

from __future__ import annotations

import math
import os
import sys
import traceback
from dataclasses import asdict, dataclass, field, is_dataclass, replace
from typing import Any

import typer

from tightspot.cli.console import notes, print_json, print_line
from tightspot.errors import BlockedError, InputError, PlanningError, Problem, TightspotError

DONE, REFUSED, BAD_INPUT, INTERNAL, INTERRUPTED = 0, 1, 2, 3, 130

USAGE_ERROR: type[Exception] = typer.BadParameter.__bases__[0]
"""Of unknown options and arguments; typer does not export it by name."""


@dataclass(frozen=True)
class Failure:
    """A failed command.

    Attributes:
        code: Exit code.
        status: One word for programs.
        lines: One sentence each, for people.
        details: More for programs; what is not finite becomes ``null``.
        advice: What to do about it, one sentence each, for people.
    """

    code: int
    status: str
    lines: list[str]
    details: dict[str, Any] = field(default_factory=dict)
    advice: list[str] = field(default_factory=list)

    def report(self, *, as_json: bool) -> int:
        """Say it on standard error, with ``as_json`` also as one JSON object on standard output.

        Returns:
            The exit code.
        """
        console = notes()
        for line in self.lines:
            print_line(console, line, "red" if self.code != INTERRUPTED else "")
        for line in self.advice:
            print_line(console, line)
        if as_json:
            error = self.lines[0].removeprefix("error: ")
            print_json(_finite({"status": self.status, "error": error, **self.details}))
        return self.code


def failure_of(error: BaseException) -> Failure:
    """What an exception means to the user of the command line."""
    if isinstance(error, KeyboardInterrupt):
        return Failure(INTERRUPTED, "interrupted", ["interrupted: nothing was written"])
    if isinstance(error, BlockedError):
        return _blocked(error)
    if isinstance(error, InputError):
        return _bad_input(error.problems)
    if isinstance(error, PlanningError):
        return _no_plan(error)
    if isinstance(error, TightspotError):
        return Failure(REFUSED, "failed", [f"error: {error}"])
    if isinstance(error, USAGE_ERROR):
        return _usage(error)
    if isinstance(error, OSError):
        return _bad_input([Problem(_filename(error), f"{error.strerror or error}".lower())])
    if isinstance(error, MemoryError):
        return Failure(REFUSED, "failed", ["error: the memory does not suffice; try fewer steps"])
    return _internal(error)


def _bad_input(problems: list[Problem]) -> Failure:
    lines = [f"error: {problem}" for problem in problems]
    return Failure(BAD_INPUT, "bad-input", lines, {"problems": [asdict(problem) for problem in problems]})


def _blocked(error: BlockedError) -> Failure:
    failure = _bad_input(error.problems)
    explanation = error.explanation
    if explanation is None:
        return failure
    details = {**failure.details, "explanation": explanation.to_dict()}
    return replace(failure, details=details, advice=[f"explain: {finding}" for finding in explanation.findings])


def _no_plan(error: PlanningError) -> Failure:
    explanation = error.explanation
    witness = asdict(error.witness) if is_dataclass(error.witness) and not isinstance(error.witness, type) else None
    details = {"reason": error.reason, "witness": witness, "report": error.report}
    if explanation is None:
        return Failure(REFUSED, "no-plan", [f"no plan: {error.reason}"], details)
    if witness is not None:
        witness["pose"] = explanation.pose_in_file(witness["pose"])
    details["explanation"] = explanation.to_dict()
    advice = [f"change: {explanation.remedy}", *(f"explain: {finding}" for finding in explanation.findings)]
    return Failure(REFUSED, "no-plan", [f"no plan: {explanation.sentence}"], details, advice)


def _finite(data: Any) -> Any:
    """Plain data with ``None`` for numbers that are not finite."""
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data


def _usage(error: Exception) -> Failure:
    """Click's own sentence, and where to read more."""
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "tightspot"
    text = " ".join(error.format_message().split()) if hasattr(error, "format_message") else str(error)
    problem = Problem("", f"{text.rstrip('.')}; see `{command} --help`")
    return _bad_input([problem])


def _internal(error: BaseException) -> Failure:
    if os.environ.get("TIGHTSPOT_DEBUG") == "1":
        traceback.print_exception(error, file=sys.stderr)
    text = " ".join(str(error).split())
    sentence = f"internal error: {type(error).__name__}: {text[:300]}"
    advice = "this is a defect of tightspot, please report it (TIGHTSPOT_DEBUG=1 shows the traceback)"
    return Failure(INTERNAL, "internal-error", [f"{sentence}; {advice}"])


def _filename(error: OSError) -> str:
    name = error.filename
    return os.fsdecode(name) if isinstance(name, str | bytes | os.PathLike) else "file"
