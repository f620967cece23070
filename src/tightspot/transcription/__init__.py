"""Transcription: from scenario, vehicle, guess and formulation to a nonlinear program and back."""

from tightspot.transcription.carry_over import carry_over, parents
from tightspot.transcription.counts import Counts, counts
from tightspot.transcription.grid import TimeGrid
from tightspot.transcription.objective import EnergyForm, Objective
from tightspot.transcription.sampling import resample
from tightspot.transcription.transcribe import Settings, Transcription, transcribe

__all__ = [
    "Counts",
    "EnergyForm",
    "Objective",
    "Settings",
    "TimeGrid",
    "Transcription",
    "carry_over",
    "counts",
    "parents",
    "resample",
    "transcribe",
]
