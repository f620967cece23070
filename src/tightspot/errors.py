"""Every exception tightspot raises on purpose.

Foreign exceptions never leak: a caller who catches :class:`TightspotError` catches everything that tightspot
can explain. The command line turns :class:`InputError` into exit code 2 and :class:`PlanningError` into 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any, TypeGuard


def is_number(value: object) -> TypeGuard[float]:
    """True for real numbers of Python and NumPy; ``True`` and ``False`` are none, nor is text."""
    return isinstance(value, Real) and not isinstance(value, bool)


def is_whole(value: object) -> TypeGuard[int]:
    """True for integers of Python and NumPy, but not for ``True`` and ``False``."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def shown(value: object) -> str:
    """For a sentence: a number as such, anything else as it would be typed."""
    return str(value) if is_number(value) else repr(value)


class TightspotError(Exception):
    """Base class of all tightspot exceptions."""


@dataclass(frozen=True)
class Problem:
    """One thing wrong with an input: where it stands and what to do about it.

    Attributes:
        path: Where in the file or argument list, for example ``obstacles[2].vertices[3]``.
        message: One sentence that names the value and the remedy.
    """

    path: str
    message: str

    def __str__(self) -> str:
        return f"{self.path}: {self.message}" if self.path else self.message


class InputError(TightspotError, ValueError):
    """The input cannot be used; nothing was computed.

    Attributes:
        problems: All problems found, each with its path, never empty.
    """

    def __init__(self, problems: str | Problem | Sequence[Problem]) -> None:
        if isinstance(problems, str):
            problems = [Problem("", problems)]
        elif isinstance(problems, Problem):
            problems = [problems]
        self.problems: list[Problem] = list(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


class GeometryError(InputError):
    """A polygon is not one: too few vertices, zero area, self-intersection, not finite."""


class SceneError(InputError):
    """A scene file or scenario is inconsistent."""


class BlockedError(SceneError):
    """The vehicle cannot stand at the start or at the goal.

    Attributes:
        ends: For each end that is blocked by what, how deep, and what would free it; see
            :class:`tightspot.scenarios.Blocked`.
        explanation: The same as :class:`tightspot.Explanation`, if :func:`tightspot.plan` raised it, else ``None``.
    """

    def __init__(self, problems: str | Problem | Sequence[Problem], ends: Sequence[Any] = ()) -> None:
        super().__init__(problems)
        self.ends: tuple[Any, ...] = tuple(ends)
        self.explanation: Any = None


class VehicleError(InputError):
    """A vehicle description is inconsistent or unknown."""


class PlanFileError(InputError):
    """A plan file cannot be read."""


class TableError(InputError):
    """A trajectory's table cannot be read."""


class BuildError(TightspotError):
    """The compiled core is missing, so what needs it (hybrid A*) cannot run."""


class PlanningError(TightspotError):
    """No certified plan was found.

    Attributes:
        reason: One sentence for people, also the exception's text.
        trajectory: The last iterate or ``None``. It is *not* a plan: it may collide.
        witness: Where and when the last iterate collides, or ``None``.
        report: What was tried, as plain data.
        explanation: Why, with numbers, and what to change: a :class:`tightspot.Explanation`, or ``None``.
    """

    def __init__(
        self,
        reason: str,
        *,
        trajectory: Any = None,
        witness: Any = None,
        report: dict[str, Any] | None = None,
        explanation: Any = None,
    ) -> None:
        super().__init__(reason)
        self.reason = reason
        self.trajectory = trajectory
        self.witness = witness
        self.report = report or {}
        self.explanation = explanation
