"""Transcription: from scenario, vehicle, guess and formulation to a nonlinear program and back."""

from tightspot.transcription.counts import Counts, counts
from tightspot.transcription.grid import TimeGrid
from tightspot.transcription.motions import MovingObstacle, ObstacleMotion, TimedPoses
from tightspot.transcription.objective import EnergyForm, Objective
from tightspot.transcription.sampling import resample
from tightspot.transcription.settle import MovingSolution, solve_moving
from tightspot.transcription.stage_problem import fits_stages, stage_problem
from tightspot.transcription.transcribe import Settings, Transcription, transcribe
from tightspot.transcription.transfer import carry_lines, carry_over, moved_ends, parents

__all__ = [
    "Counts",
    "EnergyForm",
    "MovingObstacle",
    "MovingSolution",
    "Objective",
    "ObstacleMotion",
    "Settings",
    "TimeGrid",
    "TimedPoses",
    "Transcription",
    "carry_lines",
    "carry_over",
    "counts",
    "fits_stages",
    "moved_ends",
    "parents",
    "resample",
    "solve_moving",
    "stage_problem",
    "transcribe",
]
