"""The planner: ``plan()`` wires guess, transcription, solver and judge together."""

from tightspot.planner.pipeline import plan
from tightspot.planner.progress import Progress, ProgressCallback

__all__ = ["Progress", "ProgressCallback", "plan"]
