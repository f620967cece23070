"""Initial guesses: rough timed trajectories from which the solver starts. One file a member."""

from tightspot.errors import InputError, Problem
from tightspot.guesses.assorted import assorted, bent_versions
from tightspot.guesses.base import Guess, GuessResult
from tightspot.guesses.bent import bent
from tightspot.guesses.collision_free import CollisionFreeModel
from tightspot.guesses.given_path import GivenPath
from tightspot.guesses.hybrid_astar import HybridAStar
from tightspot.guesses.lift import Arc, lift_arcs
from tightspot.guesses.lifting import Lift
from tightspot.guesses.linear import LinearInterpolation
from tightspot.guesses.reeds_shepp import ReedsShepp
from tightspot.guesses.rolling import lift_rolling
from tightspot.guesses.several import variants
from tightspot.guesses.simplified import SimplifiedModel

GUESSES: dict[str, type[Guess]] = {
    member.name: member
    for member in (HybridAStar, ReedsShepp, SimplifiedModel, CollisionFreeModel, LinearInterpolation)
}
"""Members that need no further argument, by the name used at the edges."""


def guess(name: str) -> Guess:
    """The member of that name; ``hybrid-astar``, ``hybrid_astar`` and ``HybridAStar`` are the same.

    Raises:
        InputError: Naming the members there are.
    """
    key = name.replace("-", "").replace("_", "").replace(" ", "").replace("*", "star").lower()
    for member_name, member in GUESSES.items():
        if key in (member_name.replace("-", ""), member.__name__.lower()):
            return member()
    raise InputError(Problem("guess", f"{name!r} is not known; choose one of {', '.join(GUESSES)}"))


__all__ = [
    "GUESSES",
    "Arc",
    "CollisionFreeModel",
    "GivenPath",
    "Guess",
    "GuessResult",
    "HybridAStar",
    "Lift",
    "LinearInterpolation",
    "ReedsShepp",
    "SimplifiedModel",
    "assorted",
    "bent",
    "bent_versions",
    "guess",
    "lift_arcs",
    "lift_rolling",
    "variants",
]
