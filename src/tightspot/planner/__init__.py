"""The planner: ``plan()`` wires guess, transcription, solver and judge together."""

from tightspot.planner.penetration import Contact, Penetration, minimum_penetration
from tightspot.planner.pipeline import plan
from tightspot.planner.progress import Progress, ProgressCallback

__all__ = ["Contact", "Penetration", "Progress", "ProgressCallback", "minimum_penetration", "plan"]
